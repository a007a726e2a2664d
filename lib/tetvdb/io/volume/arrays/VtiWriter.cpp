// SPDX-License-Identifier: Apache-2.0
//
// Format: "VTK XML Formats", ImageData, appended raw data; blocks of vtkZLibDataCompressor.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/XmlText.h"
#include "tetvdb/io/text/ZlibBytes.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr std::size_t kBlock = std::size_t(1) << 20; ///< bytes compressed as one

// Blocks of one array, compressed in parallel and written in order.
class BlockWriter {
public:
  BlockWriter(AtomicFile& file, std::uint64_t bytes) : file_(file), start_(file.size()) {
    const std::uint64_t blocks = (bytes + kBlock - 1) / kBlock;
    header_ = {blocks, kBlock, bytes % kBlock};
    header_.resize(static_cast<std::size_t>(3 + blocks), 0);
    file_.write(header_.data(), header_.size() * sizeof(std::uint64_t)); // the sizes come later
  }

  void write(const char* bytes, std::size_t size) {
    waiting_.append(bytes, size);
    pack(waiting_.size() / kBlock);
  }

  void finish() {
    pack((waiting_.size() + kBlock - 1) / kBlock);
    file_.writeAt(start_, header_.data(), header_.size() * sizeof(std::uint64_t));
  }

private:
  void pack(std::size_t blocks) {
    std::vector<std::string> packed(blocks);
    tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t i) {
      packed[i] =
          zlibBytes(waiting_.data() + i * kBlock, std::min(kBlock, waiting_.size() - i * kBlock));
    });
    for (const std::string& block : packed) {
      file_.write(block.data(), block.size());
      header_[3 + done_++] = block.size();
    }
    waiting_.erase(0, std::min(waiting_.size(), blocks * kBlock));
  }

  AtomicFile& file_;
  std::uint64_t start_;
  std::vector<std::uint64_t> header_;
  std::string waiting_;
  std::size_t done_ = 0;
};

class VtiFile {
public:
  VtiFile(const ArrayContent& content, Progress& progress)
      : content_(content), file_(content.path), stream_(content, progress) {}

  void write() {
    writeMarkup();
    const std::uint64_t start = file_.size();
    for (std::size_t i = 0; i < content_.grids.size(); ++i) {
      const std::string offset = fmt::format("{:020}", file_.size() - start);
      file_.writeAt(offsets_[i], offset.data(), offset.size());
      const DenseGrid& grid = *content_.grids[i];
      const auto bytes = static_cast<std::uint64_t>(grid.bytes());
      if (content_.compress) {
        BlockWriter blocks(file_, bytes);
        stream_.send(grid, kXFastest,
                     [&](const char* data, std::size_t size) { blocks.write(data, size); });
        blocks.finish();
      } else {
        file_.write(&bytes, sizeof bytes);
        stream_.send(grid, kXFastest,
                     [&](const char* data, std::size_t size) { file_.write(data, size); });
      }
    }
    text("\n  </AppendedData>\n</VTKFile>\n");
    file_.commit();
  }

private:
  void text(const std::string& markup) { file_.write(markup.data(), markup.size()); }

  // "1 0 0 0 1 0 0 0 1": axes of index space in world space.
  std::string direction() const {
    const Vec3d size = content_.voxelSize();
    const auto column = [&](std::size_t axis, std::size_t row) {
      return content_.transform[4 * row + axis] / size[axis];
    };
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3;
      double product = 0;
      for (std::size_t row = 0; row < 3; ++row)
        product += column(a, row) * column(b, row);
      if (std::abs(product) > 1e-12)
        throw Error(Status::Usage, content_.path,
                    "a .vti file has no place for a sheared transform",
                    "write .npz, .nrrd, .h5 or .raw");
    }
    std::string numbers;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t axis = 0; axis < 3; ++axis)
        numbers += fmt::format("{}{}", numbers.empty() ? "" : " ", column(axis, row) + 0.0);
    return numbers;
  }

  void writeMarkup() {
    const VoxelBox& box = content_.box;
    const Vec3d h = content_.voxelSize(), origin = content_.worldOf({0, 0, 0});
    const std::string extent = fmt::format("{} {} {} {} {} {}", box.low[0], box.high[0], box.low[1],
                                           box.high[1], box.low[2], box.high[2]);
    text(fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
                     "byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n"
                     "  <ImageData WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\" "
                     "Direction=\"{}\">\n    <Piece Extent=\"{}\">\n      <PointData{}=\"{}\">\n",
                     content_.compress ? " compressor=\"vtkZLibDataCompressor\"" : "", extent,
                     origin[0], origin[1], origin[2], h[0], h[1], h[2], direction(), extent,
                     content_.grids.front()->components() == 1 ? " Scalars" : " Vectors",
                     xmlAttributeText(content_.names.front())));
    for (std::size_t i = 0; i < content_.grids.size(); ++i) {
      const DenseGrid& grid = *content_.grids[i];
      text(fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                       "format=\"appended\" offset=\"",
                       namesOf(grid.element()).vtk, xmlAttributeText(content_.names[i]),
                       grid.components()));
      offsets_.push_back(file_.size());
      text(std::string(20, '0') + "\"/>\n");
    }
    text("      </PointData>\n    </Piece>\n  </ImageData>\n"
         "  <AppendedData encoding=\"raw\">\n   _");
  }

  const ArrayContent& content_;
  AtomicFile file_;
  ArrayStream stream_;
  std::vector<std::uint64_t> offsets_; ///< where in the file the arrays' offsets are
};

} // namespace

void writeVti(const ArrayContent& content, Progress& progress) {
  VtiFile(content, progress).write();
}

} // namespace tetvdb
