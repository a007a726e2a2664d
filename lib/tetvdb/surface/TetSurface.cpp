// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TetSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/SortedTetFaces.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/surface/SplitFans.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

std::array<std::uint32_t, 3> outward(const TetMesh& mesh, std::size_t tet, std::size_t opposite) {
  std::array<std::uint32_t, 3> v;
  for (std::size_t k = 0; k < 3; ++k)
    v[k] = mesh.tets[4 * tet + kFaceCorners[opposite][k]];
  return v;
}

// Whether sorting the corners takes an odd number of swaps.
bool isOdd(const std::array<std::uint32_t, 3>& v) {
  return (v[0] > v[1]) != ((v[1] > v[2]) != (v[0] > v[2]));
}

bool hasRepeatedPoint(const std::uint32_t* v) {
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] ||
         v[2] == v[3];
}

class Surface {
public:
  Surface(const TetMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {}

  TriangleMesh run() {
    orient();
    faces_ = sortedTetFaces(
        mesh_.tets.data(), mesh_.tetCount(),
        [&](const TetFace& face) { return !hasRepeatedPoint(&mesh_.tets[4 * face.tet]); },
        progress_);
    orientFlatTets();
    TriangleMesh surface;
    forEqualFaces(
        faces_, [&](const TetFace* first, const TetFace* last) { addFaces(first, last, surface); });
    if (surface.triangles.empty())
      throw Error(Status::Invalid, "", "the tetrahedra have no surface",
                  "all of them are flat or cancel out");
    compact(surface);
    splitFans(surface, progress_);
    return surface;
  }

private:
  void orient() {
    sign_.assign(mesh_.tetCount(), 0);
    tbb::parallel_for(std::size_t(0), mesh_.tetCount(), [&](std::size_t tet) {
      const std::uint32_t* v = &mesh_.tets[4 * tet];
      const std::vector<Vec3d>& p = mesh_.points;
      // Positive volume: seen from a, corners b, c, d are oriented as required.
      sign_[tet] = static_cast<signed char>(orientation(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
    });
  }

  // 1 if the face, seen from outside its tet, is oriented as its ascending corners; -1 if opposite;
  // 0 while its tet is flat and not oriented.
  int turn(const TetFace& face) const {
    return isOdd(outward(mesh_, face.tet, face.opposite)) ? -sign_[face.tet] : sign_[face.tet];
  }

  // Orients flat tets so that their faces cancel with those of oriented neighbours, in waves.
  void orientFlatTets() {
    std::vector<std::pair<const TetFace*, const TetFace*>> pairs;
    forEqualFaces(faces_, [&](const TetFace* first, const TetFace* last) {
      if (last == first + 2 && (sign_[first[0].tet] == 0 || sign_[first[1].tet] == 0))
        pairs.emplace_back(first, first + 1);
    });
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<std::pair<const TetFace*, const TetFace*>> rest;
      for (const auto& [a, b] : pairs) {
        const int turnA = turn(*a), turnB = turn(*b);
        if (turnA == 0 && turnB == 0) {
          rest.emplace_back(a, b);
        } else if (turnA == 0 || turnB == 0) {
          const TetFace& flat = turnA == 0 ? *a : *b;
          const bool odd = isOdd(outward(mesh_, flat.tet, flat.opposite));
          sign_[flat.tet] = static_cast<signed char>((odd ? 1 : -1) * (turnA + turnB));
          changed = true;
        }
      }
      pairs = std::move(rest);
      progress_.check();
    }
  }

  void addFaces(const TetFace* first, const TetFace* last, TriangleMesh& surface) const {
    int sum = 0;
    for (const TetFace* face = first; face != last; ++face)
      sum += turn(*face);
    const std::array<std::uint32_t, 3>& v = first->corners;
    for (; sum > 0; --sum)
      surface.triangles.insert(surface.triangles.end(), {v[0], v[1], v[2]});
    for (; sum < 0; ++sum)
      surface.triangles.insert(surface.triangles.end(), {v[0], v[2], v[1]});
  }

  void compact(TriangleMesh& surface) const {
    std::vector<std::uint32_t> number(mesh_.points.size(), kNone);
    for (const std::uint32_t v : surface.triangles)
      number[v] = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
      if (number[v] == 0) {
        number[v] = static_cast<std::uint32_t>(surface.points.size());
        surface.points.push_back(mesh_.points[v]);
      }
    for (std::uint32_t& v : surface.triangles)
      v = number[v];
  }

  const TetMesh& mesh_;
  Progress& progress_;
  std::vector<signed char> sign_; ///< of a tet's volume
  LargeVector<TetFace> faces_;
};

} // namespace

TriangleMesh tetSurface(const TetMesh& mesh, Progress& progress) {
  checkMesh(mesh);
  return Surface(mesh, progress).run();
}

} // namespace tetvdb
