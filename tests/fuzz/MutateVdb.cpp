// SPDX-License-Identifier: Apache-2.0
//
// The mutator of FuzzVdb: a grid states where its parts are, and a file is refused where one byte
// more or less moves them. Here numbers are changed where they stand, or bytes are put in or taken
// out and the places behind them stated anew.
#include "MutateNumber.h"

#include <algorithm>
#include <cstring>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace tetvdb {
namespace {

/// Adds `moved` to all numbers of 64 bits that can be places of the file behind `at`: fewer bytes
/// than that are not read as one by chance.
void moveOffsets(std::uint8_t* data, std::size_t size, std::size_t at, std::int64_t moved) {
  for (std::size_t i = 0; i + 8 <= size; ++i) {
    std::uint64_t number = 0;
    std::memcpy(&number, data + i, sizeof number);
    if (number <= std::max<std::size_t>(at, 64) || number > size)
      continue;
    number += static_cast<std::uint64_t>(moved);
    std::memcpy(data + i, &number, sizeof number);
    i += 7;
  }
}

std::size_t mutateFile(std::uint8_t* data, std::size_t size, std::size_t most,
                       std::minstd_rand& random) {
  constexpr std::size_t head = 1024; // metadata, offsets, a transform and a root node
  const std::size_t count = 1 + random() % 16;
  const std::size_t at = random() % std::min(size, random() % 2 == 0 ? head : size);
  switch (random() % 8) {
  case 0: // bytes in
    if (size + count > most)
      return 0;
    moveOffsets(data, size, at, static_cast<std::int64_t>(count));
    std::memmove(data + at + count, data + at, size - at);
    return size + count;
  case 1: // bytes out
    if (size - at <= count)
      return 0;
    moveOffsets(data, size, at, -static_cast<std::int64_t>(count));
    std::memmove(data + at, data + at + count, size - at - count);
    return size - count;
  default:
    for (auto changes = 1 + random() % 3; changes > 0; --changes)
      fuzz::mutateNumber(data, size, head, random);
    return size;
  }
}

} // namespace
} // namespace tetvdb

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  if (size > 0 && random() % 4 != 0)
    if (const std::size_t made = tetvdb::mutateFile(data, size, most, random))
      return made;
  return LLVMFuzzerMutate(data, size, most);
}
