// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/NanoFile.h"
#include "tetvdb/io/volume/NvdbNodes.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <set>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

// Of leaves, and of other nodes, before a file takes them.
constexpr std::size_t kLeavesInMemory = std::size_t(64) << 20;

// Bytes, and nodes, between two looks at the progress.
constexpr std::size_t kStep = std::size_t(64) << 20;
constexpr std::size_t kLowersAtOnce = 256;

/// A grid whose tree is in memory.
template <class GridT>
void writeGrid(AtomicFile& file, const GridT& grid, const std::string& folder,
               const ProgressShare& share) {
  using TreeT = typename GridT::TreeType;
  using Lower = typename NodeLists<TreeT>::Lower;
  const auto& root = grid.tree().root();
  NvdbNodes<TreeT> nodes(folder, kLeavesInMemory);
  const double count = double(root.getTableSize());
  double done = 0;
  for (auto entry = root.cbeginChildAll(); entry; ++entry) {
    typename GridT::ValueType value{};
    if (const auto* upper = entry.probeChild(value)) {
      std::vector<const Lower*> lowers;
      for (auto child = upper->cbeginChildOn(); child; ++child)
        lowers.push_back(&*child);
      const std::size_t all = lowers.size();
      for (std::size_t begin = 0; begin < all; begin += kLowersAtOnce) {
        const auto first = lowers.begin() + static_cast<std::ptrdiff_t>(begin);
        const std::size_t size = std::min(kLowersAtOnce, all - begin);
        nodes.addLowers({first, first + static_cast<std::ptrdiff_t>(size)});
        share.update(0.6 * (done + double(begin + size) / double(all)) / count);
      }
      nodes.addUpper(*upper, upper->getChildMask());
    } else {
      nodes.addTile(entry.getCoord(), value, entry.isValueOn());
    }
    share.update(0.6 * ++done / count);
  }
  nodes.writeTo(file, grid, share.part(0.6, 1));
}

// The head of a grid whose nodes lie breadth first, with NanoVDB's full checksum: that over all
// nodes is added to that of grid, tree and root, which the grid has.
NvdbGrid headWithChecksum(const unsigned char* bytes) {
  NvdbGrid grid;
  std::memcpy(&grid, bytes, sizeof grid);
  const std::uint64_t ends[3] = {grid.gridSize - kNvdbTreeAt, grid.nodeOffset[0],
                                 grid.nodeOffset[1]};
  std::vector<std::uint64_t> sums(std::size_t(grid.nodeCount[0]) + grid.nodeCount[1] +
                                  grid.nodeCount[2]);
  std::size_t first = 0;
  for (int level = 2; level >= 0; --level) {
    const std::size_t count = grid.nodeCount[level];
    if (count == 0)
      continue;
    const std::uint64_t begin = grid.nodeOffset[level], size = (ends[level] - begin) / count;
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
      sums[first + i] = NodeChecksum::of(bytes + kNvdbTreeAt + begin + i * size, size);
    });
    first += count;
  }
  if (sums.empty())
    return grid;
  NodeChecksum tail;
  tail.add(sums);
  grid.checksum = (grid.checksum & 0xFFFFFFFF) | tail.value() << 32;
  return grid;
}

} // namespace

void writeNanoGrids(const std::string& path, const std::vector<NanoBytes>& grids,
                    Progress& progress) {
  AtomicFile file(path);
  for (const NanoBytes& bytes : grids) {
    const NvdbGrid grid = headWithChecksum(bytes.data.get());
    NvdbSegment segment(file, bytes.data.get(), grid.name);
    segment.write(&grid, sizeof grid);
    for (std::size_t done = sizeof grid; done < bytes.size; done += kStep) {
      progress.check();
      segment.write(bytes.data.get() + done, std::min(kStep, bytes.size - done));
    }
    segment.finish();
  }
  file.commit();
}

void writeNvdbGrids(AtomicFile& file, const openvdb::GridPtrVec& grids,
                    const ProgressShare& share) {
  const std::string& path = file.path();
  std::set<std::string> names;
  for (const auto& grid : grids) {
    const std::string name = grid->getName();
    if (name.empty() || !names.insert(name).second)
      throw Error(Status::Usage, path, "grid names must be unique and not empty: '" + name + "'");
    requireNvdbForm(*grid, path);
  }
  const std::string folder = std::filesystem::path(path).parent_path().string();
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const double count = double(grids.size());
    grids[i]->apply<NvdbGrids>([&](const auto& typed) {
      writeGrid(file, typed, folder, share.part(double(i) / count, double(i + 1) / count));
    });
  }
}

void writeNvdb(const std::string& path, const Volume& volume, Progress& progress) {
  initializeOpenVDB();
  AtomicFile file(path);
  if (volume.grids().all.empty())
    throw Error(Status::Usage, path, "a .nvdb file holds one grid at least");
  writeNvdbGrids(file, volume.grids().all, ProgressShare(progress, 0, 1));
  file.commit();
}

} // namespace tetvdb
