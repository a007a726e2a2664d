// SPDX-License-Identifier: Apache-2.0
//
// What a VTK XML file says of its arrays: how they are encoded, and where each of them lies.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/cells/StructuredBlock.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtuData.h"
#include "tetvdb/io/formats/vtk/VtuMarkup.h"
#include "tetvdb/io/source/Source.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <vector>

namespace tetvdb::vtk {

/// The place of an array's numbers in a file.
struct ArrayPlace {
  Excerpt from;
  Number type = Number::Float64;
  bool isText = false;
  bool base64 = false; ///< otherwise raw, where it is no text
};

/// Methods throw Error(Invalid) for what the format does not allow.
class VtuLayout {
public:
  /// `source` must outlive it.
  explicit VtuLayout(const Source& source);

  pugi::xml_node root() const { return markup_.root(); }
  Dataset dataset() const { return dataset_; }
  const Encoding& encoding() const { return encoding_; }
  /// All <Piece>, at least one.
  std::vector<pugi::xml_node> pieces() const;
  void beginPiece(std::size_t piece) { piece_ = piece; }
  /// "file", with the piece begun last if there are several.
  std::string where() const;

  /// The attribute as a count.
  std::size_t count(pugi::xml_node node, const char* name) const;
  /// Points of a structured piece along the axes, by its Extent; (0, 0, 0) for an empty one.
  /// `first`, where it is not null, receives the first one's numbers.
  BlockSize blockSize(pugi::xml_node piece, std::array<std::int64_t, 3>* first = nullptr) const;
  /// NumberOfComponents, or `missing`.
  std::uint32_t components(pugi::xml_node node, std::uint32_t missing) const;
  /// a * b, as a number of numbers.
  std::size_t product(std::size_t a, std::size_t b) const;
  /// The <DataArray> of that name within <Cells>; empty if there is none.
  static pugi::xml_node named(pugi::xml_node cells, const char* name) {
    return cells.find_child_by_attribute("DataArray", "Name", name);
  }
  pugi::xml_node needed(pugi::xml_node cells, const char* name) const;
  /// Where the `numbers` numbers of a <DataArray> lie.
  ArrayPlace locate(pugi::xml_node node, std::size_t numbers) const;

  [[noreturn]] void fail(const std::string& where, const std::string& what,
                         const char* advice = "repair the file or export it again") const;

private:
  void readEncoding();

  const Source& source_;
  VtuMarkup markup_;
  Encoding encoding_;
  Dataset dataset_ = Dataset::Unstructured;
  std::size_t piece_ = 0;
};

/// The `numbers` numbers of a <DataArray>; `isLonger` tells whether there are more.
Array readArray(const VtuLayout& layout, const Source& source, pugi::xml_node node,
                std::size_t numbers, bool& isLonger, Progress& progress);

} // namespace tetvdb::vtk
