// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/MergeVdb.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/DelayedLoad.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/VdbChildren.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/io/volume/VdbPart.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/volume/NodeBytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/tools/Prune.h>
#include <optional>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kCopyBytes = std::size_t(4) << 20;
using Base = openvdb::GridBase;

/// In order of their numbers.
std::vector<VdbPart> readParts(const std::vector<std::string>& paths, Progress& progress) {
  if (paths.empty())
    throw Error(Status::Usage, "", "no part was given");
  std::vector<VdbPart> parts;
  for (const std::string& path : paths) {
    progress.check();
    parts.push_back(readVdbPart(path));
  }
  const VdbPart& first = parts.front();
  for (const VdbPart& part : parts)
    if (part.part.job != first.part.job || part.part.count != first.part.count ||
        part.grids.size() != first.grids.size())
      throw Error(Status::Invalid, part.path, "is a part of another volume than " + first.path,
                  "merge the parts of one job, made with the same inputs and options");
  std::vector<const VdbPart*> found(first.part.count);
  for (const VdbPart& part : parts) {
    const VdbPart*& place = found[part.part.index];
    if (place != nullptr)
      throw Error(
          Status::Invalid, part.path,
          fmt::format("is part {} of {}, as {} is", part.part.index, part.part.count, place->path),
          "give every part once");
    place = &part;
  }
  std::string missing;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (found[i] == nullptr)
      missing += fmt::format("{}{}/{}", missing.empty() ? "" : ", ", i, found.size());
  if (!missing.empty())
    throw Error(Status::Invalid, "", "parts are missing: " + missing,
                "make them with `shard`, or give them too");
  std::sort(parts.begin(), parts.end(),
            [](const VdbPart& a, const VdbPart& b) { return a.part.index < b.part.index; });
  for (const VdbPart& part : parts)
    for (std::size_t g = 0; g < part.grids.size(); ++g) {
      const PartGrid &one = part.grids[g], &other = parts.front().grids[g];
      if (one.header.name != other.header.name || one.header.type != other.header.type ||
          one.header.half != other.header.half || one.transformBytes != other.transformBytes ||
          one.root != other.root || one.level != other.level)
        throw Error(Status::Invalid, part.path, "has other grids than " + parts.front().path);
    }
  return parts;
}

template <class T>
T metadataOf(const PartGrid& grid, const char* name, const VdbPart& part) {
  const auto value = grid.header.metadata.getMetadata<openvdb::TypedMetadata<T>>(name);
  if (!value)
    throw Error(Status::Invalid, part.path, std::string("a grid lacks the metadata ") + name,
                "write this part again");
  return value->value();
}

struct TypeInfo {
  NodeBytes bytes{};
  bool hasDelayedLoad = false;
};

// Of a type that parts may have.
TypeInfo infoOfType(const std::string& type) {
  TypeInfo info;
  const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(type);
  withKnownGrid(std::as_const(*grid), [&](const auto& typed) {
    using TreeT = typename std::decay_t<decltype(typed)>::TreeType;
    info = {openvdbNodeBytes<TreeT>(), !hasBitLeaves<TreeT>};
  });
  return info;
}

// The entries of leaves of all parts.
void joinDelayedLoad(const std::vector<VdbPart>& parts, std::size_t g, std::uint64_t leaves,
                     openvdb::MetaMap& metadata) {
  using Delayed = openvdb::io::DelayedLoadMetadata;
  Delayed all;
  all.resizeMask(leaves);
  all.resizeCompressedSize(leaves);
  std::size_t l = 0;
  for (const VdbPart& part : parts) {
    const auto own =
        part.grids[g].header.metadata.getMetadata<Delayed>(Base::META_FILE_DELAYED_LOAD);
    if (!own)
      throw Error(Status::Invalid, part.path,
                  std::string("a grid lacks the metadata ") + Base::META_FILE_DELAYED_LOAD,
                  "write this part again");
    for (std::size_t i = 0; i < part.grids[g].leaves; ++i, ++l) {
      all.setMask(l, own->getMask(i));
      all.setCompressedSize(l, own->getCompressedSize(i));
    }
  }
  insertDelayedLoad(metadata, all, leaves);
}

