// SPDX-License-Identifier: Apache-2.0
//
// Format: "VTK XML Formats", ImageData. Values of points are those of voxels; values of cells lie
// half a voxel further.
#include "tetvdb/io/formats/vtk/VtuLayout.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/VtkElement.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

namespace tetvdb {
namespace {

using namespace vtk;

std::optional<ElementType> elementNamed(std::string_view name) {
  const auto type = xmlNumber(name);
  return type ? elementOf(*type) : std::nullopt;
}

// Points or cells of a piece or of the whole image.
struct Block {
  std::array<std::int64_t, 3> first{};
  std::array<std::uint64_t, 3> size{};

  std::uint64_t count() const { return size[0] * size[1] * size[2]; }
};

class VtiInput : VtuLayout {
public:
  VtiInput(const Source& source, const ArraySink& sink, Progress& progress)
      : VtuLayout(source), source_(source), sink_(sink), progress_(progress) {
    if (dataset() != Dataset::Image)
      fail(source.path, "is no VTK image");
  }

  void read() {
    const pugi::xml_node image = root().child("ImageData");
    setPlace(image);
    pieces_ = pieces();
    readSection("PointData", false);
    readSection("CellData", true);
  }

private:
  std::vector<double> numbers(pugi::xml_node node, const char* name, std::size_t count) const {
    const std::string_view text = node.attribute(name).value();
    std::vector<double> all;
    if (text.empty())
      return all;
    NumberParser in(text, source_.path);
    for (std::size_t i = 0; i < count; ++i)
      all.push_back(in.real());
    return all;
  }

  void setPlace(pugi::xml_node image) {
    const std::vector<double> origin = numbers(image, "Origin", 3),
                              spacing = numbers(image, "Spacing", 3),
                              direction = numbers(image, "Direction", 9);
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k)
        transform_[4 * row + k] =
            (direction.empty() ? (row == k ? 1 : 0) : direction[3 * row + k]) *
            (spacing.empty() ? 1 : spacing[k]);
      transform_[4 * row + 3] = origin.empty() ? 0 : origin[row];
    }
  }

  Block blockOf(pugi::xml_node piece, bool isCells) const {
    Block block;
    const BlockSize points = blockSize(piece, &block.first);
    for (std::size_t k = 0; k < 3; ++k)
      // An image of one layer has one layer of cells.
      block.size[k] = isCells && points[k] > 1 ? points[k] - 1 : points[k];
    product(product(block.size[0], block.size[1]), block.size[2]);
    return block;
  }

  void readSection(const char* section, bool isCells) {
    for (const pugi::xml_node node : pieces_.front().child(section).children("DataArray")) {
      const std::string name = node.attribute("Name").value();
      const std::string_view type = node.attribute("type").value();
      const auto element = elementNamed(type);
      if (!element) {
        sink_.leftOut(name, std::string(type) + " array");
        continue;
      }
      StoredArray array;
      array.name = name.empty() ? "unnamed" : name;
      array.element = *element;
      array.components = components(node, 1);
      array.separate = array.components != 3;
      array.transform = transform_;
      array.placed = true;
      if (isCells)
        for (std::size_t row = 0; row < 3; ++row)
          for (std::size_t k = 0; k < 3; ++k)
            array.transform[4 * row + 3] += transform_[4 * row + k] / 2;
      if (pieces_.size() == 1)
        readWhole(section, isCells, node, array);
      else
        readPieces(section, isCells, name, array);
    }
  }

  void take(const Block& block, StoredArray& array) const {
    array.size = block.size;
    for (std::size_t k = 0; k < 3; ++k)
      array.low[k] = static_cast<std::int32_t>(
          std::clamp<std::int64_t>(block.first[k], INT32_MIN / 2, INT32_MAX / 2));
    array.setSteps(kXFastest);
  }

  Array read(pugi::xml_node node, std::uint64_t voxels, std::uint64_t components) {
    bool isLonger = false;
    return readArray(*this, source_, node, product(voxels, components), isLonger, progress_);
  }

  void readWhole(const char* section, bool isCells, pugi::xml_node node, StoredArray& array) {
    const Block block = blockOf(pieces_.front(), isCells);
    take(block, array);
    if (block.count() == 0)
      return sink_.leftOut(std::string(section) + " '" + array.name + "'", "an empty array");
    const Array found = read(node, block.count(), array.components);
    array.bytes = {found.data, found.count * bytesOf(array.element)};
    array.swap = found.swap;
    sink_.array(array);
  }

  // Pieces overlap in the points that they share.
  void readPieces(const char* section, bool isCells, const std::string& name, StoredArray& array) {
    std::vector<Block> blocks;
    Block whole;
    std::uint64_t voxels = 0;
    for (const pugi::xml_node piece : pieces_) {
      const Block block = blockOf(piece, isCells);
      if (block.count() == 0) {
        blocks.push_back(block);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t end = block.first[k] + static_cast<std::int64_t>(block.size[k]);
        const std::int64_t low =
            voxels == 0 ? block.first[k] : std::min(whole.first[k], block.first[k]);
        const std::int64_t high =
            voxels == 0 ? end
                        : std::max(whole.first[k] + static_cast<std::int64_t>(whole.size[k]), end);
        whole.first[k] = low;
        whole.size[k] = static_cast<std::uint64_t>(high - low);
      }
      voxels += block.count();
      blocks.push_back(block);
    }
    if (voxels == 0)
      return sink_.leftOut(array.name, "an empty array");
    const std::size_t element = bytesOf(array.element) * array.components;
    if (requireBytes(source_.path, UINT64_MAX / 2, 1, whole.size) > voxels)
      fail(source_.path, "its pieces do not fill its extent");
    take(whole, array);
    std::string bytes(static_cast<std::size_t>(whole.count()) * element, '\0');
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      if (blocks[p].count() == 0)
        continue;
      beginPiece(p);
      const pugi::xml_node node =
          pieces_[p].child(section).find_child_by_attribute("DataArray", "Name", name.c_str());
      if (!node || elementNamed(node.attribute("type").value()) != array.element ||
          components(node, 1) != array.components)
        fail(where(), "has no array '" + name + "' like that of the first piece");
      const Array found = read(node, blocks[p].count(), array.components);
      array.swap = found.swap;
      const Block& block = blocks[p];
      const std::size_t row = static_cast<std::size_t>(block.size[0]) * element;
      for (std::uint64_t z = 0; z < block.size[2]; ++z)
        for (std::uint64_t y = 0; y < block.size[1]; ++y) {
          const auto at = [&](std::size_t k, std::uint64_t i) {
            return static_cast<std::uint64_t>(block.first[k] - whole.first[k]) + i;
          };
          const std::uint64_t to = (at(2, z) * whole.size[1] + at(1, y)) * whole.size[0] + at(0, 0);
          std::memcpy(bytes.data() + to * element, found.data + (z * block.size[1] + y) * row, row);
        }
    }
    array.bytes = bytes;
    sink_.array(array);
  }

  const Source& source_;
  const ArraySink& sink_;
  Progress& progress_;
  ArrayTransform transform_ = kIdentity;
  std::vector<pugi::xml_node> pieces_;
};

} // namespace

void readVti(const Source& source, const ArraySink& sink, Progress& progress) {
  VtiInput(source, sink, progress).read();
}

} // namespace tetvdb
