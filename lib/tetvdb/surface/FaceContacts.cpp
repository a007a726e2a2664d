// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FaceContacts.h"

#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace tetvdb {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::size_t kMaxPairs = std::size_t(1) << 25;
constexpr std::size_t kMaxPairsOfFace = 64;

// Bit k is set if corner k of `face` is a corner of `other`.
unsigned sharedCorners(const WeldedFace& face, const WeldedFace& other) {
  const auto& c = other.corners;
  unsigned bits = 0;
  for (unsigned k = 0; k < 3; ++k)
    bits |= unsigned(face.corners[k] == c[0] || face.corners[k] == c[1] || face.corners[k] == c[2])
            << k;
  return bits;
}

// Whether all corners of `face` except the shared ones are on one side of the other's plane: then
// the faces meet in the shared corners only. In doubles; false if uncertain.
bool surelyOnOneSide(const std::vector<Vec3d>& points, const WeldedFace& face, unsigned shared,
                     const WeldedFace& plane) {
  const Vec3d& a = points[plane.corners[0]];
  const Vec3d u = minus(points[plane.corners[1]], a), v = minus(points[plane.corners[2]], a);
  Vec3d n, max;
  for (std::size_t k = 0; k < 3; ++k) {
    const double left = u[(k + 1) % 3] * v[(k + 2) % 3], right = u[(k + 2) % 3] * v[(k + 1) % 3];
    n[k] = left - right;
    max[k] = std::abs(left) + std::abs(right);
  }
  int side = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if ((shared >> k & 1) != 0)
      continue;
    const Vec3d w = minus(points[face.corners[k]], a);
    const double value = dot(n, w);
    // Fewer than 8 roundings; differences are exact.
    const double bound =
        0x1p-49 * (max[0] * std::abs(w[0]) + max[1] * std::abs(w[1]) + max[2] * std::abs(w[2]));
    if (!(std::abs(value) > bound))
      return false;
    const int here = value > 0 ? 1 : -1;
    if (side * here < 0)
      return false;
    side = here;
  }
  return true;
}

struct EdgePair {
  std::uint32_t a, b;
  std::uint8_t cornerA, cornerB; // opposite to the edge
};

struct Found {
  std::vector<Pair> meeting;
  std::vector<EdgePair> edges;
};

} // namespace

FaceContacts findContacts(const WeldedFaces& welded, const BoxBlocks& boxes, Progress& progress) {
  const std::size_t count = welded.faces.size();
  const std::size_t max = kMaxPairs + kMaxPairsOfFace * count;
  tbb::enumerable_thread_specific<Found> locals;
  // Number of other faces at the edge opposite to a corner: 0, 1 or more.
  std::vector<std::atomic<std::uint8_t>> atEdge(3 * count);
  const auto countAt = [&](std::uint32_t face, std::uint8_t corner) -> std::atomic<std::uint8_t>& {
    return atEdge[3 * std::size_t(face) + corner];
  };
  std::atomic<std::size_t> looked{0};
  std::atomic<bool> equal{false};
  const auto look = [&](std::uint32_t first, std::uint32_t second, Found& found) {
    const WeldedFace &a = welded.faces[first], &b = welded.faces[second];
    const unsigned shared = sharedCorners(a, b);
    if (shared == 7) {
      equal = true;
      return;
    }
    const unsigned sharedOfB = shared == 0 ? 0 : sharedCorners(b, a);
    if (!surelyOnOneSide(welded.points, b, sharedOfB, a) &&
        !surelyOnOneSide(welded.points, a, shared, b) &&
        facesMeet(welded.points, a.corners.data(), b.corners.data()))
      found.meeting.emplace_back(first, second);
    const auto lone = [](unsigned bits) { // two of three bits
      return static_cast<std::uint8_t>(bits == 6 ? 0 : bits == 5 ? 1 : 2);
    };
    if (shared == 3 || shared == 5 || shared == 6) {
      found.edges.push_back({first, second, lone(shared), lone(sharedOfB)});
      for (std::atomic<std::uint8_t>* at :
           {&countAt(first, lone(shared)), &countAt(second, lone(sharedOfB))})
        if (std::uint8_t none = 0; !at->compare_exchange_strong(none, 1, std::memory_order_relaxed))
          at->store(2, std::memory_order_relaxed);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.blocks(), 64), [&](const auto& range) {
    progress.check();
    Found& found = locals.local();
    std::vector<Pair> pairs;
    for (std::size_t block = range.begin(); block != range.end(); ++block) {
      if (looked > max || equal)
        return;
      pairs.clear();
      boxes.pairs(block, max, pairs);
      for (const auto& [first, second] : pairs)
        look(first, second, found);
      looked += pairs.size();
    }
  });
  FaceContacts contacts;
  contacts.equal = equal;
  contacts.complete = equal || looked <= max;
  if (equal || looked > max)
    return contacts;

  contacts.starts.assign(count + 1, 0);
  std::vector<Pair> meeting;
  for (const Found& found : locals)
    for (const auto& [a, b] : found.meeting) {
      meeting.emplace_back(a, b);
      meeting.emplace_back(b, a);
    }
  tbb::parallel_sort(meeting.begin(), meeting.end());
  contacts.others.reserve(meeting.size());
  for (const auto& [face, other] : meeting) {
    ++contacts.starts[face + 1];
    contacts.others.push_back(other);
  }
  for (std::size_t i = 0; i < count; ++i)
    contacts.starts[i + 1] += contacts.starts[i];
  contacts.neighbours.resize(locals.size());
  tbb::parallel_for(std::size_t(0), locals.size(), [&](std::size_t i) {
    for (const EdgePair& pair : (locals.begin() + static_cast<std::ptrdiff_t>(i))->edges)
      if (countAt(pair.a, pair.cornerA) == 1 && countAt(pair.b, pair.cornerB) == 1 &&
          !contacts.isMet(pair.a) && !contacts.isMet(pair.b))
        contacts.neighbours[i].emplace_back(pair.a, pair.b);
  });
  return contacts;
}

} // namespace tetvdb
