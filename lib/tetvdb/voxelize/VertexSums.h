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

/// Adds the terms (FaceSums.h) of the tets begin <= t < end, each turned to positive orientation,
/// to `sums`, which has a number for each point. Returns how many were turned and how many are
/// flat. Tets must not be longer than kMaxTetExtent. Eight tets at a time; those whose orientation
/// floats do not decide are oriented exactly, one by one.
OrientationCounts addToVertexSums(const SnappedMesh& mesh, std::size_t begin, std::size_t end,
                                  std::uint64_t* sums);

} // namespace tetvdb
