// SPDX-License-Identifier: Apache-2.0
//
// The steps by which the boundary of tets is found (BoundaryFaces.h), for meshes in memory and
// others. Internal.
#pragma once

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/voxelize/BoundaryFaces.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

// Vertices a bucket covers: its hash table stays in the second cache.
constexpr int kBucketBits = 9;

// A face, corners ascending; it belongs to the bucket of the first.
struct FaceRecord {
  std::uint32_t aSign; // first corner << 1 | 1 where the normal of a, b, c points inward
  std::uint32_t b, c;

  std::size_t bucket() const { return aSign >> (kBucketBits + 1); }
};

struct SortedTet {
  std::array<std::uint32_t, 4> v;
  std::int32_t sign; // orientation in sorted order
};

inline SortedTet sortTet(const std::uint32_t* tet, std::int32_t sign) {
  std::array<std::uint32_t, 4> v{tet[0], tet[1], tet[2], tet[3]};
  const auto order = [&](std::size_t i, std::size_t j) {
    const bool swap = v[i] > v[j];
    const std::uint32_t lo = swap ? v[j] : v[i];
    const std::uint32_t hi = swap ? v[i] : v[j];
    v[i] = lo;
    v[j] = hi;
    sign = swap ? -sign : sign;
  };
  order(0, 1);
  order(2, 3);
  order(0, 2);
  order(1, 3);
  order(1, 2);
  return {v, sign};
}

// Calls visit(a, b, c, sign) for the faces of a sorted tet, sign > 0 where the normal of a, b, c
// points out of it.
template <typename Visit>
inline void eachFace(const SortedTet& t, const Visit& visit) {
  visit(t.v[0], t.v[1], t.v[2], -t.sign);
  visit(t.v[0], t.v[1], t.v[3], t.sign);
  visit(t.v[0], t.v[2], t.v[3], -t.sign);
  visit(t.v[1], t.v[2], t.v[3], t.sign);
}

// The halves of fingerprint(), of one vertex or of a vector of them.
template <typename Words>
struct FingerprintHalves {
  Words high, low;
};
template <typename Words>
TETVDB_INLINE FingerprintHalves<Words> fingerprintHalves(const Words& vertices) {
  // Products with odd numbers and shifts, each a bijection; after MurmurHash3's finalizer.
  Words x = (vertices + 1) * 0x9E3779B9u;
  x ^= x >> 15;
  const Words high = x * 0x85EBCA6Bu;
  return {high, (high ^ high >> 13) * 0xC2B2AE35u};
}

// A pseudo-random number for a vertex.
inline std::uint64_t fingerprint(std::uint32_t vertex) {
  const FingerprintHalves<std::uint32_t> halves = fingerprintHalves(vertex);
  return std::uint64_t(halves.high) << 32 | halves.low;
}

// What a tet adds to the sums of its smallest two vertices: r_b r_c over the faces a < b < c.
struct VertexTerms {
  std::uint64_t first, second;
};
TETVDB_INLINE VertexTerms vertexTerms(const SortedTet& s) {
  const std::uint64_t r1 = fingerprint(s.v[1]), r2 = fingerprint(s.v[2]), r3 = fingerprint(s.v[3]);
  const auto weight = static_cast<std::uint64_t>(static_cast<std::int64_t>(s.sign));
  const std::uint64_t far = weight * (r2 * r3);
  return {weight * (r1 * (r3 - r2)) - far, far};
}

// Open addressing, linear probing; sums of signs by face.
class FaceTable {
public:
  void reset(std::size_t faces) {
    std::size_t size = 64;
    while (size < faces + faces / 2)
      size *= 2;
    entries_.assign(size, Entry{0, 0, kEmpty, 0});
    mask_ = size - 1;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t sign) {
    const std::uint64_t key = (std::uint64_t(b) << 32 | c) * 0x9E3779B97F4A7C15ull;
    std::size_t slot = ((key ^ (key >> 29)) + a * 0x85EBCA6Bull) & mask_;
    for (;; slot = (slot + 1) & mask_) {
      Entry& e = entries_[slot];
      if (e.a == a && e.b == b && e.c == c) {
        e.sum += sign;
        return;
      }
      if (e.c == kEmpty) {
        e = {a, b, c, sign};
        return;
      }
    }
  }

  // Appends the faces whose sum is not zero, normals pointing out.
  void collect(std::vector<BoundaryFace>& out) const {
    for (const Entry& e : entries_) {
      if (e.sum > 0)
        out.push_back({e.a, e.b, e.c, e.sum});
      if (e.sum < 0)
        out.push_back({e.a, e.c, e.b, -e.sum});
    }
  }

private:
  // The largest vertex of a face is never kEmpty: vertices are below 2^31.
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFFu;
  struct Entry {
    std::uint32_t a, b, c;
    std::int32_t sum;
  };
  std::vector<Entry> entries_;
  std::size_t mask_ = 0;
};

// The points that faces use, and their places among these. A bit a point, and half a bit.
class UsedPoints {
public:
  UsedPoints(const std::vector<BoundaryFace>& faces, std::size_t pointCount)
      : words_((pointCount + 63) / 64), before_(words_.size()) {
    for (const BoundaryFace& f : faces)
      for (const std::uint32_t v : {f.a, f.b, f.c})
        words_[v / 64] |= std::uint64_t(1) << (v % 64);
    for (std::size_t i = 0; i < words_.size(); ++i) {
      before_[i] = count_;
      count_ += bitCount(words_[i]);
    }
  }

  std::size_t size() const { return count_; }
  std::uint32_t rank(std::uint32_t v) const {
    return before_[v / 64] + bitCount(words_[v / 64] & ((std::uint64_t(1) << (v % 64)) - 1));
  }
  // In ascending order.
  std::vector<std::uint32_t> points() const {
    std::vector<std::uint32_t> all;
    all.reserve(count_);
    for (std::size_t i = 0; i < words_.size(); ++i)
      for (std::uint64_t word = words_[i]; word != 0; word &= word - 1)
        all.push_back(static_cast<std::uint32_t>(64 * i) +
                      static_cast<std::uint32_t>(__builtin_ctzll(word)));
    return all;
  }

private:
  static std::uint32_t bitCount(std::uint64_t word) {
    return static_cast<std::uint32_t>(__builtin_popcountll(word));
  }

  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> before_; // points used in earlier words
  std::uint32_t count_ = 0;
};

// Whether every edge is passed as often one way as the other. The boundary of a boundary vanishes,
// so this fails if faces around one vertex are missing.
inline bool closes(const std::vector<BoundaryFace>& faces, std::size_t points) {
  const UsedPoints used(faces, points);
  std::vector<std::uint64_t> sums(used.size());
  for (const BoundaryFace& f : faces) {
    const auto edge = [&](std::uint32_t a, std::uint32_t b) {
      const std::uint64_t r = fingerprint(std::max(a, b)) * static_cast<std::uint64_t>(f.weight);
      sums[used.rank(std::min(a, b))] += a < b ? r : -r;
    };
    edge(f.a, f.b);
    edge(f.b, f.c);
    edge(f.c, f.a);
  }
  return std::all_of(sums.begin(), sums.end(), [](std::uint64_t sum) { return sum == 0; });
}

} // namespace tetvdb
