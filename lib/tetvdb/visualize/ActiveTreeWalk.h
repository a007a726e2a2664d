// SPDX-License-Identifier: Apache-2.0
//
// The descent of an ActiveTree along a ray: steps through empty cubes, each as large as the tree
// shows to be empty. Internal.
//
// Sources: K. Museth, "Hierarchical Digital Differential Analyzer for Efficient Ray-Marching in
// OpenVDB" (SIGGRAPH Talks 2014) for steps over empty nodes; nodes with 64 bits for their
// 4 x 4 x 4 cells are those of sparse 64-trees.
#pragma once

#include "tetvdb/visualize/ActiveTree.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace tetvdb {

/// Of 4^3 cells in 64 bits, x slowest: those that a ray through a cell can still reach, itself
/// included. By octant of the ray's direction (bit a: towards lower coordinates along axis a) and
/// cell.
class CellsAhead {
public:
  CellsAhead() {
    for (std::uint32_t octant = 0; octant < 8; ++octant)
      for (std::uint32_t from = 0; from < 64; ++from)
        for (std::uint32_t to = 0; to < 64; ++to) {
          bool reached = true;
          for (std::uint32_t a = 0; a < 3; ++a) {
            const std::uint32_t f = from >> (4 - 2 * a) & 3, t = to >> (4 - 2 * a) & 3;
            reached = reached && (octant >> a & 1 ? t <= f : t >= f);
          }
          cells_[octant][from] |= std::uint64_t(reached) << to;
        }
  }
  const std::array<std::uint64_t, 64>& of(std::uint32_t octant) const { return cells_[octant]; }

private:
  std::array<std::array<std::uint64_t, 64>, 8> cells_{};
};
inline const CellsAhead kCellsAhead;

/// Whether any of the 2^3 cells around a cell of 4^3 holds something.
inline bool holdsAround(std::uint64_t cells, std::uint32_t cell) {
  return (cells >> (cell & 0b101010) & 0x0000000000330033) != 0;
}

/// A place on the ray: a voxel, and where the ray enters it.
struct ActiveTree::Step {
  Vec3i at;
  double t;
  int axis;
  Vec3d origin, direction, inverse;
  Vec3i ahead;          ///< all bits where the direction is positive, else none
  std::uint32_t octant; ///< of the direction, as of CellsAhead
  double last;          ///< t at which the ray leaves the active voxels' box, or ends

  // By value: with references the compiler emits jumps, which are predicted badly here.
  static double lesser(double a, double b) { return a < b ? a : b; }
  static double greater(double a, double b) { return a > b ? a : b; }

  bool isWithin(const Vec3i& low, const Vec3i& high) const {
    int is = 1;
    for (std::size_t a = 0; a < 3; ++a)
      is &= int(at[a] >= low[a]) & int(at[a] <= high[a]);
    return is != 0;
  }
  /// Whether both are in the same cube of side 2^log2Side.
  bool isNear(const Vec3i& other, int log2Side) const {
    return ((at[0] ^ other[0]) | (at[1] ^ other[1]) | (at[2] ^ other[2])) >> log2Side == 0;
  }
  /// Moves to the first voxel behind the cube of side 2^log2Side around `at`. Along the axis by
  /// which the ray leaves, the new voxel is next to the cube; along the others it lies within the
  /// cube's range. Rounding can therefore neither skip a voxel nor go back.
  [[gnu::always_inline]] void leave(int log2Side) {
    const std::int32_t side = std::int32_t(1) << log2Side, inside = side - 1;
    Vec3i low{};
    Vec3d exit{};
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = at[a] & ~inside;
      exit[a] = (double(low[a]) + double(side & ahead[a]) - origin[a]) * inverse[a];
    }
    const bool second = exit[1] < exit[0];
    const double ofTwo = lesser(exit[1], exit[0]);
    const bool third = exit[2] < ofTwo;
    const int out = third ? 2 : int(second);
    t = greater(lesser(exit[2], ofTwo), t);
    for (std::size_t a = 0; a < 3; ++a) {
      const double part = origin[a] + t * direction[a] - double(low[a]);
      const auto beside = static_cast<std::int32_t>(lesser(greater(part, 0.0), double(inside)));
      const std::int32_t beyond = (side & ahead[a]) - (~ahead[a] & 1);
      at[a] = low[a] + (out == static_cast<int>(a) ? beyond : beside);
    }
    axis = out;
  }
};

