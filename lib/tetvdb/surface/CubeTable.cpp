// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CubeTable.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace tetvdb {
namespace {

using Loop = std::vector<std::uint8_t>;

constexpr int kNone = -1;

// Faces 2 f and 2 f + 1 are perpendicular to axis f, at 0 and at 1.
std::array<int, 2> facesOf(int edge) {
  const int axis = edge / 4;
  return {2 * ((axis + 1) % 3) + (edge & 1), 2 * ((axis + 2) % 3) + (edge >> 1 & 1)};
}

bool shareFace(int edge, int other) {
  for (const int face : facesOf(edge))
    for (const int otherFace : facesOf(other))
      if (face == otherFace)
        return true;
  return false;
}

int edgeBetween(int corner, int other) {
  const int low = std::min(corner, other);
  const int axis = (corner ^ other) == 1 ? 0 : (corner ^ other) == 2 ? 1 : 2;
  return 4 * axis + (low >> (axis + 1) % 3 & 1) + 2 * (low >> (axis + 2) % 3 & 1);
}

// A face's corners, counter-clockwise seen from outside the cube.
std::array<int, 4> cornersOf(int face) {
  const int axis = face / 2, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
  const int at = (face & 1) << axis;
  if (face & 1)
    return {at, at | u, at | u | v, at | v};
  return {at, at | v, at | u | v, at | u};
}

// The surface's line on a face runs from where the face's border enters the solid to where it
// leaves it. Seen from outside the cube, the solid is on the right. If a face has two lines, they
// join the solid across it: each line cuts off the outside corner before its first point.
void addLines(int face, unsigned inside, std::array<int, 12>& next) {
  const std::array<int, 4> corners = cornersOf(face);
  std::array<int, 4> step{}; // +1 where the border enters, -1 where it leaves
  for (std::size_t k = 0; k < 4; ++k)
    step[k] = static_cast<int>(inside >> corners[(k + 1) % 4] & 1) -
              static_cast<int>(inside >> corners[k] & 1);
  for (std::size_t k = 0; k < 4; ++k) {
    if (step[k] != 1)
      continue;
    std::size_t leaves = (k + 3) % 4;
    while (step[leaves] != -1)
      leaves = (leaves + 3) % 4;
    next[static_cast<std::size_t>(edgeBetween(corners[k], corners[(k + 1) % 4]))] =
        edgeBetween(corners[leaves], corners[(leaves + 1) % 4]);
  }
}

std::vector<Loop> loopsOf(unsigned inside) {
  std::array<int, 12> next;
  next.fill(kNone);
  for (int face = 0; face < 6; ++face)
    addLines(face, inside, next);
  std::vector<Loop> loops;
  for (std::size_t first = 0; first < 12; ++first) {
    if (next[first] == kNone)
      continue;
    Loop loop;
    for (auto edge = first; next[edge] != kNone;) {
      loop.push_back(static_cast<std::uint8_t>(edge));
      edge = static_cast<std::size_t>(std::exchange(next[edge], kNone));
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

// Between the edges' midpoints, in units of a quarter of the squared side.
double squaredDistance(int edge, int other) {
  Vec3i a = cubeEdgeStart(edge), b = cubeEdgeStart(other);
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    const int d = 2 * a[k] + (edge / 4 == axis) - 2 * b[k] - (other / 4 == axis);
    sum += d * d;
  }
  return sum;
}

// Triangulates a loop by chords inside the cube with the smallest sum of squared lengths, by
// dynamic programming. Every loop of the 256 cases has such chords; a test verifies it.
class LoopTriangulation {
public:
  explicit LoopTriangulation(const Loop& loop) : loop_(loop), n_(loop.size()) {
    cost_.assign(n_ * n_, 0);
    midpoint_.assign(n_ * n_, 0);
    for (std::size_t span = 2; span < n_; ++span)
      for (std::size_t i = 0; i + span < n_; ++i)
        solve(i, i + span);
  }

  void append(std::vector<std::uint8_t>& triangles) const { append(0, n_ - 1, triangles); }

private:
  static constexpr double kForbidden = std::numeric_limits<double>::infinity();

  double chord(std::size_t i, std::size_t j) const {
    if (j == i + 1 || (i == 0 && j == n_ - 1))
      return 0; // a line on a face of the cube
    return shareFace(loop_[i], loop_[j]) ? kForbidden : squaredDistance(loop_[i], loop_[j]);
  }
  void solve(std::size_t i, std::size_t j) {
    double best = kForbidden;
    for (std::size_t k = i + 1; k < j; ++k) {
      const double sum = cost_[i * n_ + k] + cost_[k * n_ + j] + chord(i, k) + chord(k, j);
      if (sum < best) {
        best = sum;
        midpoint_[i * n_ + j] = k;
      }
    }
    cost_[i * n_ + j] = best;
  }
  void append(std::size_t i, std::size_t j, std::vector<std::uint8_t>& triangles) const {
    if (j < i + 2)
      return;
    const std::size_t k = midpoint_[i * n_ + j];
    triangles.insert(triangles.end(), {loop_[i], loop_[k], loop_[j]});
    append(i, k, triangles);
    append(k, j, triangles);
  }

  const Loop& loop_;
  std::size_t n_;
  std::vector<double> cost_;
  std::vector<std::size_t> midpoint_;
};

CubeTriangles makeCase(unsigned inside) {
  CubeTriangles triangles;
  for (const Loop& loop : loopsOf(inside))
    LoopTriangulation(loop).append(triangles);
  return triangles;
}

} // namespace

const std::array<CubeTriangles, 256>& cubeTable() {
  static const std::array<CubeTriangles, 256> table = [] {
    std::array<CubeTriangles, 256> cases;
    for (unsigned inside = 0; inside < 256; ++inside)
      cases[inside] = makeCase(inside);
    return cases;
  }();
  return table;
}

} // namespace tetvdb
