// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FaceSides.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/PatchesAtEdge.h"

#include <algorithm>

namespace tetvdb {
namespace {

// A component of a direction, in -1..1.
double component(std::uint64_t number) {
  return static_cast<double>(hashOfIndex(number) >> 11) * 0x1p-52 - 1;
}

} // namespace

FaceSides::FaceSides(const TriangleMesh& mesh, const EdgeTable& edges, Progress& progress)
    : mesh_(mesh), edges_(edges), patches_(findPatches(mesh.triangleCount(), edges, progress)),
      areas_(mesh.triangleCount()), turned_(mesh.triangleCount(), 0) {
  forEachIndex(areas_.size(), [&](std::size_t face) {
    areas_[face] = length(normal(static_cast<std::uint32_t>(face))) / 2;
  });
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  diagonal_ = mesh.points.empty() ? 0 : length(minus(box.high, box.low));
}

Vec3d FaceSides::normal(std::uint32_t face) const {
  const std::uint32_t* v = &mesh_.triangles[3 * std::size_t(face)];
  const Vec3d& a = mesh_.points[v[0]];
  const Vec3d n = cross(minus(mesh_.points[v[1]], a), minus(mesh_.points[v[2]], a));
  return turned_[face] ? times(n, -1) : n;
}

Vec3d FaceSides::centroid(std::uint32_t face) const {
  const std::uint32_t* v = &mesh_.triangles[3 * std::size_t(face)];
  return times(plus(plus(mesh_.points[v[0]], mesh_.points[v[1]]), mesh_.points[v[2]]), 1.0 / 3);
}

const TriangleScene& FaceSides::scene() {
  if (scene_ == nullptr) {
    ownScene_ = std::make_unique<TriangleScene>(mesh_);
    scene_ = ownScene_.get();
  }
  return *scene_;
}

Vec3d FaceSides::directionFrom(std::uint32_t face, std::uint32_t number) {
  const std::uint64_t seed = 3 * (std::uint64_t(face) * 8 + number);
  const Vec3d direction{component(seed), component(seed + 1), component(seed + 2)};
  return times(direction, 1 / std::max(length(direction), 1e-9));
}

void FaceSides::shoot(std::uint32_t face, const Vec3d& direction,
                      std::vector<TriangleScene::Hit>& hits) const {
  scene_->crossings(centroid(face), direction, 2 * diagonal_, hits);
  hits.erase(std::remove_if(hits.begin(), hits.end(),
                            [face](const TriangleScene::Hit& hit) { return hit.triangle == face; }),
             hits.end());
}

void FaceSides::alignPatches(const std::vector<std::uint8_t>& withoutSide) {
  std::vector<double> with(patches_.patchCount(), 0), against(patches_.patchCount(), 0);
  for (std::size_t face = 0; face < areas_.size(); ++face)
    if (patches_.patchOf[face] != EdgeTable::kNone && (withoutSide.empty() || !withoutSide[face]))
      (patches_.against[face] ? against : with)[patches_.patchOf[face]] += areas_[face];
  sideless_.resize(patches_.patchCount());
  for (std::uint32_t patch = 0; patch < sideless_.size(); ++patch)
    sideless_[patch] = !withoutSide.empty() && with[patch] + against[patch] == 0;
  forEachIndex(areas_.size(), [&](std::size_t face) {
    const std::uint32_t patch = patches_.patchOf[face];
    if (patch != EdgeTable::kNone && patches_.orientable[patch])
      turned_[face] = patches_.against[face] != (against[patch] > with[patch]);
  });
  findShells();
}

void FaceSides::findShells() {
  DisjointSets sets(patches_.patchCount());
  forEachIndex(edges_.edgeCount(), [&](std::size_t i) {
    const auto edge = static_cast<std::uint32_t>(i);
    if (edges_.sides(edge).size() <= 2)
      return;
    std::uint32_t before = EdgeTable::kNone;
    eachPatchAt(edge, [&](std::uint32_t patch, int imbalance) {
      if (imbalance == 0)
        return;
      if (before != EdgeTable::kNone)
        sets.join(before, patch);
      before = patch;
    });
  });
  shellOf_.resize(patches_.patchCount());
  for (std::uint32_t patch = 0; patch < shellOf_.size(); ++patch) {
    const std::uint32_t root = sets.find(patch); // the shell's first patch
    shellOf_[patch] = root == patch ? shellCount_++ : shellOf_[root];
  }
}

} // namespace tetvdb