std::string bytesOf(std::uint32_t number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

VdbHead headOf(const std::vector<VdbPart>& parts, std::size_t g) {
  const PartGrid& first = parts.front().grids[g];
  const TypeInfo type = infoOfType(first.header.type);
  const std::size_t root = type.bytes.root;
  openvdb::MetaMap metadata(first.header.metadata);
  openvdb::Vec3i low = metadataOf<openvdb::Vec3i>(first, Base::META_FILE_BBOX_MIN, parts.front());
  openvdb::Vec3i high = metadataOf<openvdb::Vec3i>(first, Base::META_FILE_BBOX_MAX, parts.front());
  std::int64_t voxels = 0, bytes = static_cast<std::int64_t>(root);
  std::uint64_t leaves = 0;
  std::uint32_t children = 0, tileCount = 0;
  std::string tiles;
  for (const VdbPart& part : parts) {
    const PartGrid& grid = part.grids[g];
    const auto own = metadataOf<openvdb::Int64>(grid, Base::META_FILE_VOXEL_COUNT, part);
    const auto min = metadataOf<openvdb::Vec3i>(grid, Base::META_FILE_BBOX_MIN, part);
    const auto max = metadataOf<openvdb::Vec3i>(grid, Base::META_FILE_BBOX_MAX, part);
    for (int k = 0; k < 3 && own > 0; ++k) {
      low[k] = voxels == 0 ? min[k] : std::min(low[k], min[k]);
      high[k] = voxels == 0 ? max[k] : std::max(high[k], max[k]);
    }
    voxels += own;
    bytes += metadataOf<openvdb::Int64>(grid, Base::META_FILE_MEM_BYTES, part) -
             static_cast<std::int64_t>(root);
    leaves += grid.leaves;
    children += grid.children;
    tileCount += grid.tileCount;
    tiles += grid.tiles;
  }
  if (leaves >= std::numeric_limits<std::uint32_t>::max())
    throw Error(Status::Limit, "", "the grid would have 2^32 leaves or more",
                "OpenVDB cannot count them: use the parts as they are");
  metadata.insertMeta(Base::META_FILE_BBOX_MIN, openvdb::Vec3IMetadata(low));
  metadata.insertMeta(Base::META_FILE_BBOX_MAX, openvdb::Vec3IMetadata(high));
  metadata.insertMeta(Base::META_FILE_MEM_BYTES, openvdb::Int64Metadata(bytes));
  metadata.insertMeta(Base::META_FILE_VOXEL_COUNT, openvdb::Int64Metadata(voxels));
  metadata.removeMeta(Base::META_FILE_DELAYED_LOAD);
  if (type.hasDelayedLoad && leaves <= kDelayedLoadLeaves)
    joinDelayedLoad(parts, g, leaves, metadata);
  return makeVdbHead(first.header.name, first.header.type + (first.header.half ? "_HalfFloat" : ""),
                     "", metadata, *first.header.transform,
                     first.root + bytesOf(tileCount) + bytesOf(children) + tiles);
}

class Copier {
public:
  Copier(VdbOutput& output, std::uint64_t total, Progress& progress)
      : output_(output), buffer_(kCopyBytes), total_(total), progress_(progress) {}

  void copy(const std::string& path, std::uint64_t from, std::uint64_t to) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0)
      failToOpen(path, errno);
    try {
      while (from < to) {
        const auto wanted =
            static_cast<std::size_t>(std::min<std::uint64_t>(to - from, kCopyBytes));
        const ssize_t got = ::pread(file, buffer_.data(), wanted, static_cast<off_t>(from));
        if (got < 0 && errno == EINTR)
          continue;
        if (got <= 0)
          fail(path, got < 0 ? errno : EIO);
        output_.write(buffer_.data(), static_cast<std::size_t>(got));
        from += static_cast<std::uint64_t>(got);
        done_ += static_cast<std::uint64_t>(got);
        progress_.update(static_cast<double>(done_) / static_cast<double>(total_ + 1));
      }
    } catch (...) {
      ::close(file);
      throw;
    }
    ::close(file);
  }

private:
  [[noreturn]] static void fail(const std::string& path, int error) {
    throw Error(Status::Invalid, path, std::string("cannot be read: ") + std::strerror(error));
  }

  VdbOutput& output_;
  std::vector<char> buffer_;
  std::uint64_t total_, done_ = 0;
  Progress& progress_;
};

// A grid whose nodes are made anew: one of tiles alone, one of which is opened, or of a level of
// detail, in whose nodes several parts may have voxels.
class RemadeGrid {
public:
  RemadeGrid(const std::vector<VdbPart>& parts, std::size_t g, const std::string& output)
      : parts_(parts), g_(g) {
    options_.folder = std::filesystem::path(output).parent_path().string();
  }

  void writeTo(VdbOutput& output, const ProgressShare& share, Progress& progress) {
    withKnownGrid(*openvdb::GridBase::createGrid(parts_.front().grids[g_].header.type),
                  [&](const auto& typed) {
                    using GridT = std::decay_t<decltype(typed)>;
                    std::unique_ptr<VdbSpool> made = spool<GridT>({}, progress);
                    if (const std::optional<Vec3i> tile = made->tileAlone())
                      made = spool<GridT>(tile, progress);
                    made->writeTo(output, share);
                  });
  }

private:
  // The entries of the root nodes of a part's grid, one at a time.
  template <class GridT>
  struct Entries {
    Entries(const VdbPart& part, std::size_t g)
        : header(readVdbHeader(part.path)), children(part.path, header, header.grids[g]) {}
    void advance() { next = children.next(origin); }

