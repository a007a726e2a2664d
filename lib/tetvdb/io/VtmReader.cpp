// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VtmReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"
#include "tetvdb/io/source/PathWithin.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxBlocks = 100000;
constexpr int kDeepest = 16; ///< levels of multi-block files that name others

class MultiBlock {
public:
  MultiBlock(const ReadOptions& options, Report& report, Progress& progress)
      : options_(options), report_(report), progress_(progress) {}

  CellMesh read(const Source& source) {
    readFile(source, "", 0);
    whole_.regions = std::move(regions_);
    return std::move(whole_);
  }

  bool hasSolidCells(const Source& source) {
    kindsAlone_ = true;
    readFile(source, "", 0);
    return isSolid_;
  }

private:
  void readFile(const Source& source, const std::string& prefix, int depth) {
    if (depth > kDeepest)
      throw Error(Status::Invalid, source.path,
                  "multi-block files name each other, more than " + std::to_string(kDeepest) +
                      " deep",
                  "export it again");
    const vtk::VtuMarkup markup(source);
    const std::string type = markup.root().attribute("type").value();
    const pugi::xml_node blocks = markup.root().child(type.c_str());
    if (!blocks || (type != "vtkMultiBlockDataSet" && type != "vtkPartitionedDataSetCollection"))
      throw Error(Status::Invalid, source.path, "has no <vtkMultiBlockDataSet>",
                  "save the mesh as a multi-block data set");
    readBlocks(blocks, source.path, prefix, depth, 0);
  }

  void readBlocks(pugi::xml_node parent, const std::string& path, const std::string& prefix,
                  int depth, int level) {
    if (level > 256)
      throw Error(Status::Invalid, path, "blocks are nested more than 256 deep", "export it again");
    for (const pugi::xml_node node : parent.children()) {
      if (isSolid_)
        return;
      const std::string_view kind = node.name();
      std::string name = node.attribute("name").value();
      if (!prefix.empty())
        name = name.empty() ? prefix : prefix + "/" + name;
      if (kind == "Block" || kind == "Piece" || kind == "Partitions")
        readBlocks(node, path, name, depth, level + 1);
      else if (kind == "DataSet" && node.attribute("file"))
        readDataSet(path, node.attribute("file").value(), name, depth);
    }
  }

  void readDataSet(const std::string& path, const std::string& file, const std::string& name,
                   int depth) {
    if (++files_ > kMaxBlocks)
      throw Error(Status::Invalid, path, "names more than 100000 files",
                  "save the mesh as one unstructured grid");
    const std::string found = pathWithin(path, file);
    const MappedFile bytes(found);
    const FileFormat format = sniffFormat(bytes.bytes(), found);
    if (format == FileFormat::Vtm)
      return readFile(bytes.source(), name, depth + 1);
    if (kindsAlone_) {
      const Format& row = formatOf(format);
      isSolid_ =
          row.hasSolidCells != nullptr && row.hasSolidCells(bytes.source(), report_, progress_);
      return;
    }
    CellMesh mesh;
    if (format == FileFormat::Vtp)
      mesh = readVtu(bytes.source(), options_, report_, progress_);
    else if (format == FileFormat::Vtu || format == FileFormat::Vts || format == FileFormat::Pvtu ||
             format == FileFormat::Vtk)
      mesh = formatOf(format).readCells(bytes.source(), options_, report_, progress_);
    else {
      report_.warn("block-left-out", "the block '" + (name.empty() ? file : name) +
                                         "' is left out: it is neither a grid nor polygons");
      report_.partial = true;
      return;
    }
    ++block_;
    if (!name.empty())
      whole_.regionNames[block_] = name;
    regions_.resize(regions_.size() + mesh.cellCount(), block_);
    auto names = std::move(whole_.regionNames);
    vtk::appendPiece(whole_, std::move(mesh), report_);
    whole_.regionNames = std::move(names);
    progress_.check();
  }

  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  CellMesh whole_;
  std::vector<std::int32_t> regions_;
  std::int32_t block_ = 0;
  std::size_t files_ = 0;
  bool kindsAlone_ = false, isSolid_ = false;
};

} // namespace

CellMesh readVtm(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return MultiBlock(options, report, progress).read(source);
}

bool vtmHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const ReadOptions options;
  return MultiBlock(options, report, progress).hasSolidCells(source);
}

} // namespace tetvdb
