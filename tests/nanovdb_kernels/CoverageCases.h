// SPDX-License-Identifier: Apache-2.0
//
// Coverage by the device or its twin, and that of the CPU.
#pragma once

#include "Grids.h"
#include "Meshes.h"
#include "TriangleMeshes.h"
#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

struct CoverageCase {
  std::string name;
  std::vector<Vec3d> points;
  Boundary faces;
  GridTransform transform{};
};

inline CoverageCase coveredBy(std::string name, const TriangleMesh& mesh,
                              const GridTransform& transform = {}) {
  CoverageCase c{std::move(name), mesh.points, {}, transform};
  for (std::size_t f = 0; f < mesh.triangleCount(); ++f) {
    const std::uint32_t* v = mesh.triangles.data() + 3 * f;
    c.faces.faces.push_back({v[0], v[1], v[2], 1});
  }
  return c;
}

inline CoverageCase coveredBy(std::string name, const TetMesh& mesh,
                              const GridTransform& transform = {}) {
  Progress progress;
  const SnappedMesh snapped = snapMesh(mesh, transform, progress);
  return {std::move(name), mesh.points, boundaryFaces(snapped, progress), transform};
}

/// A hash of the grid, what is said of it, and the sums.
struct Covered {
  std::string hash;
  GridInfo info;
  CoverageSum sum;

  bool operator==(const Covered& o) const {
    return hash == o.hash && info.volume == o.info.volume && info.leaves == o.info.leaves &&
           info.activeTiles == o.info.activeTiles && sum.filled == o.sum.filled &&
           sum.overlap == o.sum.overlap && sum.overlapVoxels == o.sum.overlapVoxels;
  }
};

inline Covered coveredByCpu(const CoverageCase& c) {
  Progress progress;
  Covered made;
  Volume volume;
  volume.grids().all.push_back(coverage(c.points, c.faces, c.transform, made.sum, progress));
  made.hash = hash(volume);
  made.info = describe(volume).front();
  return made;
}

/// `onDevice`: makes the grid of a nano::CoverageJob.
template <typename OnDevice>
Covered coveredBy(const CoverageCase& c, const OnDevice& onDevice) {
  Progress progress;
  const CoverageFaces faces(c.points, c.faces, c.transform, progress);
  const nano::Result result = onDevice(faces.job());
  Volume volume;
  volume.grids().all.push_back(gridOfNano(result.bytes));
  return {hash(volume), describeNano(result.bytes), result.counts.coverage};
}

/// `small`: without those of many voxels.
inline std::vector<CoverageCase> coverageCases(bool small) {
  using namespace meshes;
  std::vector<CoverageCase> cases;
  cases.push_back(coveredBy("sphere", sphere({3, -70, 100}, 40.3, 12)));
  cases.push_back(coveredBy("a ball of tets", ball(6, 30, {-20, 5, 77})));
  cases.push_back(
      coveredBy("faces in the planes between cubes", box({-16.5, -8.5, 0.5}, {7.5, 9.5, 12.5}, 4)));
  cases.push_back(coveredBy("within a voxel", box({0.1, 0.2, 0.3}, {0.4, 0.3, 0.35})));
  const TriangleMesh ring = moved(torus(), [](const Vec3d& p) {
    return Vec3d{p[0] * 70 - 20.1, p[1] * 70 - 5000.7, p[2] * 70 + 3.3};
  });
  cases.push_back(coveredBy("anisotropic voxels", ring, {{0.9, 1.1, 1.7}, {0.25, -3, 8}}));
  cases.push_back(coveredBy("overlapping, inside out",
                            joined({sphere({0, 0, 0}, 30, 9), sphere({20, 3, 1}, 30, 9),
                                    flipped(sphere({10, 20, -6}, 30, 9))})));
  cases.push_back(coveredBy("tall", box({3, 1, -900}, {23, 13, 1100})));
  cases.push_back(coveredBy("nothing", TriangleMesh()));
  for (std::uint64_t seed = 0; seed < (small ? 2u : 12u); ++seed)
    cases.push_back(
        coveredBy("soup " + std::to_string(seed), soup(1 + seed * 7 % 40, 20 * double(1 + seed % 3),
                                                       seed % 2 == 0 ? 2 : 25, seed, 2)));
  if (small)
    return cases;
  // More slabs than a batch, of stacks that batches cut.
  cases.push_back(coveredBy("many slabs", sphere({10, 20, 30}, 230, 40)));
  return cases;
}

} // namespace tetvdb
