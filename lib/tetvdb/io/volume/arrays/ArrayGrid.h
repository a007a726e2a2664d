// SPDX-License-Identifier: Apache-2.0
//
// Grids of the arrays that a file holds. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/arrays/StoredArray.h"

#include <cstdint>
#include <openvdb/openvdb.h>
#include <optional>
#include <string>

namespace tetvdb {

/// A grid and what was left out of it.
struct ArrayGrid {
  openvdb::GridBase::Ptr grid;
  std::uint64_t notNumbers = 0; ///< voxels that are NaN: inactive, with the background
};

/// One component, or all three as vectors. The type, the background and the class are those that
/// io/ArrayFile.h says; `background` decides where it is given. Bytes within array.bytes are
/// assumed to be there. In parallel, one 128^3 node at a time; a few ns a voxel. Throws
/// Error(Cancelled), Error(Limit) for integers beyond 2^63 - 1.
ArrayGrid gridOf(const StoredArray& array, const std::string& name,
                 const std::optional<double>& background, Progress& progress);

} // namespace tetvdb
