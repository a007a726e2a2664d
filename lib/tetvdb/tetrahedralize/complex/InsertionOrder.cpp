// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/InsertionOrder.h"

#include "tetvdb/core/MixBits.h"

#include <algorithm>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>

namespace tetvdb {
namespace {

constexpr int kBits = 20; // a side; three times that leave four bits for the round
constexpr std::uint64_t kLastRound = 8;

unsigned turnRight(unsigned bits, unsigned count) {
  return ((bits >> count) | (bits << (3 - count))) & 7u;
}
unsigned turnLeft(unsigned bits, unsigned count) {
  return turnRight(bits, (3 - count) % 3);
}

// Position along the curve of the cell with these coordinates. By entry points and directions of
// the octants: "Compact Hilbert indices", Hamilton and Rau-Chaplin, 2008.
std::uint64_t hilbertPosition(const std::array<std::uint32_t, 3>& cell) {
  constexpr unsigned kEntry[8] = {0, 0, 0, 3, 3, 6, 6, 5};     // Gray code of 2 * ((i - 1) / 2)
  constexpr unsigned kDirection[8] = {0, 1, 1, 2, 2, 1, 1, 0}; // the axis to the next octant
  std::uint64_t position = 0;
  unsigned entry = 0, direction = 0;
  for (int bit = kBits - 1; bit >= 0; --bit) {
    const unsigned octant =
        ((cell[0] >> bit) & 1u) | (((cell[1] >> bit) & 1u) << 1) | (((cell[2] >> bit) & 1u) << 2);
    const unsigned turned = turnRight(octant ^ entry, (direction + 1) % 3);
    const unsigned index = turned ^ (turned >> 1) ^ (turned >> 2); // of which it is the Gray code
    entry ^= turnLeft(kEntry[index], (direction + 1) % 3);
    direction = (direction + kDirection[index] + 1) % 3;
    position = (position << 3) | index;
  }
  return position;
}

// Round kLastRound for seven points of eight, the one before for seven of the other's eight, ...
std::uint64_t roundOf(std::size_t point) {
  std::uint64_t bits = hashOfIndex(point), round = kLastRound;
  for (; round > 0 && (bits & 7) == 0; bits >>= 3)
    --round;
  return round;
}

} // namespace

std::vector<std::uint32_t> insertionOrder(const std::vector<Vec3d>& points, std::size_t first,
                                          const Box& box) {
  struct Place {
    std::uint64_t key;
    std::uint32_t point;
    bool operator<(const Place& other) const {
      return std::tie(key, point) < std::tie(other.key, other.point);
    }
  };
  double side = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    side = std::max(side, box.high[axis] - box.low[axis]);
  constexpr double kCells = 1 << kBits;
  std::vector<Place> places(points.size() - first);
  tbb::parallel_for(std::size_t(0), places.size(), [&](std::size_t i) {
    std::array<std::uint32_t, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = (points[first + i][axis] - box.low[axis]) / side * kCells;
      cell[axis] = static_cast<std::uint32_t>(std::clamp(x, 0.0, kCells - 1));
    }
    places[i] = {(roundOf(i) << (3 * kBits)) | hilbertPosition(cell),
                 static_cast<std::uint32_t>(first + i)};
  });
  tbb::parallel_sort(places);
  std::vector<std::uint32_t> order(places.size());
  std::transform(places.begin(), places.end(), order.begin(),
                 [](const Place& place) { return place.point; });
  return order;
}

} // namespace tetvdb
