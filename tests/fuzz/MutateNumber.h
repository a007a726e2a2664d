// SPDX-License-Identifier: Apache-2.0
//
// A number of a binary file replaced by one that its reader may not expect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>

namespace tetvdb::fuzz {

/// Replaces a number of 1, 2, 4 or 8 bytes within `data` by a limit, by one near it, with one bit
/// flipped, or by a number of another place. Most bytes of volumes are zero: half of the time the
/// place is one that is not. `head` bytes at the front are chosen as often as all others.
inline void mutateNumber(std::uint8_t* data, std::size_t size, std::size_t head,
                         std::minstd_rand& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  const std::size_t width = std::size_t(1) << below(4);
  if (size < width)
    return;
  const std::size_t places = size - width + 1;
  std::size_t at = below(head > 0 && head < places && below(2) == 0 ? head : places);
  if (below(2) == 0)
    while (at + 1 < places && data[at] == 0)
      ++at;
  std::uint64_t old = 0, number = 0;
  std::memcpy(&old, data + at, width);
  switch (below(6)) {
  case 0: {
    const std::uint64_t limits[] = {0, 1, ~0ULL, ~0ULL >> 1, ~0ULL << (8 * width - 1), size};
    number = limits[below(6)];
    break;
  }
  case 1:
    number = old + 1 + below(32);
    break;
  case 2:
    number = old - 1 - below(32);
    break;
  case 3:
    number = old ^ (1ULL << below(8 * width));
    break;
  case 4:
    std::memcpy(&number, data + below(places), width);
    break;
  default:
    number = random();
  }
  std::memcpy(data + at, &number, width);
}

} // namespace tetvdb::fuzz
