// SPDX-License-Identifier: Apache-2.0
//
// The pass over all tets by which the boundary is found (BoundaryFaces.h): their orientations, and
// what their faces add to the sums of vertices. Internal.
#pragma once

#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetRaster.h"

#include <cstddef>
#include <cstdint>

namespace tetvdb {

/// Tets whose points are snapped to the lattice where they are needed. Points must lie in 32-bit
/// index space.
struct TetsToSnap {
  const double* points = nullptr; ///< three coordinates each
  std::size_t pointCount = 0;
  const std::uint32_t* tets = nullptr; ///< four indices each
  std::size_t tetCount = 0;
  GridTransform transform;

  LatticePoint point(std::uint32_t vertex) const {
    const double* p = points + 3 * std::size_t(vertex);
    return snapPoint({p[0], p[1], p[2]}, transform);
  }
};

/// Asks for the cache line of indices a page ahead of `at`: processors stop asking for what follows
/// at the end of a page. Of use once for every line, of kPrefetchGrain indices.
constexpr std::size_t kPrefetchGrain = 16;
inline void prefetchIndices(const std::uint32_t* at) {
  __builtin_prefetch(at + 1024);
}

/// Adds the terms (FaceSums.h) of the tets begin <= t < end, each turned to positive orientation,
/// to `sums`, which has a number for each point. Returns how many were turned and how many are
/// flat. Eight tets at a time; those whose orientation floats do not decide are oriented exactly,
/// one by one. Throws Error(Limit) for tets longer than kMaxTetExtent.
OrientationCounts addToVertexSums(const TetsToSnap& mesh, std::size_t begin, std::size_t end,
                                  std::uint64_t* sums);

/// The sign of orientation() of `count` tets, of four indices each.
void orientTets(const TetsToSnap& mesh, const std::uint32_t* tets, std::size_t count,
                std::int8_t* signs);

} // namespace tetvdb
