// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"

#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kGroupPoints = 64;
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
void findGroups(std::vector<Item>& items, std::ptrdiff_t begin, std::ptrdiff_t end,
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
  const auto low = [&] { findGroups(items, begin, median, begins); };
  const auto high = [&] { findGroups(items, median, end, later); };
  if (end - begin > kPointsPerTask) {
    tbb::parallel_invoke(low, high);
  } else {
    low();
    high();
  }
  begins.insert(begins.end(), later.begin(), later.end());
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

struct ChainWinding::Group {
  const std::vector<LatticePoint>& points;
  const std::uint32_t *begin, *end; ///< numbers of points
};

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

void ChainWinding::atGroup(const Group& group, double* winding) const {
  Box box;
  BoundaryPoints sums;
  for (const std::uint32_t* i = group.begin; i != group.end; ++i) {
    const LatticePoint& p = group.points[*i];
    box.add(vectorOf(p));
    sums.x.push_back(p.x);
    sums.y.push_back(p.y);
    sums.z.push_back(p.z);
  }
  sums.sum.assign(sums.size(), 0);
  if (!boundary_.empty()) {
    const Vec3d half = times(minus(box.high, box.low), 0.5), centre = plus(box.low, half);
    boundary_.at({centre[0], centre[1], centre[2]}, length(half), sums);
  }

  std::vector<std::uint32_t> below;
  tree_.visit(
      [&](const Box& other) {
        return other.low[0] <= box.high[0] && other.high[0] >= box.low[0] &&
               other.low[1] <= box.high[1] && other.high[1] >= box.low[1] &&
               other.low[2] <= box.high[2];
      },
      [&](std::uint32_t face) {
        below.push_back(face);
        return below.size() > kGroupFaces;
      });
  std::size_t n = 0;
  for (const std::uint32_t* i = group.begin; i != group.end; ++i, ++n) {
    const LatticePoint& p = group.points[*i];
    std::int64_t sum = 0;
    if (below.size() > kGroupFaces) {
      sum = facesBelow(p);
    } else {
      for (const std::uint32_t face : below) {
        const Box& faceBox = tree_.box(face);
        if (faceBox.low[0] <= p.x && faceBox.high[0] >= p.x && faceBox.low[1] <= p.y &&
            faceBox.high[1] >= p.y && faceBox.low[2] <= p.z)
          sum += crossing(faces_[face], p);
      }
    }
    winding[*i] = static_cast<double>(sum) + sums.sum[n];
  }
}

std::vector<double> ChainWinding::at(const std::vector<LatticePoint>& points,
                                     Progress& progress) const {
  std::vector<Item> items(points.size());
  for (std::uint32_t i = 0; i < items.size(); ++i)
    items[i] = {vectorOf(points[i]), i};
  std::vector<std::uint32_t> begins;
  findGroups(items, 0, static_cast<std::ptrdiff_t>(items.size()), begins);
  begins.push_back(static_cast<std::uint32_t>(items.size()));
  std::vector<std::uint32_t> order(items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    order[i] = items[i].number;
  progress.check();
  std::vector<double> winding(points.size());
  tbb::parallel_for(std::size_t(0), begins.size() - 1, [&](std::size_t i) {
    progress.check();
    atGroup({points, order.data() + begins[i], order.data() + begins[i + 1]}, winding.data());
  });
  return winding;
}

} // namespace tetvdb
