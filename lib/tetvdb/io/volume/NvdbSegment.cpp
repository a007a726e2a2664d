// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NvdbSegment.h"

#include <algorithm>
#include <cstring>

namespace tetvdb {
namespace {

/// NanoVDB's hash of a grid's name.
std::uint64_t nameKey(const std::string& name) {
  std::uint64_t key = 0;
  for (const char c : name) {
    const std::uint64_t overflow = key >> 56;
    key = key * 67 + static_cast<unsigned char>(c) + overflow;
  }
  return key;
}

NvdbEntry entryOf(const unsigned char* head, const std::string& name) {
  NvdbGrid grid;
  std::memcpy(&grid, head, sizeof grid);
  NvdbEntry entry{};
  entry.gridSize = grid.gridSize;
  entry.nameKey = nameKey(name);
  entry.voxelCount = grid.voxelCount;
  entry.gridType = grid.gridType;
  entry.gridClass = grid.gridClass;
  std::copy_n(grid.worldBox, 6, entry.worldBox);
  std::memcpy(entry.indexBox, head + kNvdbTreeAt + grid.nodeOffset[3], sizeof entry.indexBox);
  std::copy_n(grid.voxelSize, 3, entry.voxelSize);
  entry.nameSize = static_cast<std::uint32_t>(name.size() + 1);
  std::copy_n(grid.nodeCount, 3, entry.nodeCount);
  entry.nodeCount[3] = 1;
  std::copy_n(grid.tileCount, 3, entry.tileCount);
  entry.codec = NvdbCodec::Blosc;
  entry.version = grid.version;
  return entry;
}

/// Appends header, entry and name; returns where the entry is.
std::uint64_t begin(AtomicFile& file, const NvdbEntry& entry, const std::string& name) {
  const NvdbHeader header{kNvdbMagic, entry.version, 1, NvdbCodec::Blosc};
  file.write(&header, sizeof header);
  const std::uint64_t at = file.size();
  file.write(&entry, sizeof entry);
  file.write(name.c_str(), name.size() + 1);
  return at;
}

} // namespace

NvdbSegment::NvdbSegment(AtomicFile& file, const unsigned char* head, const std::string& name)
    : file_(file), entry_(entryOf(head, name)), entryAt_(begin(file, entry_, name)),
      chunks_(file, entry_.gridSize) {}

void NvdbSegment::finish() {
  entry_.fileSize = file_.size() - (entryAt_ + sizeof entry_ + entry_.nameSize);
  file_.writeAt(entryAt_, &entry_, sizeof entry_);
}

} // namespace tetvdb
