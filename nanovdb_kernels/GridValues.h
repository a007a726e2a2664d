// SPDX-License-Identifier: Apache-2.0
//
// What kernels that write a grid need of its values, bits or vectors: their order, sums over them,
// and how nodes store them.
#pragma once

#include "NanoNodes.h"
#include "RasterizeTets.h"

#include <cmath>
#include <cstring>

namespace tetvdb::nano {

/// Values of the grid as bits.
struct GridValues {
  u32 inside, background;
  /// A level set: leaves have other values too, and tiles are inactive.
  bool narrowBand = false;
  /// Leaves and tiles have values of their own; `inside` is not used.
  bool varied = false;
  /// Of a grid of vectors, 512 a leaf: a tile's value as bits is the number of a leaf, and its
  /// vector the first of that leaf. The background is a float, of all components.
  const Vector* vectors = nullptr;
  /// Leaves have values of their own, active tiles are `inside`.
  bool variedLeaves = false;
};

/// Sums over a node's active values, where these differ.
struct Moments {
  double count, mean, squares; ///< squares: of the distances from the mean
};

/// Chan, Golub and LeVeque's update; in a fixed order the result is fixed.
TETVDB_HD inline void addMoments(Moments& a, const Moments& b) {
  if (b.count == 0)
    return;
  const double count = a.count + b.count, distance = b.mean - a.mean;
  a.squares = a.squares + b.squares + distance * distance * (a.count * b.count / count);
  a.mean = a.mean + distance * (b.count / count);
  a.count = count;
}

/// A number that has the order of the values, from the bits of a float (`isFloat`) or an int32; and
/// the bits from the number.
TETVDB_HD inline i32 inOrder(u32 bits, bool isFloat) {
  const i32 number = static_cast<i32>(bits);
  return isFloat && number < 0 ? number ^ 0x7FFFFFFF : number;
}

/// The value of such bits.
TETVDB_HD inline double numberFrom(u32 bits, bool isFloat) {
  return isFloat ? static_cast<double>(floatFrom(bits))
                 : static_cast<double>(static_cast<i32>(bits));
}

/// What NanoVDB's statistics are of: numbers, and the squared lengths of vectors, in floats.
TETVDB_HD inline float squaredLength(const Vector& v) {
  return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}
TETVDB_HD inline double statisticOf(u32 bits, bool isFloat) {
  return numberFrom(bits, isFloat);
}
TETVDB_HD inline double statisticOf(const Vector& v, bool) {
  return static_cast<double>(squaredLength(v));
}

/// `bits` of GridValues, and a tile's value, in a grid of V.
template <typename V>
TETVDB_HD V valueFrom(u32 bits);
template <>
TETVDB_HD inline u32 valueFrom<u32>(u32 bits) {
  return bits;
}
template <>
TETVDB_HD inline Vector valueFrom<Vector>(u32 bits) {
  return Vector(floatFrom(bits));
}
template <typename V>
TETVDB_HD V tileValue(const GridValues& values, i32 bits);
template <>
TETVDB_HD inline u32 tileValue<u32>(const GridValues&, i32 bits) {
  return static_cast<u32>(bits);
}
template <>
TETVDB_HD inline Vector tileValue<Vector>(const GridValues& values, i32 bits) {
  return values.vectors[512 * u64(static_cast<u32>(bits))];
}

/// The least and the largest value that a member of a team has seen; `place`: lower 32 bits, which
/// decide between vectors of one length.
template <typename V>
struct Extremes;
template <>
struct Extremes<u32> {
  i32 least = 0x7FFFFFFF, most = -0x7FFFFFFF - 1; ///< in order

  TETVDB_HD void add(u32 low, u32 high, u32, bool isFloat) {
    const i32 l = inOrder(low, isFloat), h = inOrder(high, isFloat);
    least = l < least ? l : least;
    most = h > most ? h : most;
  }
};
template <>
struct Extremes<Vector> {
  u64 least = ~u64(0), most = 0; ///< squared length, place
  Vector low = Vector(0.0F), high = Vector(0.0F);

