// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/EdgeTable.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/LargeVector.h"

#include <algorithm>
#include <atomic>
#include <string>

namespace tetvdb {
namespace {

// A side in the list of its low point: high point << 32 | side. Sorting by this number makes the
// order independent of threads.
using Entry = std::uint64_t;

std::uint32_t highPointOf(Entry entry) {
  return static_cast<std::uint32_t>(entry >> 32);
}

} // namespace

EdgeTable::EdgeTable(const std::uint32_t* corners, std::size_t faces, std::size_t pointCount)
    : corners_(corners) {
  if (3 * faces >= kNone)
    throw Error(Status::Limit, "", "a mesh of " + std::to_string(faces) + " triangles",
                "split it into parts of less than 1.4 billion");

  const auto eachSide = [&](std::size_t face, const auto& visit) {
    const std::uint32_t* v = &corners_[3 * face];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0])
      return false;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = v[k], to = v[(k + 1) % 3];
      visit(std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(3 * face) + k);
    }
    return true;
  };

  // Count, scan, fill by low point.
  std::vector<std::atomic<std::uint32_t>> cursor(pointCount + 1);
  edgeOf_.resize(3 * faces);
  forEachIndex(faces, [&](std::size_t face) {
    if (!eachSide(face, [&](std::uint32_t low, std::uint32_t, std::uint32_t) {
          cursor[low].fetch_add(1, std::memory_order_relaxed);
        }))
      std::fill_n(&edgeOf_[3 * face], 3, kNone);
  });
  std::vector<std::uint32_t> firstEntry(pointCount + 1);
  std::uint32_t total = 0;
  for (std::size_t point = 0; point <= pointCount; ++point) {
    firstEntry[point] = total;
    total += cursor[point].load(std::memory_order_relaxed);
    cursor[point].store(firstEntry[point], std::memory_order_relaxed);
  }
  LargeVector<Entry> entries(total);
  forEachIndex(faces, [&](std::size_t face) {
    eachSide(face, [&](std::uint32_t low, std::uint32_t high, std::uint32_t side) {
      entries[cursor[low].fetch_add(1, std::memory_order_relaxed)] = Entry(high) << 32 | side;
    });
  });

  // Sort around each point and count edges; then number them.
  std::vector<std::uint32_t> firstEdge(pointCount + 1, 0);
  forEachIndex(pointCount, [&](std::size_t point) {
    Entry* const first = entries.data() + firstEntry[point];
    Entry* const last = entries.data() + firstEntry[point + 1];
    std::sort(first, last);
    std::uint32_t count = 0;
    for (const Entry* e = first; e != last; ++e)
      count += e == first || highPointOf(*e) != highPointOf(e[-1]);
    firstEdge[point] = count;
  });
  std::uint32_t edges = 0;
  for (std::uint32_t& first : firstEdge) {
    const std::uint32_t count = first;
    first = edges;
    edges += count;
  }
  points_.resize(edges);
  first_.resize(std::size_t(edges) + 1);
  first_.back() = total;
  sides_.resize(total);
  forEachIndex(pointCount, [&](std::size_t point) {
    std::uint32_t edge = firstEdge[point];
    for (std::uint32_t i = firstEntry[point]; i < firstEntry[point + 1]; ++i) {
      const std::uint32_t high = highPointOf(entries[i]);
      if (i == firstEntry[point] || high != highPointOf(entries[i - 1])) {
        points_[edge] = {static_cast<std::uint32_t>(point), high};
        first_[edge++] = i;
      }
      sides_[i] = static_cast<std::uint32_t>(entries[i]);
      edgeOf_[sides_[i]] = edge - 1;
    }
  });
}

} // namespace tetvdb
