// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"

#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kGroupPoints = 64; // at most
constexpr double kColumnPoints = 48;     // on average, where points are spread evenly
constexpr std::ptrdiff_t kPointsPerTask = 4096;
// Where there are more faces than this below a group, they are searched for point by point.
constexpr std::size_t kGroupFaces = 384;

Vec3d vectorOf(const LatticePoint& p) {
  return {p.x, p.y, p.z};
}

std::vector<Box> boxesOf(const std::vector<ChainWinding::Face>& faces) {
  std::vector<Box> boxes(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (const LatticePoint* corner : {&faces[i].a, &faces[i].b, &faces[i].c})
      boxes[i].add(vectorOf(*corner));
  return boxes;
}

// A point and its number: together, so that parting them reads memory in order.
struct Item {
  Vec3d at;
  std::uint32_t number;
};

// Parts points at the median of their box's longest side until groups are small; begins[i] is where
// group i begins.
void findCubes(std::vector<Item>& items, std::ptrdiff_t begin, std::ptrdiff_t end,
               std::vector<std::uint32_t>& begins) {
  if (end - begin <= static_cast<std::ptrdiff_t>(kGroupPoints)) {
    begins.push_back(static_cast<std::uint32_t>(begin));
    return;
  }
  const auto position = [](const Item& item) -> const Vec3d& { return item.at; };
  const std::ptrdiff_t median = begin + (end - begin) / 2;
  const auto first = items.begin() + begin, last = items.begin() + end;
  splitAlongAxis(longestAxis(first, last, position), first, items.begin() + median, last, position,
                 [](const Item& item) { return item.number; });
  std::vector<std::uint32_t> later;
  const auto low = [&] { findCubes(items, begin, median, begins); };
  const auto high = [&] { findCubes(items, median, end, later); };
  if (end - begin > kPointsPerTask) {
    tbb::parallel_invoke(low, high);
  } else {
    low();
    high();
  }
  begins.insert(begins.end(), later.begin(), later.end());
}

// Sorts points by the squares of a grid that they are above; groups are parts of these.
void findColumns(std::vector<Item>& items, std::vector<std::uint32_t>& begins) {
  if (items.empty())
    return;
  Box box;
  for (const Item& item : items)
    box.add(item.at);
  const double width = box.high[0] - box.low[0], depth = box.high[1] - box.low[1];
  const double share = kColumnPoints / static_cast<double>(items.size());
  // Coordinates are whole numbers.
  const double side =
      std::max({1.0, std::sqrt(width * depth * share), width * share, depth * share});
  const auto squaresOf = [&](double length) { return static_cast<std::size_t>(length / side); };
  const std::size_t rowLength = squaresOf(width) + 1;
  const auto squareOf = [&](const Item& item) {
    return squaresOf(item.at[1] - box.low[1]) * rowLength + squaresOf(item.at[0] - box.low[0]);
  };
  std::vector<std::uint32_t> ends((squaresOf(depth) + 1) * rowLength + 1, 0);
  for (const Item& item : items)
    ++ends[squareOf(item) + 1];
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  for (std::size_t square = 0; square + 1 < ends.size(); ++square)
    for (std::uint32_t i = ends[square]; i < ends[square + 1]; i += kGroupPoints)
      begins.push_back(i);
  std::vector<Item> sorted(items.size());
  for (const Item& item : items)
    sorted[ends[squareOf(item)]++] = item;
  items = std::move(sorted);
}

// Whether the moved point is above the plane of a face that is not vertical: the side of its plane,
// in the plane the sign that the move gives.
bool isInFrontOf(const ChainWinding::Face& face, const LatticePoint& p) {
  const Vec3d a = vectorOf(face.a), b = vectorOf(face.b), c = vectorOf(face.c);
  if (const int side = latticeOrientation(a, b, c, vectorOf(p)); side != 0)
    return side > 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d moved = a;
    moved[axis] += 1;
    if (const int side = latticeOrientation(a, b, c, moved); side != 0)
      return side > 0;
  }
  return false;
}

} // namespace

PointGroups::PointGroups(const std::vector<LatticePoint>& points, Shape shape) {
  std::vector<Item> items(points.size());
  for (std::uint32_t i = 0; i < items.size(); ++i)
    items[i] = {vectorOf(points[i]), i};
  if (shape == Shape::Columns)
    findColumns(items, begins);
  else
    findCubes(items, 0, static_cast<std::ptrdiff_t>(items.size()), begins);
  begins.push_back(static_cast<std::uint32_t>(items.size()));
  for (const Item& item : items) {
    x.push_back(item.at[0]);
    y.push_back(item.at[1]);
    z.push_back(item.at[2]);
    numbers.push_back(item.number);
  }
}

ChainWinding::ChainWinding(std::vector<Face> faces, std::vector<BoundaryEdge> boundary)
    : faces_(std::move(faces)), tree_(boxesOf(faces_)), boundary_(std::move(boundary)) {}

