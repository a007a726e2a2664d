// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/volume/BitSource.h"

#include "tetvdb/core/Multiversion.h"

namespace tetvdb {

TETVDB_MULTIVERSION
std::uint64_t countLeafBits(const std::uint64_t* words, std::size_t leaves, std::uint16_t* bits) {
  std::uint64_t sum = 0;
  for (std::size_t l = 0; l < leaves; ++l) {
    int own = 0;
    for (std::size_t w = 0; w < 8; ++w)
      own += __builtin_popcountll(words[8 * l + w]);
    bits[l] = static_cast<std::uint16_t>(own);
    sum += static_cast<std::uint64_t>(own);
  }
  return sum;
}

} // namespace tetvdb
