// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VolumeStream.h"

#include "tetvdb/io/volume/AddCounts.h"
#include "tetvdb/io/volume/StreamedVdb.h"
#include "tetvdb/io/volume/VdbChildren.h"
#include "tetvdb/volume/GridHash.h"
#include "tetvdb/volume/GridStatistics.h"
#include "tetvdb/volume/SumComparisons.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <tbb/task_arena.h>
#include <type_traits>
#include <utility>

namespace tetvdb {
namespace {

GridInfo describeOne(const openvdb::GridBase::Ptr& grid) {
  Volume volume;
  volume.grids().all.push_back(grid);
  return describe(volume).front();
}

using Hashes = std::vector<std::pair<std::string, std::string>>;

// A grid and what describe() says of it.
struct StreamedGrid {
  openvdb::GridBase::Ptr empty;
  GridInfo info;
};

// Of nodes in memory at a time, few enough to stay in the processor's cache. Sums of fractions, and
// of what is inside a level set whose background is inside, are those of whole children of the
// root.
template <class GridT>
std::size_t bytesOfParts(const GridT& grid) {
  constexpr std::size_t kBytesOfThread = std::size_t(4) << 20;
  if constexpr (std::is_same_v<GridT, openvdb::FloatGrid>)
    if (holdsShares(grid.getName()) || grid.background() < 0)
      return std::numeric_limits<std::size_t>::max();
  return kBytesOfThread * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

// One pass over a grid.
StreamedGrid describeGrid(const std::string& path, const VdbHeader& header,
                          const VdbGridHeader& grid, bool withHash, Hashes& hashes,
                          Progress& progress) {
  StreamedGrid result;
  GridInfo& sum = result.info;
  withGridOfType(grid.type, [&](const auto& tag) {
    using GridT = std::decay_t<decltype(tag)>;
    VdbChildren<GridT> children(path, header, grid);
    const openvdb::GridBase::Ptr empty = children.empty();
    const GridInfo base = describeOne(empty);
    sum = base;
    GridHash hash(*empty);
    const std::size_t partBytes = bytesOfParts(static_cast<const GridT&>(*empty));
    openvdb::Coord origin;
    while (children.begin(origin))
      for (bool first = true; const auto part = children.part(partBytes); first = false) {
        progress.check();
        addCounts(describeOne(part), base, sum);
        if (!first)
          sum.bytes -= sizeof(typename NodeLists<typename GridT::TreeType>::Upper);
        if (withHash)
          hash.add(*part);
      }
    hashes.emplace_back(grid.name, hash.finish());
    result.empty = empty;
  });
  return result;
}

template <class GridT>
GridComparison compareGrids(VdbChildren<GridT>& a, VdbChildren<GridT>& b, Progress& progress) {
  GridComparison sum;
  openvdb::Coord originA, originB;
  typename GridT::Ptr partA = a.next(originA), partB = b.next(originB);
  while (partA || partB) {
    progress.check();
    const bool takesA = partA && (!partB || !(originB < originA));
    const bool takesB = partB && (!partA || !(originA < originB));
    Volume one, other;
    one.grids().all.push_back(takesA ? partA : a.empty());
    other.grids().all.push_back(takesB ? partB : b.empty());
    add(sum, compareVolumes(one, other).grids.front());
    if (takesA)
      partA = a.next(originA);
    if (takesB)
      partB = b.next(originB);
  }
  return sum;
}

std::string hashOf(const std::string& path, const VdbHeader& header, Progress& progress) {
  Hashes hashes;
  for (const VdbGridHeader& grid : header.grids)
    describeGrid(path, header, grid, true, hashes, progress);
  return hashOfGrids(std::move(hashes));
}

} // namespace

bool isLargeVolume(const std::string& path) {
  constexpr std::uintmax_t kLarge = std::uintmax_t(256) << 20;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  return !error && size >= kLarge && canStreamVolume(path);
}

StreamedInfo describeVolumeFile(const std::string& path, bool withHash, Progress& progress) {
  const VdbHeader header = checkedVdbHeader(path);
  StreamedInfo result;
  result.metadata = header.metadata;
  result.empty.metadata = header.metadata;
  Hashes hashes;
  std::vector<StreamedGrid> grids;
  for (const VdbGridHeader& grid : header.grids)
    grids.push_back(describeGrid(path, header, grid, withHash, hashes, progress));
  // In OpenVDB's order.
  std::stable_sort(grids.begin(), grids.end(),
                   [](const StreamedGrid& one, const StreamedGrid& other) {
                     return one.info.name < other.info.name;
                   });
  for (StreamedGrid& grid : grids) {
    result.grids.push_back(std::move(grid.info));
    result.empty.grids().all.push_back(std::move(grid.empty));
  }
  if (withHash)
    result.hash = hashOfGrids(std::move(hashes));
  return result;
}

VolumeComparison compareVolumeFiles(const std::string& a, const std::string& b,
                                    Progress& progress) {
  const VdbHeader headerA = checkedVdbHeader(a), headerB = checkedVdbHeader(b);
  VolumeComparison result;
  std::vector<const VdbGridHeader*> unmatched;
  for (const VdbGridHeader& grid : headerB.grids)
    unmatched.push_back(&grid);
  for (const VdbGridHeader& gridA : headerA.grids) {
    const auto found = std::find_if(unmatched.begin(), unmatched.end(),
                                    [&](const auto* grid) { return grid->name == gridA.name; });
    if (found == unmatched.end()) {
      result.onlyA.push_back(gridA.name);
      continue;
    }
    const VdbGridHeader& gridB = **found;
    unmatched.erase(found);
    if (gridA.type != gridB.type) {
      result.incomparable.push_back(gridA.name);
      continue;
    }
    withGridOfType(gridA.type, [&](const auto& tag) {
      using GridT = std::decay_t<decltype(tag)>;
      VdbChildren<GridT> childrenA(a, headerA, gridA), childrenB(b, headerB, gridB);
      result.grids.push_back(compareGrids(childrenA, childrenB, progress));
    });
    result.grids.back().name = gridA.name;
    if (canonicalBytes(*gridA.transform) != canonicalBytes(*gridB.transform))
      result.sameTransform = false;
  }
  for (const VdbGridHeader* grid : unmatched)
    result.onlyB.push_back(grid->name);
  result.sameHash = hashOf(a, headerA, progress) == hashOf(b, headerB, progress);
  return result;
}

} // namespace tetvdb
