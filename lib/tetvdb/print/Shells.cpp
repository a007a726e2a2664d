// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/Shells.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr double kHalfAround = 6.283185307179586; // solid angle of half a sphere

// The solid angle of a face (van Oosterom and Strackee 1983).
double angleOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = length(a), lb = length(b), lc = length(c);
  return 2 * std::atan2(dot(a, cross(b, c)),
                        la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

} // namespace

std::size_t Shells::cavities() const {
  return static_cast<std::size_t>(
      std::count_if(volumes.begin(), volumes.end(), [](double v) { return v < 0; }));
}

double Shells::volume() const {
  double sum = 0;
  for (const double v : volumes)
    sum += v;
  return sum;
}

Shells findShells(const TriangleMesh& mesh) {
  constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  Shells shells;
  DisjointSets sets(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    sets.join(mesh.triangles[i], mesh.triangles[i + 1]);
    sets.join(mesh.triangles[i], mesh.triangles[i + 2]);
  }
  std::vector<std::uint32_t> number(mesh.points.size(), kNone);
  shells.ofFace.resize(mesh.triangleCount());
  for (std::size_t face = 0; face < shells.ofFace.size(); ++face) {
    const std::uint32_t* v = mesh.triangles.data() + 3 * face;
    std::uint32_t& shell = number[sets.find(v[0])];
    if (shell == kNone) {
      shell = static_cast<std::uint32_t>(shells.volumes.size());
      shells.volumes.push_back(0);
    }
    shells.ofFace[face] = shell;
    const Vec3d& about = mesh.points[mesh.triangles[0]];
    shells.volumes[shell] +=
        dot(minus(mesh.points[v[0]], about),
            cross(minus(mesh.points[v[1]], about), minus(mesh.points[v[2]], about))) /
        6;
  }
  return shells;
}

namespace {

// Removes shells for which `isAsked(volume)`, with their contents.
template <typename IsAsked>
FilledCavities dropShells(TriangleMesh& mesh, const IsAsked& isAsked) {
  FilledCavities filled;
  const Shells shells = findShells(mesh);
  const std::size_t count = shells.volumes.size();
  std::vector<Box> boxes(count);
  std::vector<Vec3d> points(count); // one of each shell's
  for (std::size_t face = 0; face < shells.ofFace.size(); ++face)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& p = mesh.points[mesh.triangles[3 * face + k]];
      boxes[shells.ofFace[face]].add(p);
      points[shells.ofFace[face]] = p;
    }
  std::vector<char> goes(count, 0);
  std::vector<std::vector<std::size_t>> within(count); // shells in the box of a removed one
  for (std::size_t i = 0; i < count; ++i) {
    if (!isAsked(shells.volumes[i]))
      continue;
    goes[i] = 1;
    ++filled.cavities;
    for (std::size_t j = 0; j < count; ++j)
      if (j != i && boxes[i].contains(boxes[j]))
        within[i].push_back(j);
  }
  std::vector<std::vector<double>> angles(count);
  for (std::size_t i = 0; i < count; ++i)
    angles[i].resize(within[i].size(), 0);
  for (std::size_t face = 0; face < shells.ofFace.size(); ++face) {
    const std::size_t shell = shells.ofFace[face];
    const std::uint32_t* v = mesh.triangles.data() + 3 * face;
    for (std::size_t j = 0; j < within[shell].size(); ++j) {
      const Vec3d& p = points[within[shell][j]];
      angles[shell][j] += angleOf(minus(mesh.points[v[0]], p), minus(mesh.points[v[1]], p),
                                  minus(mesh.points[v[2]], p));
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < within[i].size(); ++j)
      if (std::abs(angles[i][j]) > kHalfAround && goes[within[i][j]] == 0)
        goes[within[i][j]] = 2;
  for (std::size_t i = 0; i < count; ++i)
    if (goes[i] != 0)
      filled.volume -= shells.volumes[i];
  std::vector<char> drops(shells.ofFace.size());
  for (std::size_t face = 0; face < drops.size(); ++face)
    drops[face] = goes[shells.ofFace[face]];
  filled.faces = dropFaces(mesh, drops);
  if (filled.faces > 0)
    dropUnusedPoints(mesh);
  mesh.faceCount = mesh.triangleCount();
  return filled;
}

} // namespace

FilledCavities fillCavities(TriangleMesh& mesh, double volume) {
  return dropShells(mesh, [&](double own) { return own < 0 && -own < volume; });
}

FilledCavities dropIslands(TriangleMesh& mesh) {
  return dropShells(mesh, [](double own) { return own > 0; });
}

} // namespace tetvdb
