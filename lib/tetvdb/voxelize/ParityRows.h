// SPDX-License-Identifier: Apache-2.0
//
// Occupancy of rows of a slab where the sum of their crossings stays 0 or 1: it is the parity of
// the crossings then, and parity is 64 voxels at a time.
#pragma once

#include <cstdint>

namespace tetvdb {

constexpr int kParityRows = 64; ///< rows at a time

/// Of kParityRows rows, each of 128 bits: those where a crossing enters or leaves; the sums before
/// them. Sets `inside`. The sum stays 0 or 1 if every entering crossing is followed by a voxel
/// inside and every leaving one by one outside: `failed` is not 0 for the rows where it does not,
/// whose `inside` has no meaning. Returns whether there is any of these.
bool parityRows(const std::uint64_t (*entering)[2], const std::uint64_t (*leaving)[2],
                const std::int32_t* sums, std::uint64_t (*inside)[2], std::uint64_t* failed);

} // namespace tetvdb
