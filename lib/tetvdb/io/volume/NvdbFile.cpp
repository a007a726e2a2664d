// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NvdbFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/io/volume/VolumeCursor.h"

#include <algorithm>
#include <blosc.h>
#include <cstring>
#include <tbb/task_arena.h>
#include <zlib.h>

namespace tetvdb {
namespace {

constexpr std::size_t kSliceBytes = std::size_t(1) << 20;   // unpacked at once
constexpr std::size_t kReleaseBytes = std::size_t(8) << 20; // between two releases of the file
constexpr std::size_t kWindowBytes = std::size_t(64) << 20; // of slices in memory

void skipGrid(VolumeCursor& cursor, std::uint64_t size, NvdbCodec codec) {
  // The largest ratios that the compressors can reach. A file that states more is damaged.
  const std::uint64_t ratio = codec == NvdbCodec::Zip ? 1100 : codec == NvdbCodec::Blosc ? 300 : 1;
  if (size < sizeof(NvdbGrid) || size / ratio > cursor.left())
    cursor.fail("a grid's size is impossible");
  switch (codec) {
  case NvdbCodec::None:
    cursor.take(size, "a grid");
    break;
  case NvdbCodec::Zip:
    cursor.take(cursor.value<std::uint64_t>("a grid"), "a grid");
    break;
  case NvdbCodec::Blosc:
    for (std::uint64_t done = 0; done < size; done += std::min(size - done, kNvdbChunk))
      cursor.take(cursor.value<std::uint64_t>("a grid"), "a grid");
    break;
  default:
    cursor.fail("unknown compression");
  }
}

using TakeBytes = std::function<void(const unsigned char*, std::size_t)>;

void inflateGrid(VolumeCursor& cursor, std::uint64_t size, const TakeBytes& take) {
  const auto packed = cursor.value<std::uint64_t>("a grid");
  const char* from = cursor.take(packed, "a grid");
  const auto damaged = [&] { cursor.fail("a compressed grid is damaged"); };
  struct Inflating : z_stream {
    Inflating() : z_stream{} {
      if (inflateInit(this) != Z_OK)
        throw std::bad_alloc();
    }
    ~Inflating() { inflateEnd(this); }
  } stream;
  std::vector<unsigned char> out(kSliceBytes);
  std::uint64_t fed = 0, got = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    if (stream.avail_in == 0 && fed < packed) {
      const std::uint64_t next = std::min<std::uint64_t>(packed - fed, kSliceBytes);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from + fed));
      stream.avail_in = static_cast<uInt>(next);
      fed += next;
    }
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    state = inflate(&stream, Z_NO_FLUSH);
    const std::size_t made = out.size() - stream.avail_out;
    if ((state != Z_OK && state != Z_STREAM_END) || made > size - got)
      damaged();
    take(out.data(), made);
    got += made;
  }
  if (got != size || fed != packed || stream.avail_in != 0)
    damaged();
}

// One chunk of Blosc, `size` bytes of the grid.
void unpackChunk(VolumeCursor& cursor, std::size_t size, const TakeBytes& take) {
  const auto packed = cursor.value<std::uint64_t>("a grid");
  const char* from = cursor.take(packed, "a grid");
  std::size_t claimed = 0, type = 0, block = 0, unused = 0;
  int flags = 0;
  if (blosc_cbuffer_validate(from, packed, &claimed) < 0 || claimed != size)
    cursor.fail("a compressed grid is damaged");
  blosc_cbuffer_metainfo(from, &type, &flags);
  blosc_cbuffer_sizes(from, &unused, &unused, &block);
  if (type == 0 || block == 0 || block % type != 0 || size % type != 0)
    cursor.fail("a compressed grid is damaged");
  const std::size_t slice = std::max(kSliceBytes / block, std::size_t(1)) * block;
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  std::size_t next = 0;
  using Slice = std::shared_ptr<std::vector<unsigned char>>;
  makeInOrder<std::size_t, Slice>(
      [&](std::size_t& begin) {
        begin = next;
        next += slice;
        return begin < size;
      },
      [&](std::size_t begin) {
        const auto bytes =
            std::make_shared<std::vector<unsigned char>>(std::min(slice, size - begin));
        if (blosc_getitem(from, static_cast<int>(begin / type),
                          static_cast<int>(bytes->size() / type),
                          bytes->data()) != static_cast<int>(bytes->size()))
          cursor.fail("a compressed grid is damaged");
        return bytes;
      },
      [&](const Slice& bytes) { take(bytes->data(), bytes->size()); },
      std::clamp(kWindowBytes / slice, std::size_t(1), 4 * threads));
}

} // namespace

NvdbFile::NvdbFile(const std::string& path) : file_(path), path_(path) {
  const Source source = file_.source();
  VolumeCursor cursor(source);
  while (!cursor.atEnd()) {
    const auto header = cursor.value<NvdbHeader>("a header");
    if (header.magic != kNvdbMagic && header.magic != kNvdbFileMagic)
      cursor.fail("is not a .nvdb file");
    const std::size_t first = grids_.size();
    for (int i = 0; i < header.gridCount; ++i) {
      const auto entry = cursor.value<NvdbEntry>("the list of grids");
      const std::string name(cursor.take(entry.nameSize, "a grid's name"), entry.nameSize);
      grids_.push_back({name.substr(0, name.find('\0')), entry.gridSize, header.codec, 0});
    }
    for (std::size_t g = first; g < grids_.size(); ++g) {
      grids_[g].at = cursor.position();
      skipGrid(cursor, grids_[g].size, header.codec);
    }
  }
  if (grids_.empty())
    throw Error(Status::Invalid, path, "holds no grid");
}

void NvdbFile::unpack(const Grid& grid, const TakeBytes& take) const {
  const Source source = file_.source();
  VolumeCursor cursor(source, grid.at);
  std::size_t taken = 0;
  const TakeBytes andRelease = [&](const unsigned char* bytes, std::size_t size) {
    take(bytes, size);
    taken += size;
    if (taken >= kReleaseBytes) {
      source.release();
      taken = 0;
    }
  };
  if (grid.codec == NvdbCodec::Zip)
    return inflateGrid(cursor, grid.size, andRelease);
  for (std::uint64_t done = 0; done < grid.size;) {
    const bool blosc = grid.codec == NvdbCodec::Blosc;
    const auto chunk = static_cast<std::size_t>(
        std::min<std::uint64_t>(grid.size - done, blosc ? kNvdbChunk : kSliceBytes));
    if (blosc)
      unpackChunk(cursor, chunk, andRelease);
    else
      andRelease(reinterpret_cast<const unsigned char*>(cursor.take(chunk, "a grid")), chunk);
    done += chunk;
  }
}

void NvdbFile::fail(const Grid& grid, const std::string& what) const {
  VolumeCursor::failAt(path_, grid.at, what);
}

} // namespace tetvdb
