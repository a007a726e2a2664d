// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/NanoReader.h"
#include "tetvdb/io/volume/NvdbFile.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

namespace tetvdb {
namespace {

struct FreeAligned {
  void operator()(unsigned char* bytes) const { std::free(bytes); }
};
using Buffer = std::unique_ptr<unsigned char[], FreeAligned>;

Buffer allocate(std::uint64_t size) {
  constexpr std::size_t kAlignment = 32;
  const std::uint64_t rounded = (size + kAlignment - 1) / kAlignment * kAlignment;
  Buffer buffer(static_cast<unsigned char*>(std::aligned_alloc(kAlignment, rounded)));
  if (!buffer)
    throw std::bad_alloc();
  return buffer;
}

openvdb::GridBase::Ptr readGrid(const NvdbFile& file, const NvdbFile::Grid& from) {
  const Buffer buffer = allocate(from.size);
  unsigned char* to = buffer.get();
  file.unpack(from, [&](const unsigned char* bytes, std::size_t size) {
    std::memcpy(to, bytes, size);
    to += size;
  });
  return withNanoReader(buffer.get(), file, from, {}, [](auto& reader) -> openvdb::GridBase::Ptr {
    const auto grid = reader.empty();
    openvdb::Coord origin;
    while (reader.begin(origin))
      reader.read(*grid, std::numeric_limits<std::size_t>::max());
    return grid;
  });
}

} // namespace

Volume readNvdb(const std::string& path, Progress& progress) {
  initializeOpenVDB();
  Volume volume;
  try {
    const NvdbFile file(path);
    for (const NvdbFile::Grid& grid : file.grids()) {
      progress.check();
      volume.grids().all.push_back(readGrid(file, grid));
    }
  } catch (const Error& e) {
    if (e.status() != Status::Usage)
      throw;
    throw Error(Status::Invalid, path, e.what()); // a transform that OpenVDB does not take
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "does not fit in memory, or is damaged");
  } catch (const std::exception& e) {
    throw Error(Status::Invalid, path, std::string("cannot be read: ") + e.what());
  }
  return volume;
}

} // namespace tetvdb
