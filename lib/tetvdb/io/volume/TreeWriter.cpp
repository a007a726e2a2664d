// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TreeWriter.h"

#include "tetvdb/io/volume/SpoolParts.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <utility>

namespace tetvdb {
namespace {

TreeWriterOptions inFolderOf(const std::string& path, const TreeWriterOptions& options) {
  TreeWriterOptions own = options;
  own.spool.folder = std::filesystem::path(path).parent_path().string();
  return own;
}

// In either format.
void writeMore(VdbOutput& output, const openvdb::GridPtrVec& grids, const ProgressShare& share) {
  writeGrids(output, grids, share);
}
void writeMore(AtomicFile& file, const openvdb::GridPtrVec& grids, const ProgressShare& share) {
  writeNvdbGrids(file, grids, share);
}

template <class Spool, class Output>
std::vector<GridInfo> writeSpools(std::vector<std::unique_ptr<Spool>> spools, Output& output,
                                  const TreeWriter::MoreGrids& more, const ProgressShare& share) {
  Volume others; // before the rest, which takes long: a limit may be met here
  if (more)
    others.grids().all = more();
  std::vector<GridInfo> infos;
  for (std::size_t g = 0; g < spools.size(); ++g) {
    const double count = double(spools.size());
    spools[g]->writeTo(output, share.part(double(g) / count, double(g + 1) / count));
    infos.push_back(spools[g]->describe());
    spools[g].reset(); // and its files
  }
  writeMore(output, others.grids().all, share.part(1, 1));
  for (GridInfo& info : describe(others))
    infos.push_back(std::move(info));
  return infos;
}

} // namespace

TreeVdbWriter::TreeVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                             const TreeWriterOptions& options)
    : path_(std::move(path)), metadata_(std::move(metadata)), options_(inFolderOf(path_, options)) {
}

std::vector<GridInfo> TreeVdbWriter::write(TreeSource& source, const MoreGrids& more,
                                           const ProgressShare& share, Progress& progress) {
  output_ = std::make_unique<VdbOutput>(
      path_, metadata_, source.make(NodeBox{}, progress).size() + options_.moreGrids);
  return writeSpools(spoolParts<VdbSpool>(source, makeVdbSpool, options_.spool,
                                          options_.openFirstTile, share.part(0, 0.8), progress),
                     *output_, more, share.part(0.8, 1));
}

void TreeVdbWriter::commit(Progress& progress) {
  output_->commit(progress);
}

TreeNvdbWriter::TreeNvdbWriter(const std::string& path, const TreeWriterOptions& options)
    : options_(inFolderOf(path, options)), file_(path) {}

std::vector<GridInfo> TreeNvdbWriter::write(TreeSource& source, const MoreGrids& more,
                                            const ProgressShare& share, Progress& progress) {
  return writeSpools(spoolParts<NvdbSpool>(source, makeNvdbSpool, options_.spool,
                                           options_.openFirstTile, share.part(0, 0.6), progress),
                     file_, more, share.part(0.6, 1));
}

void TreeNvdbWriter::commit(Progress& progress) {
  progress.check();
  file_.commit();
}

} // namespace tetvdb
