// SPDX-License-Identifier: Apache-2.0
//
// Values that are rounded have the same bits on every processor and by every compiler.
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/SolidAngle.h"

#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <vector>

namespace tetvdb {
namespace {

class Bits {
public:
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    hash_ = (hash_ ^ bits) * 0x100000001b3u;
    hash_ ^= hash_ >> 29;
  }
  std::uint64_t hash() const { return hash_; }

private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

// The standard fixes the engine's numbers, but not those of its distributions.
class Numbers {
public:
  double next() {
    return static_cast<double>(static_cast<std::int64_t>(engine_() % 2000001) - 1000000);
  }
  LatticePoint point() {
    const double x = next(), y = next();
    return {x, y, next()};
  }

private:
  std::mt19937_64 engine_{7};
};

std::uint64_t windingBits(std::size_t edges) {
  Numbers numbers;
  std::vector<BoundaryEdge> loop;
  const LatticePoint first = numbers.point();
  LatticePoint last = first;
  while (loop.size() < edges) {
    const LatticePoint next = loop.size() + 1 < edges ? numbers.point() : first;
    loop.push_back({last, next, 1});
    last = next;
  }
  const BoundaryWinding winding(std::move(loop));
  Bits bits;
  for (int i = 0; i < 300; ++i)
    bits.add(winding.at(numbers.point()));
  return bits.hash();
}

template <typename Add>
std::uint64_t angleBits(const Add& add) {
  Numbers numbers;
  std::array<double, kMaxPointSums> x{}, y{}, z{}, sum{};
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = numbers.next();
    y[i] = numbers.next();
    z[i] = numbers.next();
  }
  for (int i = 0; i < 100; ++i) {
    SeenTriangle t;
    for (Vec3d* corner : {&t.a, &t.b, &t.c})
      for (double& c : *corner)
        c = numbers.next();
    add(t, PointSums{x.data(), y.data(), z.data(), sum.data(), sum.size()});
  }
  Bits bits;
  for (const double value : sum)
    bits.add(value);
  return bits.hash();
}

TEST(SameBits, WindingOfBoundaryEdges) {
  EXPECT_EQ(windingBits(3), 3377834042021558592u);
  EXPECT_EQ(windingBits(3000), 10299330306057510286u);
}

TEST(SameBits, SolidAngles) {
  EXPECT_EQ(angleBits([](const SeenTriangle& t, const PointSums& p) { addSolidAngles(t, 3, p); }),
            2554443727212825881u);
  EXPECT_EQ(angleBits([](const SeenTriangle& t, const PointSums& p) {
              addFarSolidAngles(t, 3, 1000, p);
            }),
            13568696015039425015u);
}

} // namespace
} // namespace tetvdb
