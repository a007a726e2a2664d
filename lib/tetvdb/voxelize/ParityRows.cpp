// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/ParityRows.h"

#include "tetvdb/core/Multiversion.h"

namespace tetvdb {
namespace {

// Bit z of the result: parity of the bits at or below z.
TETVDB_INLINE std::uint64_t prefixXor(std::uint64_t w) {
  w ^= w << 1;
  w ^= w << 2;
  w ^= w << 4;
  w ^= w << 8;
  w ^= w << 16;
  w ^= w << 32;
  return w;
}

// All bits as the last one.
TETVDB_INLINE std::uint64_t spread(std::uint64_t bit) {
  return std::uint64_t(0) - bit;
}

} // namespace

// No branches: rows are taken by as many as the processor's vectors hold.
TETVDB_MULTIVERSION
bool parityRows(const std::uint64_t (*entering)[2], const std::uint64_t (*leaving)[2],
                const std::int32_t* sums, std::uint64_t (*inside)[2], std::uint64_t* failed) {
  std::uint64_t any = 0;
  for (int r = 0; r < kParityRows; ++r) {
    const std::uint64_t in0 = entering[r][0] & ~leaving[r][0];
    const std::uint64_t out0 = leaving[r][0] & ~entering[r][0];
    const std::uint64_t in1 = entering[r][1] & ~leaving[r][1];
    const std::uint64_t out1 = leaving[r][1] & ~entering[r][1];
    const auto sum = static_cast<std::uint32_t>(sums[r]);
    const std::uint64_t low = prefixXor(in0 | out0) ^ spread(sum & 1);
    const std::uint64_t high = prefixXor(in1 | out1) ^ spread(low >> 63);
    inside[r][0] = low;
    inside[r][1] = high;
    failed[r] = (in0 & ~low) | (out0 & low) | (in1 & ~high) | (out1 & high) | (sum & ~1U);
    any |= failed[r];
  }
  return any != 0;
}

} // namespace tetvdb
