// SPDX-License-Identifier: Apache-2.0
//
// The traversal of an ActiveTree by a ray. Internal.
//
// Source: J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics
// 1987, once for each level of the tree.
#pragma once

#include "tetvdb/visualize/ActiveTree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetvdb {

/// Cells of side 2^log2Side within the cells from `low` to `high`. It ends where it leaves these,
/// not at a t, so that rounding can neither skip a cell nor leave the parent.
struct ActiveTree::Cells {
  Vec3i cell; ///< in units of its side
  double t;
  int axis;

  /// `inverse` is that of the ray's direction; infinite where that is 0. Three of these are made
  /// for a leaf: as a call it takes an eighth of a ray's time.
  [[gnu::always_inline]] Cells(const IndexRay& ray, const Vec3d& inverse, double begin,
                               int enteredBy, int log2Side, const Vec3i& low, const Vec3i& high)
      : t(begin), axis(enteredBy), low_(low), high_(high) {
    const auto side = static_cast<double>(1 << log2Side);
    const double perSide = 1 / side; // exact
    for (std::size_t a = 0; a < 3; ++a) {
      const double d = ray.direction[a];
      const double place = std::floor((ray.origin[a] + begin * d) * perSide);
      const double inside = std::min(std::max(place, double(low[a])), double(high[a]));
      cell[a] = static_cast<std::int32_t>(inside);
      step_[a] = d > 0 ? 1 : -1;
      delta_[a] = std::abs(inverse[a]) * side;
      const double face = (d > 0 ? inside + 1 : inside) * side;
      next_[a] =
          d == 0 ? std::numeric_limits<double>::infinity() : (face - ray.origin[a]) * inverse[a];
    }
  }
  double leaves() const { return std::min(next_[0], std::min(next_[1], next_[2])); }
  [[gnu::always_inline]] bool step() {
    std::size_t a = next_[0] <= next_[1] ? 0 : 1;
    a = next_[2] < next_[a] ? 2 : a;
    if (next_[a] == std::numeric_limits<double>::infinity())
      return false;
    t = std::max(t, next_[a]);
    next_[a] += delta_[a];
    cell[a] += step_[a];
    axis = static_cast<int>(a);
    return cell[a] >= low_[a] && cell[a] <= high_[a];
  }

  /// The part of the ray in the cell, up to `last`.
  Span span(int log2Side, const Mask3* mask, double last, const Vec3d& inverse) const {
    Span s;
    s.origin = scaled(cell, log2Side);
    s.log2Side = log2Side;
    s.mask = mask;
    s.begin = t;
    s.end = std::min(last, leaves());
    s.axis = axis;
    s.inverse = &inverse;
    return s;
  }

  // Cells of another size: the one around a cell, the first and the last one within it.
  static Vec3i shifted(const Vec3i& v, int by) { return {v[0] >> by, v[1] >> by, v[2] >> by}; }
  static Vec3i scaled(const Vec3i& v, int by) {
    return {v[0] * (1 << by), v[1] * (1 << by), v[2] * (1 << by)};
  }
  static Vec3i filled(const Vec3i& v, int by) {
    const std::int32_t ones = (1 << by) - 1;
    return {v[0] * (1 << by) + ones, v[1] * (1 << by) + ones, v[2] * (1 << by) + ones};
  }

private:
  Vec3i low_, high_, step_{};
  Vec3d next_{}, delta_{};
};

/// The part of a ray within the active voxels' box, and the axis by which it enters. False where
/// there is none.
inline bool ActiveTree::clip(const IndexRay& ray, const Vec3d& inverse, double& begin, double& end,
                             int& enteredBy) const {
  for (std::size_t a = 0; a < 3; ++a) {
    const double low = low_[a], high = double(high_[a]) + 1, d = ray.direction[a];
    if (d == 0) {
      if (ray.origin[a] < low || ray.origin[a] >= high)
        return false;
      continue;
    }
    const double in = ((d > 0 ? low : high) - ray.origin[a]) * inverse[a];
    const double out = ((d > 0 ? high : low) - ray.origin[a]) * inverse[a];
    if (in > begin) {
      begin = in;
      enteredBy = static_cast<int>(a);
    }
    end = std::min(end, out);
  }
  return begin <= end;
}

template <class Stop>
bool ActiveTree::walk(const IndexRay& ray, const Stop& stop) const {
  double begin = ray.tMin, end = ray.tMax;
  int enteredBy = -1;
  Vec3d inverse;
  for (std::size_t a = 0; a < 3; ++a)
    inverse[a] = 1 / ray.direction[a];
  if (!clip(ray, inverse, begin, end, enteredBy))
    return false;

  const auto visit = [&](const Cells& cells, int log2Side, const Mask3* mask) {
    return stop(cells.span(log2Side, mask, end, inverse));
  };
  Cells root(ray, inverse, begin, enteredBy, 12, Cells::shifted(low_, 12),
             Cells::shifted(high_, 12));
  do {
    const Corner* at = corner(root.cell);
    if (!at)
      continue;
    if (!at->upper) {
      if (at->on && visit(root, 12, nullptr))
        return true;
      continue;
    }
    const Upper& upper = *at->upper;
    Cells upperCells(ray, inverse, root.t, root.axis, 7, Cells::scaled(root.cell, 5),
                     Cells::filled(root.cell, 5));
    do {
      const Vec3i& u = upperCells.cell;
      const auto bit =
          static_cast<std::uint32_t>((u[0] & 31) << 10 | (u[1] & 31) << 5 | (u[2] & 31));
      if (!upper.children->isOn(bit)) {
        if (upper.tiles->isOn(bit) && visit(upperCells, 7, nullptr))
          return true;
        continue;
      }
      const Lower& lower = lowers_[upper.child(bit)];
      Cells blocks(ray, inverse, upperCells.t, upperCells.axis, 5, Cells::scaled(u, 2),
                   Cells::filled(u, 2));
      do {
        const Vec3i& b = blocks.cell;
        if (!(lower.blocks >> ((b[0] & 3) << 4 | (b[1] & 3) << 2 | (b[2] & 3)) & 1))
          continue;
        Cells leaves(ray, inverse, blocks.t, blocks.axis, 3, Cells::scaled(b, 2),
                     Cells::filled(b, 2));
        do {
          const Vec3i& l = leaves.cell;
          const std::uint32_t place = ActiveTree::place<4>(l, 0);
          if (lower.children->isOn(place)) {
            if (visit(leaves, 3, leaves_[lower.child(place)].mask))
              return true;
          } else if (lower.tiles->isOn(place) && visit(leaves, 3, nullptr)) {
            return true;
          }
        } while (leaves.step() && leaves.t <= end);
      } while (blocks.step() && blocks.t <= end);
    } while (upperCells.step() && upperCells.t <= end);
  } while (root.step() && root.t <= end);
  return false;
}

} // namespace tetvdb
