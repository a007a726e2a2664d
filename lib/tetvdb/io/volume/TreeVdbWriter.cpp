// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TreeVdbWriter.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace tetvdb {
namespace {

using Spools = std::vector<std::unique_ptr<GridSpool>>;

Spools emptySpools(TreeSource& source, const SpoolOptions& options, Progress& progress) {
  Spools spools;
  for (const openvdb::GridBase::Ptr& grid : source.make(NodeBox{}, progress))
    spools.push_back(makeGridSpool(grid, options));
  return spools;
}

void spool(TreeSource& source, const Spools& spools, const ProgressShare& share,
           Progress& progress) {
  // What parts do in detail is not reported.
  Progress quiet;
  quiet.onCheck([&] { progress.check(); });
  source.begin();
  const std::size_t count = source.cubes().size();
  for (std::size_t c = 0; c < count; ++c) {
    for (const auto& one : spools)
      one->beginCube(source.cubes()[c]);
    const std::vector<NodeBox> parts = source.parts(c);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      openvdb::GridPtrVec grids = source.make(parts[p], quiet);
      for (std::size_t g = 0; g < grids.size(); ++g) {
        spools[g]->add(grids[g]);
        grids[g].reset();
      }
      share.update((double(c) + double(p + 1) / double(parts.size())) / double(count));
    }
    for (const auto& one : spools)
      one->endCube();
  }
}

} // namespace

TreeVdbWriter::TreeVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                             const TreeVdbOptions& options)
    : path_(std::move(path)), metadata_(std::move(metadata)), options_(options) {
  options_.spool.folder = std::filesystem::path(path_).parent_path().string();
}

std::vector<GridInfo> TreeVdbWriter::write(TreeSource& source, Progress& progress) {
  const ProgressShare whole(progress, 0, 1);
  Spools spools = emptySpools(source, options_.spool, progress);
  output_ = std::make_unique<VdbOutput>(path_, metadata_, spools.size());
  spool(source, spools, whole.part(0, 0.8), progress);
  const auto isTilesAlone = [](const auto& one) { return one->tileAlone().has_value(); };
  if (options_.openFirstTile && std::any_of(spools.begin(), spools.end(), isTilesAlone)) {
    Spools again = emptySpools(source, options_.spool, progress);
    for (std::size_t g = 0; g < spools.size(); ++g)
      if (const auto tile = spools[g]->tileAlone())
        again[g]->open(*tile);
    spools = std::move(again);
    spool(source, spools, whole.part(0, 0.8), progress);
  }
  std::vector<GridInfo> infos;
  for (std::size_t g = 0; g < spools.size(); ++g) {
    const double count = double(spools.size());
    spools[g]->writeTo(
        *output_, whole.part(0.8 + 0.2 * double(g) / count, 0.8 + 0.2 * double(g + 1) / count));
    infos.push_back(spools[g]->describe());
    spools[g].reset(); // and its files
  }
  return infos;
}

void TreeVdbWriter::commit(Progress& progress) {
  output_->commit(progress);
}

} // namespace tetvdb
