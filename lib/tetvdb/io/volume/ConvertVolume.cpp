// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/FileSpool.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/NanoReader.h"
#include "tetvdb/io/volume/NvdbHead.h"
#include "tetvdb/io/volume/StreamedVdb.h"
#include "tetvdb/io/volume/VdbChildren.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/ChooseGrids.h"
#include "tetvdb/volume/GridLevels.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

/// Shares of a grid's progress.
constexpr double kUnpacked = 0.1, kSpooled = 0.7;

/// The output's grids, one after another.
class ConvertedFile {
public:
  ConvertedFile(const VolumeConversion& files, std::map<std::string, std::string> metadata,
                std::size_t grids)
      : path_(files.output), range_(files.levels),
        gridBytes_(files.maxMemory / 2 / std::max<std::size_t>(grids, 1)) {
    const std::size_t maxMemory = files.maxMemory;
    options_.exact = true;
    options_.folder = std::filesystem::path(path_).parent_path().string();
    options_.inMemory = std::min(maxMemory / 16, std::size_t(32) << 20);
    partBytes_ = std::min(maxMemory / 4, std::size_t(256) << 20);
    if (endingOf(path_) == ".nvdb")
      nvdb_.emplace(path_);
    else
      vdb_.emplace(path_, metadata, grids * (1 + range_.size()));
  }

  const std::string& folder() const { return options_.folder; }

  /// `entries`: a VdbChildren or a NanoReader.
  template <class Entries>
  void add(Entries& entries, const ProgressShare& share, Progress& progress) {
    const openvdb::GridBase::Ptr empty = entries.empty();
    requireNames({empty});
    if (nvdb_) {
      requireNvdbForm(*empty, path_);
      write(makeNvdbSpool(empty, options_), *nvdb_, entries, share, progress);
    } else {
      write(makeVdbSpool(empty, options_), *vdb_, entries, share, progress);
    }
  }

  std::vector<GridInfo> commit(Progress& progress) {
    progress.check();
    const ProgressShare end(progress, 1, 1);
    requireNames(coarser_);
    if (nvdb_) {
      writeNvdbGrids(*nvdb_, coarser_, end);
      nvdb_->commit();
    } else {
      writeGrids(*vdb_, coarser_, end);
      vdb_->commit(progress);
    }
    Volume coarser;
    coarser.grids().all = std::move(coarser_);
    for (GridInfo& info : describe(coarser))
      infos_.push_back(std::move(info));
    return std::move(infos_);
  }

private:
  void requireNames(const openvdb::GridPtrVec& grids) {
    for (const auto& grid : grids)
      if (grid->getName().empty() || !names_.insert(grid->getName()).second)
        throw Error(Status::Usage, path_,
                    "grid names must be unique and not empty: '" + grid->getName() + "'");
  }

  template <class Spool, class Output, class Entries>
  void write(std::unique_ptr<Spool> spool, Output& output, Entries& entries,
             const ProgressShare& share, Progress& progress) {
    std::unique_ptr<GridLevels> levels;
    if (!range_.isEmpty())
      levels = makeGridLevels(entries.empty(), range_, gridBytes_);
    openvdb::Coord origin;
    std::optional<openvdb::Coord> last;
    while (entries.begin(origin)) {
      if (last && !(*last < origin))
        throw Error(Status::Invalid, "grid '" + spool->describe().name + "'",
                    "has nodes in another order than a tree's",
                    "write the file again with OpenVDB");
      last = origin;
      spool->beginCube({origin.x(), origin.y(), origin.z()});
      while (const auto part = entries.part(partBytes_)) {
        progress.check();
        if (levels)
          levels->add(*part, progress);
        spool->add(part);
        share.update(kUnpacked + (kSpooled - kUnpacked) * entries.share());
      }
      spool->endCube();
    }
    if (levels)
      for (const auto& grid : levels->finish()) {
        openFirstTile(*grid);
        coarser_.push_back(grid);
      }
    spool->writeTo(output, share.part(kSpooled, 1));
    infos_.push_back(spool->describe());
  }

  std::string path_;
  LevelRange range_;
  std::size_t gridBytes_; ///< that the levels of a grid may take
  openvdb::GridPtrVec coarser_;
  std::size_t partBytes_;
  SpoolOptions options_;
  std::optional<AtomicFile> nvdb_;
  std::optional<VdbOutput> vdb_;
  std::set<std::string> names_;
  std::vector<GridInfo> infos_;
};

std::vector<GridInfo> convertVdb(const VolumeConversion& files, Progress& progress) {
  const VdbHeader header = checkedVdbHeader(files.input);
  const std::vector<const VdbGridHeader*> grids = chosenGrids(header, files.input, files.grids);
  ConvertedFile output(files, header.metadata, grids.size());
  const ProgressShare whole(progress, 0, 1);
  for (std::size_t g = 0; g < grids.size(); ++g)
    withGridOfType(grids[g]->type, [&](const auto& tag) {
      VdbChildren<std::decay_t<decltype(tag)>> children(files.input, header, *grids[g]);
      output.add(children,
                 whole.part(double(g) / double(grids.size()), double(g + 1) / double(grids.size())),
                 progress);
    });
  return output.commit(progress);
}

// A NanoVDB grid waits, unpacked, in a file without a name.
std::vector<GridInfo> convertNvdb(const VolumeConversion& files, Progress& progress) {
  const NvdbFile file(files.input);
  std::vector<std::string> names;
  for (const NvdbFile::Grid& grid : file.grids())
    names.push_back(grid.name);
  const std::vector<std::size_t> grids = chooseGrids(names, files.grids, files.input);
  ConvertedFile output(files, {}, grids.size());
  const ProgressShare whole(progress, 0, 1);
  for (std::size_t g = 0; g < grids.size(); ++g) {
    const ProgressShare share =
        whole.part(double(g) / double(grids.size()), double(g + 1) / double(grids.size()));
    const NvdbFile::Grid& grid = file.grids()[grids[g]];
    FileSpool bytes(output.folder());
    file.unpack(grid, [&](const unsigned char* data, std::size_t size) {
      progress.check();
      bytes.append(data, size);
      share.update(kUnpacked * double(bytes.size()) / double(grid.size));
    });
    bytes.finish();
    withNanoReader(
        bytes.as<unsigned char>(), file, grid, [&] { bytes.release(); },
        [&](auto& reader) { output.add(reader, share, progress); });
  }
  return output.commit(progress);
}

bool isNanoVdb(const std::string& path) {
  const MappedFile file(path);
  return sniffFormat(file.bytes(), path) == FileFormat::Nvdb;
}

} // namespace

bool canConvertVolume(const std::string& path) {
  return isNanoVdb(path) || canStreamVolume(path);
}

std::vector<GridInfo> convertVolumeFile(const VolumeConversion& files, Progress& progress) {
  initializeOpenVDB();
  try {
    return isNanoVdb(files.input) ? convertNvdb(files, progress) : convertVdb(files, progress);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, files.input, "does not fit in memory, or is damaged");
  } catch (const std::exception& e) {
    throw Error(Status::Invalid, files.input, std::string("cannot be read: ") + e.what());
  }
}

} // namespace tetvdb
