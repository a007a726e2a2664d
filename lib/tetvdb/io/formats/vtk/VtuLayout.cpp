// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuLayout.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <string_view>

namespace tetvdb::vtk {
namespace {

// By Dataset: the type of <VTKFile>, which is also the name of its element.
constexpr const char* kDatasets[] = {"UnstructuredGrid", "PolyData", "StructuredGrid",
                                     "RectilinearGrid", "ImageData"};

// VTK's extents are of type int.
constexpr std::int64_t kMaxExtent = std::int64_t(1) << 31;

} // namespace

VtuLayout::VtuLayout(const Source& source) : source_(source), markup_(source) {
  readEncoding();
}

void VtuLayout::fail(const std::string& where, const std::string& what, const char* advice) const {
  throw Error(Status::Invalid, where, what, advice);
}

std::string VtuLayout::where() const {
  return piece_ == 0 ? source_.path : source_.path + ", piece " + std::to_string(piece_);
}

std::vector<pugi::xml_node> VtuLayout::pieces() const {
  const auto all = root().child(kDatasets[std::size_t(dataset_)]).children("Piece");
  if (all.begin() == all.end())
    fail(source_.path, "the file has no <Piece>", "export it again");
  return {all.begin(), all.end()};
}

void VtuLayout::readEncoding() {
  const pugi::xml_node root = markup_.root();
  const std::string_view type = root.attribute("type").value();
  const auto* known = std::find(std::begin(kDatasets), std::end(kDatasets), type);
  if (known == std::end(kDatasets))
    fail(source_.path,
         "holds " + std::string(type.empty() ? "no type" : type) +
             ", not an UnstructuredGrid, StructuredGrid, RectilinearGrid or PolyData",
         "save the mesh as an unstructured grid");
  dataset_ = Dataset(known - std::begin(kDatasets));
  const std::string_view compressor = root.attribute("compressor").value();
  if (compressor == "vtkZLibDataCompressor")
    encoding_.compressor = Compressor::Zlib;
  else if (compressor == "vtkLZ4DataCompressor")
    encoding_.compressor = Compressor::Lz4;
  else if (compressor == "vtkLZMADataCompressor")
    encoding_.compressor = Compressor::Lzma;
  else if (!compressor.empty())
    fail(source_.path, "is compressed by '" + std::string(compressor) + "', which is not known",
         "save it with zlib, lz4, lzma or without compression");
  const std::string_view header = root.attribute("header_type").value();
  if (!header.empty() && header != "UInt32" && header != "UInt64")
    fail(source_.path, "header_type is neither UInt32 nor UInt64");
  encoding_.wideHeader = header == "UInt64";
  const std::string_view order = root.attribute("byte_order").value();
  if (!order.empty() && order != "LittleEndian" && order != "BigEndian")
    fail(source_.path, "byte_order is neither LittleEndian nor BigEndian");
  encoding_.swap = order == "BigEndian"; // of little-endian machines
}

std::size_t VtuLayout::count(pugi::xml_node node, const char* name) const {
  const std::string_view text = node.attribute(name).value();
  NumberParser in(text, where());
  std::int64_t n = -1;
  if (!in.tryInteger(n) || n < 0 || !in.atEnd())
    fail(where(), std::string(name) + " is not a count");
  return static_cast<std::size_t>(n);
}

BlockSize VtuLayout::blockSize(pugi::xml_node piece,
                               std::array<std::int64_t, 3>* firstPoint) const {
  const std::string_view text = piece.attribute("Extent").value();
  NumberParser in(text, where());
  BlockSize size{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::int64_t first = 0, last = 0;
    if (!in.tryInteger(first) || !in.tryInteger(last) || std::abs(first) > kMaxExtent ||
        std::abs(last) > kMaxExtent)
      fail(where(), "Extent is not six numbers of points");
    if (last < first)
      return {};
    size[k] = static_cast<std::size_t>(last - first + 1);
    if (firstPoint != nullptr)
      (*firstPoint)[k] = first;
  }
  return size;
}

std::uint32_t VtuLayout::components(pugi::xml_node node, std::uint32_t missing) const {
  if (!node.attribute("NumberOfComponents"))
    return missing;
  const std::size_t n = count(node, "NumberOfComponents");
  if (n > 1u << 16)
    fail(where(), "an array has " + std::to_string(n) + " components");
  return std::max<std::uint32_t>(1, static_cast<std::uint32_t>(n)); // some writers put 0
}

std::size_t VtuLayout::product(std::size_t a, std::size_t b) const {
  if (b != 0 && a > std::numeric_limits<std::size_t>::max() / 16 / b)
    fail(where(), "more numbers are declared than the file holds",
         "the file is damaged or cut off; export it again");
  return a * b;
}

pugi::xml_node VtuLayout::needed(pugi::xml_node cells, const char* name) const {
  const pugi::xml_node node = named(cells, name);
  if (!node)
    fail(where(), "<" + std::string(dataset_ == Dataset::Poly ? "Polys" : "Cells") +
                      "> has no array '" + name + "'");
  return node;
}

ArrayPlace VtuLayout::locate(pugi::xml_node node, std::size_t numbers) const {
  const std::string name = node.attribute("Name").value();
  const std::string_view typeName = node.attribute("type").value();
  const auto type = xmlNumber(typeName);
  if (!type)
    fail(where(), "the array '" + name + "' has the unknown type '" + std::string(typeName) + "'");
  std::string_view format = node.attribute("format").value();
  if (format.empty())
    format = node.attribute("Format").value();

  ArrayPlace place;
  place.type = *type;
  Excerpt& from = place.from;
  if (format == "appended") {
    const std::size_t offset = count(node, "offset");
    from = markup_.appended();
    if (offset > from.bytes.size() || (numbers > 0 && offset == from.bytes.size()))
      fail(where(), "the array '" + name + "' begins beyond the appended data",
           "the file is damaged or cut off; export it again");
    from.begin += offset;
    from.bytes.remove_prefix(offset);
  } else {
    from = markup_.text(node);
    place.isText = format == "ascii" || format.empty();
    if (!place.isText && format != "binary")
      fail(where(),
           "the array '" + name + "' has the unknown format '" + std::string(format) + "'");
  }
  place.base64 = format != "appended" || !markup_.appendedIsRaw();
  return place;
}

Array readArray(const VtuLayout& layout, const Source& source, pugi::xml_node node,
                std::size_t numbers, bool& isLonger, Progress& progress) {
  const ArrayPlace place = layout.locate(node, numbers);
  const std::size_t begin = place.from.begin;
  if (place.isText) {
    NumberParser in(source.bytes.substr(0, begin + place.from.bytes.size()), source.path, 0, begin);
    Array out = parseText(in, place.type, numbers, progress);
    isLonger = !in.atEnd();
    in.seek(begin);
    out.where = in.where();
    return out;
  }
  const std::uint64_t min = bytesFor(place.type, numbers);
  Decoded decoded = decode(place.from, place.base64, layout.encoding(), min, source.path, progress);
  isLonger = decoded.size > min;
  Array out;
  out.type = place.type;
  out.swap = layout.encoding().swap;
  out.data = decoded.data;
  out.count = numbers;
  out.owned = std::move(decoded.owned);
  out.where = source.path + " at byte " + std::to_string(begin);
  return out;
}

} // namespace tetvdb::vtk
