// SPDX-License-Identifier: Apache-2.0
//
// Writes one segment a grid, so that at most one grid is in memory twice.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/ZlibBytes.h"
#include "tetvdb/io/volume/NanoFile.h"
#include "tetvdb/io/volume/NvdbLayout.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <blosc.h>
#include <cstring>
#include <memory>
#include <set>
#include <tbb/parallel_for.h>
#include <vector>
#include <zlib.h>

namespace tetvdb {
namespace {

/// False where the grid's type has no NanoVDB form here.
bool convert(const openvdb::GridBase& grid, NanoHandle& handle) {
  using Types = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::Int32Grid,
                                  openvdb::Vec3SGrid, openvdb::DoubleGrid, openvdb::Int64Grid>;
  const auto build = [&](const auto& typed) { handle = toNano(typed); };
  return grid.apply<Types>(build);
}

/// NanoVDB's hash of a grid's name.
std::uint64_t nameKey(const std::string& name) {
  std::uint64_t key = 0;
  for (const char c : name) {
    const std::uint64_t overflow = key >> 56;
    key = key * 67 + static_cast<unsigned char>(c) + overflow;
  }
  return key;
}

NvdbEntry entryOf(const NvdbGrid& grid, const unsigned char* bytes, const std::string& name) {
  NvdbEntry entry{};
  entry.gridSize = grid.gridSize;
  entry.nameKey = nameKey(name);
  entry.voxelCount = grid.voxelCount;
  entry.gridType = grid.gridType;
  entry.gridClass = grid.gridClass;
  std::copy_n(grid.worldBox, 6, entry.worldBox);
  std::memcpy(entry.indexBox, bytes + kNvdbTreeAt + grid.nodeOffset[3], sizeof entry.indexBox);
  std::copy_n(grid.voxelSize, 3, entry.voxelSize);
  entry.nameSize = static_cast<std::uint32_t>(name.size() + 1);
  std::copy_n(grid.nodeCount, 3, entry.nodeCount);
  entry.nodeCount[3] = 1;
  std::copy_n(grid.tileCount, 3, entry.tileCount);
  entry.codec = NvdbCodec::Blosc;
  entry.version = grid.version;
  return entry;
}

void writeGrid(AtomicFile& file, const unsigned char* bytes, std::size_t size,
               const std::string& name, Progress& progress) {
  NvdbGrid grid;
  std::memcpy(&grid, bytes, sizeof grid);
  const NvdbHeader header{kNvdbMagic, grid.version, 1, NvdbCodec::Blosc};
  file.write(&header, sizeof header);
  const std::uint64_t entryAt = file.size();
  NvdbEntry entry = entryOf(grid, bytes, name);
  file.write(&entry, sizeof entry);
  file.write(name.c_str(), name.size() + 1);

  const std::uint64_t dataAt = file.size();
  const std::size_t largest = std::min<std::size_t>(size, kNvdbChunk) + BLOSC_MAX_OVERHEAD;
  const std::unique_ptr<char[]> packed(new char[largest]);
  for (std::size_t done = 0; done < size;) {
    progress.check();
    const std::size_t chunk = std::min<std::size_t>(size - done, kNvdbChunk);
    // One thread: with more, the order of blocks in the result depends on which ends first.
    const int count = blosc_compress_ctx(9, BLOSC_SHUFFLE, sizeof(float), chunk, bytes + done,
                                         packed.get(), largest, BLOSC_LZ4_COMPNAME, 1 << 18, 1);
    if (count <= 0)
      throw Error(Status::Write, file.path(), "Blosc could not compress a grid");
    const auto packedSize = static_cast<std::uint64_t>(count);
    file.write(&packedSize, sizeof packedSize);
    file.write(packed.get(), packedSize);
    done += chunk;
  }
  entry.fileSize = file.size() - dataAt;
  file.writeAt(entryAt, &entry, sizeof entry);
}

// Completes NanoVDB's checksum of a grid whose nodes lie breadth first: adds that over all nodes to
// that of grid, tree and root, which the grid has.
void completeChecksum(unsigned char* bytes) {
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
      sums[first + i] = crc32Of(bytes + kNvdbTreeAt + begin + i * size, size);
    });
    first += count;
  }
  if (sums.empty())
    return;
  const std::uint64_t tail = crc32Of(sums.data(), sums.size() * sizeof sums[0]);
  grid.checksum = (grid.checksum & 0xFFFFFFFF) | tail << 32;
  std::memcpy(bytes, &grid, sizeof grid);
}

} // namespace

void writeNanoGrids(const std::string& path, const std::vector<NanoBytes>& grids,
                    Progress& progress) {
  AtomicFile file(path);
  for (const NanoBytes& bytes : grids) {
    completeChecksum(bytes.data.get());
    NvdbGrid grid;
    std::memcpy(&grid, bytes.data.get(), sizeof grid);
    writeGrid(file, bytes.data.get(), bytes.size, grid.name, progress);
  }
  file.commit();
}

void writeNvdb(const std::string& path, const Volume& volume, Progress& progress) {
  initializeOpenVDB();
  AtomicFile file(path);
  const auto& grids = volume.grids().all;
  if (grids.empty())
    throw Error(Status::Usage, path, "a .nvdb file holds one grid at least");
  std::set<std::string> names;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const std::string name = grids[i]->getName();
    if (name.empty() || !names.insert(name).second)
      throw Error(Status::Usage, path, "grid names must be unique and not empty: '" + name + "'");
    NanoHandle handle;
    bool known = false;
    try {
      known = convert(*grids[i], handle);
    } catch (const std::bad_alloc&) {
      throw Error(Status::Limit, path, "grid '" + name + "' does not fit in memory as NanoVDB");
    } catch (const std::exception& e) {
      throw Error(Status::Usage, path, "grid '" + name + "' has no NanoVDB form: " + e.what(),
                  "write a .vdb file");
    }
    if (!known)
      throw Error(Status::Usage, path,
                  "grid '" + name + "' of type " + grids[i]->valueType() + " has no NanoVDB form",
                  "write a .vdb file");
    progress.update((double(i) + 0.6) / double(grids.size()));
    writeGrid(file, reinterpret_cast<const unsigned char*>(handle.data()), handle.buffer().size(),
              name, progress);
    progress.update(double(i + 1) / double(grids.size()));
  }
  file.commit();
}

} // namespace tetvdb
