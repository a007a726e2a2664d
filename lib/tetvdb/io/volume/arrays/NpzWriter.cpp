// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/ZipWriter.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/NpyHeader.h"

#include <algorithm>

namespace tetvdb {
namespace {

class NpzFile {
public:
  NpzFile(const ArrayContent& content, Progress& progress)
      : content_(content), file_(content.path), zip_(file_),
        stream_(content, progress, content.sparse ? 2 : 1) {}

  void write() {
    // Small arrays come first, so that a reader of a pipe has them before the large ones.
    array("transform", npyHeader("<f8", {4, 4}), content_.transform);
    array("origin", npyHeader("<i4", {3}), content_.box.low);
    array("voxel_size", npyHeader("<f8", {3}), content_.voxelSize());
    if (content_.sparse) {
      const std::array<Vec3i, 2> box{content_.box.low, content_.box.high};
      array("box", npyHeader("<i4", {2, 3}), box);
    }
    for (std::size_t i = 0; i < content_.grids.size(); ++i)
      content_.sparse ? sparse(*content_.grids[i], content_.names[i])
                      : dense(*content_.grids[i], content_.names[i]);
    zip_.finish();
    file_.commit();
  }

private:
  void begin(const std::string& name, const std::string& header, double bytes) {
    zip_.begin(name + ".npy", content_.compress ? ZipMethod::Deflated : ZipMethod::Stored,
               header.size() + static_cast<std::uint64_t>(bytes));
    zip_.write(header);
  }

  template <typename Values>
  void array(const std::string& name, const std::string& header, const Values& values) {
    begin(name, header, sizeof values);
    zip_.write({reinterpret_cast<const char*>(values.data()), sizeof values});
    zip_.end();
  }

  ArrayStream::Sink sink() {
    return [this](const char* bytes, std::size_t size) { zip_.write({bytes, size}); };
  }

  void dense(const DenseGrid& grid, const std::string& name) {
    begin(name, npyHeader(grid), grid.bytes());
    stream_.send(grid, kXSlowest, sink());
    zip_.end();
  }

  void sparse(const DenseGrid& grid, const std::string& name) {
    const std::uint64_t voxels = grid.countActive();
    const std::string type = npyType(grid.element(), grid.isBits());
    begin(name + ".coordinates", npyHeader("<i4", {voxels, 3}), 12.0 * static_cast<double>(voxels));
    stream_.sendVoxels(grid, sink());
    zip_.end();
    std::vector<std::uint64_t> shape{voxels}, one;
    if (grid.components() > 1) {
      shape.push_back(grid.components());
      one.push_back(grid.components());
    }
    begin(name + ".values", npyHeader(type, shape),
          static_cast<double>(voxels) * static_cast<double>(grid.voxelBytes()));
    stream_.sendValues(grid, sink());
    zip_.end();
    const std::vector<char> background = grid.background();
    begin(name + ".background", npyHeader(type, one), static_cast<double>(background.size()));
    zip_.write({background.data(), background.size()});
    zip_.end();
  }

  const ArrayContent& content_;
  AtomicFile file_;
  ZipWriter zip_;
  ArrayStream stream_;
};

} // namespace

void writeNpz(const ArrayContent& content, Progress& progress) {
  NpzFile(content, progress).write();
}

} // namespace tetvdb
