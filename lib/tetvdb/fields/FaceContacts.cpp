// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/FaceContacts.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/geometry/FaceContact.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace tetvdb {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::size_t kMostPairs = std::size_t(1) << 25;
constexpr std::size_t kMostPairsOfFace = 64;

// The corner of `face` that is not one of `other`'s, if they have an edge in common; else 3.
std::size_t loneCorner(const WeldedFace& face, const WeldedFace& other) {
  std::size_t lone = 3, common = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::find(other.corners.begin(), other.corners.end(), face.corners[k]) !=
        other.corners.end())
      ++common;
    else
      lone = k;
  }
  return common == 2 ? lone : 3;
}

} // namespace

FaceContacts findContacts(const WeldedFaces& welded, const BoxTree& tree, Progress& progress) {
  const std::size_t count = welded.faces.size();
  const std::size_t most = kMostPairs + kMostPairsOfFace * count;
  struct Found {
    std::vector<Pair> meeting, edges;
  };
  tbb::enumerable_thread_specific<Found> locals;
  // Other faces at the edge opposite to a corner: 0, 1 or more.
  std::unique_ptr<std::atomic<std::uint8_t>[]> atEdge(new std::atomic<std::uint8_t>[3 * count]());
  const auto addToEdge = [&](std::size_t face, std::size_t corner) {
    std::atomic<std::uint8_t>& edge = atEdge[3 * face + corner];
    if (edge.fetch_add(1, std::memory_order_relaxed) != 0)
      edge.store(2, std::memory_order_relaxed);
  };
  std::atomic<std::size_t> looked{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 256), [&](const auto& range) {
    progress.check();
    if (looked > most)
      return;
    Found& found = locals.local();
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto face = static_cast<std::uint32_t>(i);
      std::size_t pairs = 0;
      tree.visit([&](const Box& box) { return box.meets(tree.box(face)); },
                 [&](std::uint32_t other) {
                   if (other <= face)
                     return false;
                   ++pairs;
                   const WeldedFace &a = welded.faces[face], &b = welded.faces[other];
                   if (facesMeet(welded.points, a.corners.data(), b.corners.data()))
                     found.meeting.push_back({face, other});
                   const std::size_t lone = loneCorner(a, b);
                   if (lone < 3) {
                     addToEdge(face, lone);
                     addToEdge(other, loneCorner(b, a));
                     found.edges.push_back({face, other});
                   }
                   return pairs > most;
                 });
      if ((looked += pairs) > most)
        return;
    }
  });
  FaceContacts contacts;
  contacts.starts.assign(count + 1, 0);
  if (looked > most) {
    contacts.complete = false;
    return contacts;
  }
  std::vector<Pair> meeting;
  for (const Found& found : locals)
    for (const auto& [a, b] : found.meeting) {
      meeting.push_back({a, b});
      meeting.push_back({b, a});
    }
  tbb::parallel_sort(meeting.begin(), meeting.end());
  contacts.others.reserve(meeting.size());
  for (const auto& [face, other] : meeting) {
    ++contacts.starts[face + 1];
    contacts.others.push_back(other);
  }
  for (std::size_t i = 0; i < count; ++i)
    contacts.starts[i + 1] += contacts.starts[i];
  for (const Found& found : locals)
    for (const auto& [a, b] : found.edges) {
      const std::size_t lone = loneCorner(welded.faces[a], welded.faces[b]);
      const bool alone = atEdge[3 * a + lone] == 1 &&
                         atEdge[3 * b + loneCorner(welded.faces[b], welded.faces[a])] == 1;
      if (alone && !contacts.isMet(a) && !contacts.isMet(b))
        contacts.neighbours.push_back({a, b});
    }
  tbb::parallel_sort(contacts.neighbours.begin(), contacts.neighbours.end());
  return contacts;
}

} // namespace tetvdb
