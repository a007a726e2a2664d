// SPDX-License-Identifier: Apache-2.0
//
// Closed triangle soups that the device, its twin and the CPU must make the same grids of.
#pragma once

#include "Grids.h"
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

inline InsideRule insideOf(FillRule rule) {
  return rule == FillRule::Positive  ? InsideRule::Winding
         : rule == FillRule::NonZero ? InsideRule::NonZero
                                     : InsideRule::Parity;
}

inline std::string cpuHash(const TriangleMesh& mesh, FillRule rule, GridKind kind,
                           const GridTransform& transform) {
  VoxelizeOptions options;
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.grids = {kind};
  options.allowEmpty = true;
  SolidOptions solid;
  solid.inside = insideOf(rule);
  Report report;
  Progress progress;
  return hash(voxelize(mesh, solid, options, report, progress).volume);
}

/// The four faces of every tet: winding numbers of any size and sign, as the tets overlap and are
/// turned.
inline TriangleMesh facesOf(const TetMesh& tets) {
  TriangleMesh mesh;
  mesh.points = tets.points;
  for (std::size_t t = 0; t < tets.tetCount(); ++t) {
    const std::uint32_t* v = tets.tets.data() + 4 * t;
    meshes::addTriangle(mesh, v[0], v[2], v[1]);
    meshes::addTriangle(mesh, v[0], v[1], v[3]);
    meshes::addTriangle(mesh, v[1], v[2], v[3]);
    meshes::addTriangle(mesh, v[0], v[3], v[2]);
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

struct SoupCase {
  std::string name;
  TriangleMesh mesh;
  GridTransform transform{};
  bool dense = true; ///< small enough for Method::Dense
};

inline TriangleMesh movedBy(const TriangleMesh& mesh, double scale, const Vec3d& shift) {
  return meshes::moved(mesh, [&](const Vec3d& p) {
    return Vec3d{p[0] * scale + shift[0], p[1] * scale + shift[1], p[2] * scale + shift[2]};
  });
}

/// `small`: without those of many voxels.
inline std::vector<SoupCase> soupCases(bool small) {
  using namespace meshes;
  std::vector<SoupCase> cases;
  for (const int side : {1, 3, 8, 128})
    cases.push_back(
        {"box of ties " + std::to_string(side),
         box({-double(side), 0, 0}, {double(side), std::min(8.0 * side, 128.0), double(side)}, 2)});
  cases.push_back({"sphere", sphere({3, -70, 100}, 40.3, 12)});
  cases.push_back({"anisotropic voxels",
                   movedBy(torus(), 37, {-20.1, -5000.7, 3.3}),
                   {{0.9, 1.1, 1.7}, {0.25, -3, 8}}});
  cases.push_back({"inside out", flipped(sphere({0, 0, 0}, 20, 8))});
  cases.push_back({"a cavity and an island",
                   joined({sphere({0, 0, 0}, 40, 12), flipped(sphere({0, 0, 0}, 30, 10)),
                           sphere({1, 2, 3}, 12, 6)})});
  cases.push_back(
      {"overlapping spheres",
       joined({sphere({0, 0, 0}, 30, 9), sphere({20, 3, 1}, 30, 9), sphere({10, 20, -6}, 30, 9)})});
  const TriangleMesh ball = sphere({5, 5, 5}, 21.7, 9);
  cases.push_back({"faces twice", joined({ball, ball})});
  cases.push_back({"faces that cancel", joined({ball, flipped(ball)})});
  cases.push_back({"overlaps, flips, flat tets", facesOf(soup(300, 40, 9, 1, 5))});
  cases.push_back({"far below a voxel", movedBy(sphere({0, 0, 0}, 1, 60), 9, {0.2, 0.1, 0.3})});
  cases.push_back({"nothing inside", box({0.3, 0.3, 0.3}, {0.7, 0.7, 0.7})});
  for (const double thin : {1e-3, 1e-5, 4e-6})
    cases.push_back({"slivers", moved(sphere({0, 0, 0}, 1, 9), [=](const Vec3d& p) {
                       return Vec3d{p[0] * 51, p[1] * 39 + 3, p[2] * thin * 9 + 4 - thin};
                     })});
  for (const double shear : {0x1p-20, 0x1p-14, 1e-3})
    cases.push_back(
        {"faces all but parallel to z", moved(box({0, 0, 0}, {1, 1, 1}, 5), [=](const Vec3d& p) {
           return Vec3d{p[0] * 45 + shear * p[2] * 150, p[1] * 35 - shear * p[2] * 45,
                        p[2] * 150 + 0.5};
         })});
  cases.push_back({"across root tiles", movedBy(sphere({0, 0, 0}, 1, 10), 60, {1, -2, 4100})});
  for (std::uint64_t seed = 0; seed < (small ? 3u : 30u); ++seed) {
    TetMesh mesh = soup(1 + seed * 7 % 40, seed % 3 == 0 ? 1 : 20 * double(seed % 3),
                        seed % 2 == 0 ? 2 : 25, seed, 2);
    if (seed % 4 > 1)
      mesh = rounded(std::move(mesh), seed % 8 > 3 ? 1 : 0.125);
    cases.push_back({"soup " + std::to_string(seed), facesOf(mesh)});
  }
  if (small)
    return cases;
  cases.push_back({"giant faces", facesOf(soup(4, 300, 200, 6))});
  cases.push_back({"tiles of lower nodes", box({-40, -30, -20}, {300, 150, 140})});
  cases.push_back({"a tall box", box({3, 1, -4100}, {23, 13, 4900}), {}, false});
  cases.push_back(
      {"tiles of every level", box({-200, -104, -4500}, {4304, 4296, 4500}), {}, false});
  return cases;
}

} // namespace tetvdb