    VdbHeader header;
    VdbChildren<GridT> children;
    openvdb::Coord origin;
    typename GridT::Ptr next; ///< at `origin`; null at the end
  };

  openvdb::GridBase::Ptr emptyGrid(const openvdb::GridBase::Ptr& grid) const {
    for (const char* name :
         {kPartLeaves, kPartLevel, Base::META_FILE_BBOX_MIN, Base::META_FILE_BBOX_MAX,
          Base::META_FILE_MEM_BYTES, Base::META_FILE_VOXEL_COUNT, Base::META_FILE_COMPRESSION})
      grid->removeMeta(name);
    if (parts_.front().grids[g_].level.value_or(false))
      grid->setSaveFloatAsHalf(true);
    return grid;
  }

  template <class GridT>
  std::unique_ptr<VdbSpool> spool(const std::optional<Vec3i>& opened, Progress& progress) const {
    std::vector<std::unique_ptr<Entries<GridT>>> parts;
    for (const VdbPart& part : parts_) {
      parts.push_back(std::make_unique<Entries<GridT>>(part, g_));
      parts.back()->advance();
    }
    auto spool = makeVdbSpool(emptyGrid(parts.front()->children.empty()), options_);
    if (opened)
      spool->open(*opened);
    for (;;) {
      const Entries<GridT>* first = nullptr;
      for (const auto& part : parts)
        if (part->next && (first == nullptr || part->origin < first->origin))
          first = part.get();
      if (first == nullptr)
        return spool;
      progress.check();
      const openvdb::Coord origin = first->origin;
      typename GridT::Ptr joined;
      for (const auto& part : parts) {
        if (!part->next || part->origin != origin)
          continue;
        if (joined)
          joined->tree().merge(part->next->tree(), openvdb::MERGE_ACTIVE_STATES);
        else
          joined = part->next;
        part->advance();
      }
      openvdb::tools::prune(joined->tree());
      spool->beginCube({origin.x(), origin.y(), origin.z()});
      spool->add(joined);
      spool->endCube();
    }
  }

  const std::vector<VdbPart>& parts_;
  std::size_t g_;
  SpoolOptions options_;
};

bool isTilesAlone(const std::vector<VdbPart>& parts, std::size_t g) {
  std::int64_t voxels = 0;
  for (const VdbPart& part : parts) {
    if (part.grids[g].leaves > 0)
      return false;
    voxels += metadataOf<openvdb::Int64>(part.grids[g], Base::META_FILE_VOXEL_COUNT, part);
  }
  return voxels > 0;
}

} // namespace

MergeResult mergeVdb(const std::vector<std::string>& paths, const std::string& output,
                     const MergeOptions& options, Progress& progress) {
  progress.stage("merge");
  const std::vector<VdbPart> parts = readParts(paths, progress);
  MergeResult result;
  result.parts = parts.size();
  std::uint64_t total = 0;
  for (const PartGrid& grid : parts.front().grids)
    result.grids.push_back(grid.header.name);
  for (const VdbPart& part : parts) {
    result.leaves += part.grids.front().leaves;
    result.activeVoxels += static_cast<std::uint64_t>(
        metadataOf<openvdb::Int64>(part.grids.front(), Base::META_FILE_VOXEL_COUNT, part));
    for (const PartGrid& grid : part.grids)
      total += grid.header.end - grid.topologyAt;
  }
  if (result.activeVoxels == 0 && !options.allowEmpty)
    throw Error(Status::Invalid, "", "none of the parts has a voxel",
                "use smaller voxels, or `allow_empty` to write an empty grid");
  VdbOutput file(output, parts.front().metadata, parts.front().grids.size());
  Copier copier(file, total, progress);
  for (std::size_t g = 0; g < parts.front().grids.size(); ++g) {
    if (parts.front().grids[g].level || isTilesAlone(parts, g)) {
      RemadeGrid(parts, g, output).writeTo(file, {progress, 0, 1}, progress);
      result.leaves += g == 0 ? 1 : 0;
      continue;
    }
    const VdbHead head = headOf(parts, g);
    file.beginGrid(head);
    for (const VdbPart& part : parts)
      copier.copy(part.path, part.grids[g].topologyAt, part.grids[g].header.buffersAt);
    const std::uint64_t buffersAt = file.position();
    for (const VdbPart& part : parts)
      copier.copy(part.path, part.grids[g].header.buffersAt, part.grids[g].header.end);
    file.finishGrid(head, buffersAt);
  }
  file.commit(progress);
  return result;
}

} // namespace tetvdb
