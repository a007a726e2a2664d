// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/NanoBytes.h"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace tetvdb {

/// OpenVDB's grid for a NanoVDB grid in memory, aligned to 32 bytes, that this program built (mask,
/// bool, float, int32 or vector; breadth first). Its offsets are trusted: files are read by
/// readVolume(). A mask becomes a bool grid. Name, class and the transform by voxel size and origin
/// are copied. Parallel, by lower nodes; bound by the memory of the result.
openvdb::GridBase::Ptr gridOfNano(const unsigned char* bytes);

/// Memory for a grid, to be written, and what holds it. Throws Error(Limit).
std::pair<unsigned char*, NanoBytes> newNanoBytes(std::size_t size);

/// A copy in memory of its own. Throws Error(Limit).
NanoBytes copyOf(const NanoBytes& grid);

/// The result of describe() for gridOfNano(bytes), from the counts in the buffer's head: no node is
/// read but for shares (holdsShares()), whose sum is the volume. `insideVoxels`: of a level set.
GridInfo describeNano(const unsigned char* bytes, std::uint64_t insideVoxels = 0);

} // namespace tetvdb