  // The bits of floats that are not negative have their order.
  TETVDB_HD void add(const Vector& l, const Vector& h, u32 place, bool) {
    const u64 atLeast = u64(bitsOf(squaredLength(l))) << 32 | place;
    const u64 atMost = u64(bitsOf(squaredLength(h))) << 32 | (0xFFFFFFFFu - place);
    if (atLeast < least) {
      least = atLeast;
      low = l;
    }
    if (atMost > most) {
      most = atMost;
      high = h;
    }
  }
};

/// Those of all members, which the team shares.
template <typename V>
struct TeamExtremes {
  decltype(Extremes<V>::least) least, most;

  TETVDB_HD void clear() {
    least = Extremes<V>().least;
    most = Extremes<V>().most;
  }
  TETVDB_HD void join(const Extremes<V>& own) {
    minInto(&least, own.least);
    maxInto(&most, own.most);
  }
};
/// Called by the whole team, which has met after join(), where there are values.
template <typename Node>
TETVDB_HD void setExtremes(const Team& team, const TeamExtremes<u32>& all, const Extremes<u32>&,
                           bool isFloat, Node& node) {
  if (team.rank() != 0)
    return;
  node.mMinimum = static_cast<u32>(inOrder(static_cast<u32>(all.least), isFloat));
  node.mMaximum = static_cast<u32>(inOrder(static_cast<u32>(all.most), isFloat));
}
template <typename Node>
TETVDB_HD void setExtremes(const Team&, const TeamExtremes<Vector>& all,
                           const Extremes<Vector>& own, bool, Node& node) {
  if (own.least == all.least) // of one member alone, since places differ
    node.mMinimum = own.low;
  if (own.most == all.most)
    node.mMaximum = own.high;
}
template <typename Node>
TETVDB_HD void setMoments(Node& node, const Moments& m) {
  node.mAverage = static_cast<float>(m.mean);
  node.mStdDevi = static_cast<float>(sqrt(m.squares / m.count));
}

/// Of active values, from the least and the largest as inOrder() has them and their sums.
TETVDB_HD inline NodeValues valuesOf(i32 min, i32 max, const Moments& m, bool isFloat) {
  return {static_cast<u32>(inOrder(static_cast<u32>(min), isFloat)),
          static_cast<u32>(inOrder(static_cast<u32>(max), isFloat)), static_cast<float>(m.mean),
          static_cast<float>(sqrt(m.squares / m.count))};
}

// What a leaf says of its values.
TETVDB_HD inline void summarize(const LeafSummary& sum, const u32*, bool isFloat, ValueLeaf& node) {
  setValues(node, valuesOf(sum.min, sum.max, {sum.count, sum.mean, sum.squares}, isFloat));
}
TETVDB_HD inline void summarize(const LeafSummary& sum, const Vector* values, bool,
                                NodesOf<Vector>::Leaf& node) {
  node.mMinimum = values[sum.min];
  node.mMaximum = values[sum.max];
  setMoments(node, {sum.count, sum.mean, sum.squares});
}
// Where all are the same.
TETVDB_HD inline void summarize(const GridValues& values, ValueLeaf& node) {
  setValues(node, {values.inside, values.inside, floatFrom(values.inside), 0});
}
TETVDB_HD inline void summarize(const GridValues&, NodesOf<Vector>::Leaf&) {}

// An entry of a node's table, all of its bytes.
template <typename Entry>
TETVDB_HD inline void setEntry(Entry& entry, u32 value) {
  entry.child = static_cast<i64>(u64(value));
}
template <typename Entry>
TETVDB_HD inline void setEntry(Entry& entry, const Vector& value) {
  memset(static_cast<void*>(&entry), 0, sizeof entry);
  entry.value = value;
}
template <typename V, typename Entry>
TETVDB_HD inline void setChild(Entry& entry, u64 distance) {
  if (sizeof entry > sizeof(u64))
    memset(static_cast<void*>(&entry), 0, sizeof entry);
  entry.child = static_cast<i64>(distance);
}
// The statistics of a node whose active values are all the same.
template <typename Node>
TETVDB_HD inline void setUniform(Node& node, Kind kind, const GridValues& values, const u32*) {
  if (kind == Kind::Float)
    setValues(node, {values.inside, values.inside, floatFrom(values.inside), 0});
}
template <typename Node>
TETVDB_HD inline void setUniform(Node&, Kind, const GridValues&, const Vector*) {}

} // namespace tetvdb::nano