/// What comes after a cube that holds something.
enum class ActiveTree::Onward { Stop, RayEnds, Continue };

template <class AtLeaf, class AtTile>
bool ActiveTree::descend(const IndexRay& ray, const AtLeaf& atLeaf, const AtTile& atTile) const {
  Step step{{}, 0, -1, ray.origin, ray.direction, {}, {}, 0, 0};
  if (!enter(ray, step))
    return false;
  // False where the ray ends.
  const auto leave = [&](int log2Side) __attribute__((always_inline)) {
    step.leave(log2Side);
    return step.t <= ray.tMax && step.isWithin(low_, high_);
  };
  const Vec3i& v = step.at;
  const std::array<std::uint64_t, 64>& ahead = kCellsAhead.of(step.octant);
  for (;;) { // corners of the root
    const Corner* corner = this->corner({v[0] >> 12, v[1] >> 12, v[2] >> 12});
    if (!corner || !corner->upper) {
      if (corner && corner->on && atTile(step, 12))
        return true;
      if (!leave(12))
        return false;
      continue;
    }
    const Vec3i inCorner = v;
    do { // cells of 128^3
      const Upper& upper = *corner->upper;
      const std::uint64_t group = upper.groups[place<3>(v, 9)];
      const std::uint32_t one = place<2>(v, 7);
      if (!(group >> one & 1)) {
        if (!leave(!(group & ahead[one]) ? 9 : holdsAround(group, one) ? 7 : 8))
          return false;
        continue;
      }
      const std::uint32_t bit = place<5>(v, 7);
      if (!upper.children->isOn(bit)) {
        if (atTile(step, 7))
          return true;
        if (!leave(7))
          return false;
        continue;
      }
      const Lower& lower = lowers_[upper.child(bit)];
      const Vec3i inLower = v;
      do { // blocks of 4^3 leaf nodes
        const std::uint32_t block = place<2>(v, 5);
        const std::uint64_t cells = lower.cells[block];
        if (!cells) {
          if (!leave(lower.blocks & ahead[block] ? 5 : 7))
            return false;
          continue;
        }
        const std::uint32_t cell = place<2>(v, 3);
        if (!(cells >> cell & 1)) {
          if (!leave(!(cells & ahead[cell]) ? 5 : holdsAround(cells, cell) ? 3 : 4))
            return false;
          continue;
        }
        const std::uint32_t child = place<4>(v, 3);
        if (!lower.children->isOn(child)) {
          if (atTile(step, 3))
            return true;
          if (!leave(3))
            return false;
          continue;
        }
        switch (atLeaf(step, leaves_[lower.child(child)], ahead, leave)) {
        case Onward::Stop:
          return true;
        case Onward::RayEnds:
          return false;
        case Onward::Continue:
          break;
        }
      } while (step.isNear(inLower, 7));
    } while (step.isNear(inCorner, 12));
  }
}

template <class Stop>
bool ActiveTree::walk(const IndexRay& ray, const Stop& stop) const {
  const auto atCube = [&](const Step& step, int log2Side) {
    Step next = step;
    next.leave(log2Side);
    return stop(step.t, std::min(next.t, step.last));
  };
  return descend(
      ray,
      [&](const Step& step, const Leaf&, const auto&, const auto& leave) {
        return atCube(step, 3) ? Onward::Stop : leave(3) ? Onward::Continue : Onward::RayEnds;
      },
      atCube);
}

} // namespace tetvdb