// +weight where a ray down from the moved point leaves through the face, -weight where it enters.
std::int32_t ChainWinding::crossing(const Face& face, const LatticePoint& p) {
  const Vec3d a = from(p, face.a), b = from(p, face.b), c = from(p, face.c);
  const double ab = turn(a, b), bc = turn(b, c), ca = turn(c, a);
  const bool looksUp = ab > 0 && bc > 0 && ca > 0, looksDown = ab < 0 && bc < 0 && ca < 0;
  if (!looksUp && !looksDown)
    return 0;
  const bool above = (a[2] < 0 && b[2] < 0 && c[2] < 0) ||
                     (!(a[2] > 0 && b[2] > 0 && c[2] > 0) && isInFrontOf(face, p) == looksUp);
  return above ? (looksDown ? face.weight : -face.weight) : 0;
}

std::int64_t ChainWinding::facesBelow(const LatticePoint& p) const {
  std::int64_t sum = 0;
  tree_.visit(
      [&](const Box& box) {
        return box.low[0] <= p.x && box.high[0] >= p.x && box.low[1] <= p.y && box.high[1] >= p.y &&
               box.low[2] <= p.z;
      },
      [&](std::uint32_t face) {
        sum += crossing(faces_[face], p);
        return false;
      });
  return sum;
}

// But for whole numbers, in curtains, s is within |gradient| r + bend r^2 / 2 of what it is at the
// centre.
bool ChainWinding::staysRound(const Vec3d& centre, double reach) const {
  if (boundary_.empty())
    return true;
  const Vec3d median = roundToLattice(centre);
  const double wide = reach + 1; // the centre may be moved by less than one
  const LatticePoint at{median[0], median[1], median[2]};
  const BoundaryWinding::Slope slope = boundary_.slope(at, wide);
  if (!std::isfinite(slope.bend))
    return false;
  const Vec3d gradient{slope.gradient[0], slope.gradient[1], slope.gradient[2]};
  const double change = (length(gradient) + slope.error + slope.bend * wide / 2) * wide;
  const double margin =
      kFromHalf + (boundary_.rough() ? 2 * kRoughWindingError : 2 * kBoundaryWindingError);
  if (!(change + margin < 0.5))
    return false;
  const double s = boundary_.at(at);
  return std::abs(s - std::nearbyint(s)) + change + margin < 0.5;
}

void ChainWinding::atGroup(const PointGroups& groups, std::size_t group, double* winding) const {
  const std::size_t begin = groups.begins[group], count = groups.begins[group + 1] - begin;
  const double *x = groups.x.data() + begin, *y = groups.y.data() + begin,
               *z = groups.z.data() + begin;
  Box around;
  for (std::size_t i = 0; i < count; ++i)
    around.add(Vec3d{x[i], y[i], z[i]});
  BoundaryPoints sums;
  if (!boundary_.empty()) {
    sums = {{x, x + count}, {y, y + count}, {z, z + count}, std::vector<double>(count, 0)};
    const Vec3d half = times(minus(around.high, around.low), 0.5), centre = plus(around.low, half);
    boundary_.at({centre[0], centre[1], centre[2]}, length(half), sums);
  }

  std::vector<std::uint32_t> below;
  tree_.visit(
      [&](const Box& other) {
        return other.low[0] <= around.high[0] && other.high[0] >= around.low[0] &&
               other.low[1] <= around.high[1] && other.high[1] >= around.low[1] &&
               other.low[2] <= around.high[2];
      },
      [&](std::uint32_t face) {
        below.push_back(face);
        return below.size() > kGroupFaces;
      });
  std::array<std::int64_t, kGroupPoints> crossings{};
  if (below.size() > kGroupFaces) {
    for (std::size_t i = 0; i < count; ++i)
      crossings[i] = facesBelow({x[i], y[i], z[i]});
  } else {
    for (const std::uint32_t face : below) {
      const Box& box = tree_.box(face);
      std::array<std::uint8_t, kGroupPoints> isOver{};
      for (std::size_t i = 0; i < count; ++i) // without branches, so that compilers use lanes
        isOver[i] = static_cast<std::uint8_t>(int(box.low[0] <= x[i]) & int(x[i] <= box.high[0]) &
                                              int(box.low[1] <= y[i]) & int(y[i] <= box.high[1]) &
                                              int(box.low[2] <= z[i]));
      for (std::size_t i = 0; i < count; ++i)
        if (isOver[i])
          crossings[i] += crossing(faces_[face], {x[i], y[i], z[i]});
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    winding[groups.numbers[begin + i]] =
        static_cast<double>(crossings[i]) + (boundary_.empty() ? 0 : sums.sum[i]);
}

std::vector<double> ChainWinding::at(const std::vector<LatticePoint>& points,
                                     Progress& progress) const {
  using Shape = PointGroups::Shape;
  return at(PointGroups(points, boundary_.empty() ? Shape::Columns : Shape::Cubes), progress);
}

std::vector<double> ChainWinding::at(const PointGroups& groups, Progress& progress) const {
  std::vector<double> winding(groups.pointCount());
  tbb::parallel_for(std::size_t(0), groups.size(), [&](std::size_t group) {
    progress.check();
    atGroup(groups, group, winding.data());
  });
  return winding;
}

} // namespace tetvdb
