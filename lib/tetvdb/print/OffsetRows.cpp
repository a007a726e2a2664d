// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/OffsetRows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tetvdb {
namespace {

using Point = std::array<double, 2>;

// The part of a horizontal line at y within a distance of a segment; empty if low >
// high.
struct Reach {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

// The points within a distance of a segment are convex: two discs, and a rectangle between them.
Reach nearSegment(const Point& a, const Point& b, double distance, double y) {
  Reach span;
  for (const Point& end : {a, b}) {
    const double squared = distance * distance - (y - end[1]) * (y - end[1]);
    if (squared < 0)
      continue;
    span.include(end[0] - std::sqrt(squared));
    span.include(end[0] + std::sqrt(squared));
  }
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  if (length == 0 || a[1] == b[1])
    return span;
  for (const double side : {distance / length, -distance / length}) {
    const double shiftX = (a[1] - b[1]) * side, shiftY = (b[0] - a[0]) * side;
    const double t = (y - a[1] - shiftY) / (b[1] - a[1]);
    if (t >= 0 && t <= 1)
      span.include(a[0] + shiftX + t * (b[0] - a[0]));
  }
  return span;
}

} // namespace

void OffsetRows::add(std::int64_t line, double x, int winding, int near) {
  changes_.push_back({line, std::clamp(x, 0.0, double(frame_.width)), winding, near});
}

void OffsetRows::addLine(const Point& from, const Point& to, int weight) {
  const double reach = std::abs(distance_);
  const double low = std::min(from[1], to[1]), high = std::max(from[1], to[1]);
  const double rows = reach / frame_.pixelHeight;
  const auto lineAt = [&](double y) { return y * lines_ - 0.5; };
  const auto last = static_cast<std::int64_t>(frame_.height) * lines_ - 1;
  const auto first =
      std::max<std::int64_t>(static_cast<std::int64_t>(std::ceil(lineAt(low - rows))), 0);
  const auto end = std::min(static_cast<std::int64_t>(std::floor(lineAt(high + rows))), last);
  const auto millimetres = [&](const Point& p) {
    return Point{p[0] * frame_.pixelWidth, p[1] * frame_.pixelHeight};
  };
  const Point a = millimetres(from), b = millimetres(to);
  for (std::int64_t line = first; line <= end; ++line) {
    const double y = (static_cast<double>(line) + 0.5) / lines_;
    const bool up = from[1] <= y && y < to[1], down = to[1] <= y && y < from[1];
    if (up || down) {
      const double t = (y - from[1]) / (to[1] - from[1]);
      add(line, from[0] + t * (to[0] - from[0]), up ? -weight : weight, 0);
    }
    const Reach span = nearSegment(a, b, reach, y * frame_.pixelHeight);
    if (span.low < span.high) {
      add(line, span.low / frame_.pixelWidth, 0, 1);
      add(line, span.high / frame_.pixelWidth, 0, -1);
    }
  }
}

void OffsetRows::finishPlane(double part, PixelSums& sums) {
  std::sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
    return std::tie(a.line, a.x, a.winding, a.near) < std::tie(b.line, b.x, b.winding, b.near);
  });
  const auto addEnd = [&](const Change& at, double sign) {
    const double column = std::floor(at.x);
    sums.add(static_cast<std::int32_t>(column), static_cast<std::int32_t>(at.line / lines_),
             sign * part, sign * part * (column + 1 - at.x));
  };
  int winding = 0, near = 0;
  bool inside = false;
  for (std::size_t i = 0; i < changes_.size(); ++i) {
    const Change& change = changes_[i];
    winding += change.winding;
    near += change.near;
    const bool more = i + 1 < changes_.size() && changes_[i + 1].line == change.line &&
                      changes_[i + 1].x == change.x;
    const bool now = distance_ > 0 ? winding > 0 || near > 0 : winding > 0 && near == 0;
    if (more || now == inside)
      continue;
    addEnd(change, now ? 1 : -1);
    inside = now;
  }
  changes_.clear();
}

} // namespace tetvdb
