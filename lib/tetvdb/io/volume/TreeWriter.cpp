// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TreeWriter.h"

#include "tetvdb/io/volume/SpoolParts.h"

#include <filesystem>
#include <utility>

namespace tetvdb {
namespace {

TreeWriterOptions inFolderOf(const std::string& path, const TreeWriterOptions& options) {
  TreeWriterOptions own = options;
  own.spool.folder = std::filesystem::path(path).parent_path().string();
  return own;
}

template <class Spool, class Output>
std::vector<GridInfo> writeSpools(std::vector<std::unique_ptr<Spool>> spools, Output& output,
                                  const ProgressShare& share) {
  std::vector<GridInfo> infos;
  for (std::size_t g = 0; g < spools.size(); ++g) {
    const double count = double(spools.size());
    spools[g]->writeTo(output, share.part(double(g) / count, double(g + 1) / count));
    infos.push_back(spools[g]->describe());
    spools[g].reset(); // and its files
  }
  return infos;
}

} // namespace

TreeVdbWriter::TreeVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                             const TreeWriterOptions& options)
    : path_(std::move(path)), metadata_(std::move(metadata)), options_(inFolderOf(path_, options)) {
}

std::vector<GridInfo> TreeVdbWriter::write(TreeSource& source, const ProgressShare& share,
                                           Progress& progress) {
  output_ = std::make_unique<VdbOutput>(path_, metadata_, source.make(NodeBox{}, progress).size());
  return writeSpools(spoolParts<VdbSpool>(source, makeVdbSpool, options_.spool,
                                          options_.openFirstTile, share.part(0, 0.8), progress),
                     *output_, share.part(0.8, 1));
}

void TreeVdbWriter::commit(Progress& progress) {
  output_->commit(progress);
}

TreeNvdbWriter::TreeNvdbWriter(const std::string& path, const TreeWriterOptions& options)
    : options_(inFolderOf(path, options)), file_(path) {}

std::vector<GridInfo> TreeNvdbWriter::write(TreeSource& source, const ProgressShare& share,
                                            Progress& progress) {
  return writeSpools(spoolParts<NvdbSpool>(source, makeNvdbSpool, options_.spool,
                                           options_.openFirstTile, share.part(0, 0.6), progress),
                     file_, share.part(0.6, 1));
}

void TreeNvdbWriter::commit(Progress& progress) {
  progress.check();
  file_.commit();
}

} // namespace tetvdb
