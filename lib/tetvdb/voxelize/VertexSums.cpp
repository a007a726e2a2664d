// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VertexSums.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/voxelize/FaceSums.h"

#include <algorithm>
#include <cstring>

// Vectors never cross a function that is not inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

constexpr std::size_t kLanes = 8;  // tets computed at once
constexpr std::size_t kBatch = 64; // tets whose terms are computed before they are added

typedef double Doubles __attribute__((vector_size(4 * sizeof(double))));
typedef float FloatRow __attribute__((vector_size(4 * sizeof(float))));
typedef std::int32_t IntRow __attribute__((vector_size(4 * sizeof(std::int32_t))));
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));
typedef std::uint32_t Words __attribute__((vector_size(kLanes * sizeof(std::uint32_t))));
typedef std::uint64_t Numbers __attribute__((vector_size(4 * sizeof(std::uint64_t))));

// Of two vectors of eight, within each half of four: a0 b0 a1 b1, and a2 b2 a3 b3.
template <typename Eight>
TETVDB_INLINE Eight firstPairs(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
}
template <typename Eight>
TETVDB_INLINE Eight lastPairs(const Eight& a, const Eight& b) {
  return __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
}

// Eight rows of four as four columns of eight.
template <typename Eight, typename Row>
TETVDB_INLINE void transpose(const Row* rows, Eight& a, Eight& b, Eight& c, Eight& d) {
  const auto joined = [&](std::size_t i) __attribute__((always_inline)) {
    return __builtin_shufflevector(rows[i], rows[i + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Eight row0 = joined(0), row1 = joined(1), row2 = joined(2), row3 = joined(3);
  const Eight ab01 = firstPairs(row0, row1), ab23 = firstPairs(row2, row3);
  const Eight cd01 = lastPairs(row0, row1), cd23 = lastPairs(row2, row3);
  a = __builtin_shufflevector(ab01, ab23, 0, 1, 8, 9, 4, 5, 12, 13);
  b = __builtin_shufflevector(ab01, ab23, 2, 3, 10, 11, 6, 7, 14, 15);
  c = __builtin_shufflevector(cd01, cd23, 0, 1, 8, 9, 4, 5, 12, 13);
  d = __builtin_shufflevector(cd01, cd23, 2, 3, 10, 11, 6, 7, 14, 15);
}

TETVDB_INLINE Floats absolute(const Floats& f) {
  return reinterpret_cast<Floats>(reinterpret_cast<Words>(f) & 0x7FFFFFFFu);
}
template <typename Eight>
TETVDB_INLINE Eight larger(const Eight& a, const Eight& b) {
  return a > b ? a : b;
}

TETVDB_INLINE bool any(const Ints& masks) {
  const auto words = reinterpret_cast<Numbers>(masks);
  return (words[0] | words[1] | words[2] | words[3]) != 0;
}

// The edges of eight tets, to their first corners.
struct Edges {
  Floats ux, uy, uz, vx, vy, vz, wx, wy, wz;
};

// The edges from corner `k`. No tet may have the last point: a point is read as four numbers.
TETVDB_INLINE void edgesFrom(std::size_t k, const double* points, const std::uint32_t* tets,
                             Floats& x, Floats& y, Floats& z) {
  const auto edge = [&](std::size_t i) __attribute__((always_inline)) {
    Doubles from, to;
    std::memcpy(&from, points + 3 * std::size_t(tets[4 * i + k]), sizeof from);
    std::memcpy(&to, points + 3 * std::size_t(tets[4 * i]), sizeof to);
    return __builtin_convertvector(to - from, FloatRow);
  };
  // Not in a loop, so that they stay in registers.
  const FloatRow rows[kLanes] = {edge(0), edge(1), edge(2), edge(3),
                                 edge(4), edge(5), edge(6), edge(7)};
  Floats rest;
  transpose(rows, x, y, z, rest);
}

TETVDB_INLINE Edges edgesOf(const double* points, const std::uint32_t* tets) {
  Edges e;
  edgesFrom(1, points, tets, e.ux, e.uy, e.uz);
  edgesFrom(2, points, tets, e.vx, e.vy, e.vz);
  edgesFrom(3, points, tets, e.wx, e.wy, e.wz);
  return e;
}

// Masks: which tets are certainly negative and which positive.
struct Orientations {
  Ints negative{}, positive{};

  Ints unknown() const { return ~(negative | positive); }
};

// The orientation of snapped tets from their points in world space.
class FloatFilter {
public:
  explicit FloatFilter(const TetsToSnap& mesh)
      : points_(mesh.points), last_(static_cast<std::int32_t>(mesh.pointCount) - 1) {
    const Vec3d& h = mesh.transform.voxelSize;
    const double finest = std::min({h[0], h[1], h[2]}) * kVoxelsPerUnit;
    unit_ = static_cast<float>(std::max({h[0], h[1], h[2]}) * kVoxelsPerUnit);
    // Else products of floats could overflow or be rounded to zero; no tet is known then.
    longest_ = finest >= 0x1p-40 && unit_ <= 1 ? static_cast<float>(finest) * 0x1p39f : 0;
  }

  // Of eight tets, whose corners are also sorted; none is known where one has the last point.
  //
  // Snapping moves a coordinate by at most 1.003 lattice units (half a unit, and two roundings of
  // 2^-53 of at most 2^51 units), so a component of an edge by less than 2.01, and the determinant
  // by 18 * 2.01 (size + 2.01)^2. As floats, and in the products and sums of a determinant, each of
  // its six terms has eight roundings of 2^-24 (and some of 2^-53); the terms are below size^3. The
  // bound exceeds the sum of both by a quarter, far more than its own roundings. Below 2^39 units
  // nothing overflows, and the extents of a tet are below kMaxTetExtent.
  TETVDB_INLINE Orientations orientationsOf(const std::uint32_t* tets, const Ints& largest) const {
    if (any(largest == last_))
      return {};
    const Edges e = edgesOf(points_, tets);
    const Floats det = e.ux * (e.vy * e.wz - e.vz * e.wy) + e.uy * (e.vz * e.wx - e.vx * e.wz) +
                       e.uz * (e.vx * e.wy - e.vy * e.wx);
    const Floats u = larger(larger(absolute(e.ux), absolute(e.uy)), absolute(e.uz));
    const Floats v = larger(larger(absolute(e.vx), absolute(e.vy)), absolute(e.vz));
    const Floats w = larger(larger(absolute(e.wx), absolute(e.wy)), absolute(e.wz));
    const Floats size = larger(larger(u, v), w) + 2.5f * unit_;
    const Floats bound = size * size * (size * 0x1p-18f + 48.0f * unit_);
    const Ints inRange = size < longest_;
    return {(det > bound) & inRange, (det < -bound) & inRange}; // edges point to the first corner
  }

private:
  const double* points_;
  std::int32_t last_;
  float unit_;    // of the lattice, on the axis of the longest voxels
  float longest_; // edges of tets that are decided
};

// Puts a and b in ascending order; flips `sign` where they were not.
TETVDB_INLINE void sortPair(Ints& a, Ints& b, Ints& sign) {
  sign ^= a > b;
  const Ints low = a < b ? a : b;
  b = larger(a, b);
  a = low;
}

// Eight numbers of 64 bits: of lanes 0, 1, 4, 5 and of 2, 3, 6, 7.
struct LanePairs {
  Numbers first, last;
};

// fingerprint() of eight vertices.
TETVDB_INLINE LanePairs fingerprintsOf(const Ints& vertices) {
  const FingerprintHalves<Words> halves = fingerprintHalves(reinterpret_cast<Words>(vertices));
  return {reinterpret_cast<Numbers>(firstPairs(halves.low, halves.high)),
          reinterpret_cast<Numbers>(lastPairs(halves.low, halves.high))};
}

// Of tets whose terms are computed but not yet added.
struct Terms {
  alignas(32) std::uint32_t first[kBatch], second[kBatch]; // vertices
  alignas(32) std::uint64_t toFirst[kBatch], toSecond[kBatch];
  alignas(32) std::int32_t unknown[kBatch]; // orientation
};
// Where in Terms the numbers of each of eight tets are.
constexpr std::size_t kPlace[kLanes] = {0, 1, 4, 5, 2, 3, 6, 7};

// Masks of 64 bits.
TETVDB_INLINE LanePairs widened(const Ints& masks) {
  return {reinterpret_cast<Numbers>(firstPairs(masks, masks)),
          reinterpret_cast<Numbers>(lastPairs(masks, masks))};
}

TETVDB_INLINE Numbers withSign(const Numbers& x, const Numbers& negative) {
  return (x ^ negative) - negative;
}

// The corners of eight tets in ascending order; `odd`: where an odd permutation sorts them.
struct SortedTets {
  Ints a, b, c, d, odd{};
};
TETVDB_INLINE SortedTets sorted(const std::uint32_t* tets) {
  IntRow rows[kLanes];
  std::memcpy(rows, tets, sizeof rows);
  SortedTets s;
  transpose(rows, s.a, s.b, s.c, s.d);
  sortPair(s.a, s.b, s.odd);
  sortPair(s.c, s.d, s.odd);
  sortPair(s.a, s.c, s.odd);
  sortPair(s.b, s.d, s.odd);
  sortPair(s.b, s.c, s.odd);
  return s;
}

// Computes the terms of eight tets as vertexTerms() does.
TETVDB_INLINE void computeTerms(const SortedTets& s, const Ints& negative, std::size_t at,
                                Terms& terms) {
  const LanePairs rb = fingerprintsOf(s.b), rc = fingerprintsOf(s.c), rd = fingerprintsOf(s.d);
  const LanePairs signs = widened(negative ^ s.odd);
  const auto store = [&](const Numbers& r1, const Numbers& r2, const Numbers& r3,
                         const Numbers& negatives, std::size_t i) __attribute__((always_inline)) {
    const Numbers far = r2 * r3;
    const Numbers first = withSign(r1 * (r3 - r2) - far, negatives);
    const Numbers second = withSign(far, negatives);
    std::memcpy(terms.toFirst + i, &first, sizeof first);
    std::memcpy(terms.toSecond + i, &second, sizeof second);
  };
  store(rb.first, rc.first, rd.first, signs.first, at);
  store(rb.last, rc.last, rd.last, signs.last, at + 4);
  const Ints a = __builtin_shufflevector(s.a, s.a, 0, 1, 4, 5, 2, 3, 6, 7);
  const Ints b = __builtin_shufflevector(s.b, s.b, 0, 1, 4, 5, 2, 3, 6, 7);
  std::memcpy(terms.first + at, &a, sizeof a);
  std::memcpy(terms.second + at, &b, sizeof b);
}

int exactSign(const TetsToSnap& mesh, const std::uint32_t* v) {
  const LatticePoint a = mesh.point(v[0]), b = mesh.point(v[1]), c = mesh.point(v[2]),
                     d = mesh.point(v[3]);
  if (boxOf(a, b, c, d).extent() > kMaxTetExtent)
    throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
  return tetOrientation(a, b, c, d);
}

// Of a tet alone.
void addExactly(const TetsToSnap& mesh, const std::uint32_t* v, std::uint64_t* sums,
                OrientationCounts& counts) {
  const int sign = exactSign(mesh, v);
  counts.count(sign);
  const SortedTet tet = sortTet(v, sign);
  const VertexTerms terms = vertexTerms(tet);
  sums[tet.v[0]] += terms.first;
  sums[tet.v[1]] += terms.second;
}

// `end` - `begin` is a multiple of kLanes.
TETVDB_MULTIVERSION_256 void addLanes(const TetsToSnap& mesh, std::size_t begin, std::size_t end,
                                      std::uint64_t* sums, OrientationCounts& counts) {
  const FloatFilter filter(mesh);
  Terms terms;
  for (std::size_t batch = begin; batch < end; batch += kBatch) {
    const std::size_t count = std::min(kBatch, end - batch);
    const std::uint32_t* tets = mesh.tets + 4 * batch;
    Ints flipped{}, anyUnknown{};
    for (std::size_t i = 0; i < count; i += kLanes) {
      prefetchIndices(tets + 4 * i);
      prefetchIndices(tets + 4 * i + kPrefetchGrain);
      const SortedTets s = sorted(tets + 4 * i);
      const Orientations orientations = filter.orientationsOf(tets + 4 * i, s.d);
      computeTerms(s, orientations.negative, i, terms);
      flipped -= orientations.negative;
      const Ints unknown = orientations.unknown();
      anyUnknown |= unknown;
      std::memcpy(terms.unknown + i, &unknown, sizeof unknown);
    }
    for (std::size_t k = 0; k < kLanes; ++k)
      counts.flipped += static_cast<std::uint64_t>(flipped[k]);
    if (any(anyUnknown))
      for (std::size_t i = 0; i < count; ++i)
        if (terms.unknown[i] != 0) {
          const std::size_t place = i / kLanes * kLanes + kPlace[i % kLanes];
          terms.toFirst[place] = terms.toSecond[place] = 0;
          addExactly(mesh, tets + 4 * i, sums, counts);
        }
    // Apart from their computation, so that neither waits for the other.
    for (std::size_t i = 0; i < count; ++i) {
      sums[terms.first[i]] += terms.toFirst[i];
      sums[terms.second[i]] += terms.toSecond[i];
    }
  }
}

// `count` is a multiple of kLanes.
TETVDB_MULTIVERSION_256 void orientLanes(const TetsToSnap& mesh, const std::uint32_t* tets,
                                         std::size_t count, std::int8_t* signs) {
  const FloatFilter filter(mesh);
  for (std::size_t i = 0; i < count; i += kLanes, tets += 4 * kLanes) {
    const Orientations orientations = filter.orientationsOf(tets, sorted(tets).d);
    const Ints sign = orientations.negative - orientations.positive;
    for (std::size_t k = 0; k < kLanes; ++k)
      signs[i + k] =
          static_cast<std::int8_t>(sign[k] != 0 ? sign[k] : exactSign(mesh, tets + 4 * k));
  }
}

} // namespace

OrientationCounts addToVertexSums(const TetsToSnap& mesh, std::size_t begin, std::size_t end,
                                  std::uint64_t* sums) {
  OrientationCounts counts;
  const std::size_t whole = begin + (end - begin) / kLanes * kLanes;
  addLanes(mesh, begin, whole, sums, counts);
  for (std::size_t t = whole; t < end; ++t)
    addExactly(mesh, mesh.tets + 4 * t, sums, counts);
  return counts;
}

void orientTets(const TetsToSnap& mesh, const std::uint32_t* tets, std::size_t count,
                std::int8_t* signs) {
  const std::size_t whole = count / kLanes * kLanes;
  orientLanes(mesh, tets, whole, signs);
  for (std::size_t t = whole; t < count; ++t)
    signs[t] = static_cast<std::int8_t>(exactSign(mesh, tets + 4 * t));
}

} // namespace tetvdb
