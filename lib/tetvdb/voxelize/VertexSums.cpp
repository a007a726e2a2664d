// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/VertexSums.h"

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

// The edges of eight tets from their first corners.
struct Edges {
  Floats ux, uy, uz, vx, vy, vz, wx, wy, wz;
};

TETVDB_INLINE Edges edgesOf(const LatticePoint* points, const std::uint32_t* tets) {
  FloatRow u[kLanes], v[kLanes], w[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    // The fourth number is whatever follows the point.
    Doubles corners[4];
    for (std::size_t k = 0; k < 4; ++k)
      std::memcpy(&corners[k], &points[tets[4 * i + k]], sizeof corners[k]);
    u[i] = __builtin_convertvector(corners[1] - corners[0], FloatRow);
    v[i] = __builtin_convertvector(corners[2] - corners[0], FloatRow);
    w[i] = __builtin_convertvector(corners[3] - corners[0], FloatRow);
  }
  Edges e;
  Floats rest;
  transpose(u, e.ux, e.uy, e.uz, rest);
  transpose(v, e.vx, e.vy, e.vz, rest);
  transpose(w, e.wx, e.wy, e.wz, rest);
  return e;
}

// Masks: which tets are certainly negative and which positive.
struct Orientations {
  Ints negative, positive;
};

// Differences of lattice points are exact; as floats, and in the products and sums of a
// determinant, each of its six terms has eight roundings of 2^-24 at most. The terms are below
// size^3, and 48 2^-24 size^3 is below the bound with the rounding of the bound itself. Differences
// are whole numbers up to 2^40, so that nothing overflows or is rounded to zero.
TETVDB_INLINE Orientations orientationsOf(const Edges& e) {
  const Floats det = e.ux * (e.vy * e.wz - e.vz * e.wy) + e.uy * (e.vz * e.wx - e.vx * e.wz) +
                     e.uz * (e.vx * e.wy - e.vy * e.wx);
  const Floats u = larger(larger(absolute(e.ux), absolute(e.uy)), absolute(e.uz));
  const Floats v = larger(larger(absolute(e.vx), absolute(e.vy)), absolute(e.vz));
  const Floats w = larger(larger(absolute(e.wx), absolute(e.wy)), absolute(e.wz));
  const Floats size = larger(larger(u, v), w);
  const Floats bound = size * size * size * 0x1p-18f;
  return {det<-bound, det> bound};
}

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
};

// Masks of 64 bits.
TETVDB_INLINE LanePairs widened(const Ints& masks) {
  return {reinterpret_cast<Numbers>(firstPairs(masks, masks)),
          reinterpret_cast<Numbers>(lastPairs(masks, masks))};
}

// x, -x or 0.
TETVDB_INLINE Numbers withSign(const Numbers& x, const Numbers& negative, const Numbers& known) {
  return ((x ^ negative) - negative) & known;
}

// Computes the terms of eight tets as vertexTerms() does, those of unknown orientation as 0.
TETVDB_INLINE void computeTerms(const std::uint32_t* tets, const Ints& negative, const Ints& known,
                                std::size_t at, Terms& terms) {
  IntRow rows[kLanes];
  std::memcpy(rows, tets, sizeof rows);
  Ints a, b, c, d, sign = negative;
  transpose(rows, a, b, c, d);
  sortPair(a, b, sign);
  sortPair(c, d, sign);
  sortPair(a, c, sign);
  sortPair(b, d, sign);
  sortPair(b, c, sign);
  const LanePairs rb = fingerprintsOf(b), rc = fingerprintsOf(c), rd = fingerprintsOf(d);
  const LanePairs signs = widened(sign), knowns = widened(known);
  const auto store = [&](const Numbers& r1, const Numbers& r2, const Numbers& r3,
                         const Numbers& negatives, const Numbers& mask, std::size_t i)
      __attribute__((always_inline)) {
    const Numbers far = r2 * r3;
    const Numbers first = withSign(r1 * (r3 - r2) - far, negatives, mask);
    const Numbers second = withSign(far, negatives, mask);
    std::memcpy(terms.toFirst + i, &first, sizeof first);
    std::memcpy(terms.toSecond + i, &second, sizeof second);
  };
  store(rb.first, rc.first, rd.first, signs.first, knowns.first, at);
  store(rb.last, rc.last, rd.last, signs.last, knowns.last, at + 4);
  a = __builtin_shufflevector(a, a, 0, 1, 4, 5, 2, 3, 6, 7);
  b = __builtin_shufflevector(b, b, 0, 1, 4, 5, 2, 3, 6, 7);
  std::memcpy(terms.first + at, &a, sizeof a);
  std::memcpy(terms.second + at, &b, sizeof b);
}

TETVDB_INLINE bool all(const Ints& masks) {
  const auto words = reinterpret_cast<Numbers>(masks);
  return (words[0] & words[1] & words[2] & words[3]) == ~std::uint64_t(0);
}

// Of tet t alone.
void addExactly(const SnappedMesh& mesh, std::size_t t, std::uint64_t* sums,
                OrientationCounts& counts) {
  const std::uint32_t* v = mesh.tets + 4 * t;
  const int sign =
      tetOrientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]);
  counts.count(sign);
  const SortedTet sorted = sortTet(v, sign);
  const VertexTerms terms = vertexTerms(sorted);
  sums[sorted.v[0]] += terms.first;
  sums[sorted.v[1]] += terms.second;
}

// `end` - `begin` is a multiple of kLanes.
TETVDB_MULTIVERSION void addLanes(const SnappedMesh& mesh, std::size_t begin, std::size_t end,
                                  std::uint64_t* sums, OrientationCounts& counts) {
  const LatticePoint* points = mesh.points.data();
  Terms terms;
  for (std::size_t batch = begin; batch < end; batch += kBatch) {
    const std::size_t count = std::min(kBatch, end - batch);
    Ints flipped{};
    for (std::size_t i = 0; i < count; i += kLanes) {
      const std::uint32_t* tets = mesh.tets + 4 * (batch + i);
      const Orientations orientations = orientationsOf(edgesOf(points, tets));
      const Ints known = orientations.negative | orientations.positive;
      flipped -= orientations.negative;
      computeTerms(tets, orientations.negative, known, i, terms);
      if (!all(known))
        for (std::size_t k = 0; k < kLanes; ++k)
          if (known[k] == 0)
            addExactly(mesh, batch + i + k, sums, counts);
    }
    for (std::size_t k = 0; k < kLanes; ++k)
      counts.flipped += static_cast<std::uint64_t>(flipped[k]);
    // Apart from their computation, so that neither waits for the other.
    for (std::size_t i = 0; i < count; ++i) {
      sums[terms.first[i]] += terms.toFirst[i];
      sums[terms.second[i]] += terms.toSecond[i];
    }
  }
}

} // namespace

OrientationCounts addToVertexSums(const SnappedMesh& mesh, std::size_t begin, std::size_t end,
                                  std::uint64_t* sums) {
  OrientationCounts counts;
  const std::size_t whole = begin + (end - begin) / kLanes * kLanes;
  addLanes(mesh, begin, whole, sums, counts);
  for (std::size_t t = whole; t < end; ++t)
    addExactly(mesh, t, sums, counts);
  return counts;
}

} // namespace tetvdb
