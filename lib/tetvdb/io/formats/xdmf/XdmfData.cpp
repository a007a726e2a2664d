// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/XdmfData.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstring>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxDimensions = 8;

/// NumberType (version 2 also DataType) and Precision; none if unknown.
std::optional<vtk::Number> numberType(pugi::xml_node item) {
  std::string_view type = item.attribute("NumberType").value();
  if (type.empty())
    type = item.attribute("DataType").value();
  const std::string_view digits = item.attribute("Precision").value();
  const int precision = digits == "1" ? 1 : digits == "2" ? 2 : digits == "8" ? 8 : 4;
  if (!digits.empty() && precision == 4 && digits != "4")
    return {};
  using vtk::Number;
  if (type.empty() || sameWord(type, "Float"))
    return precision == 8   ? std::optional(Number::Float64)
           : precision == 4 ? std::optional(Number::Float32)
                            : std::nullopt;
  if (sameWord(type, "Char"))
    return Number::Int8;
  if (sameWord(type, "UChar"))
    return Number::UInt8;
  if (sameWord(type, "Short"))
    return Number::Int16;
  if (sameWord(type, "UShort"))
    return Number::UInt16;
  if (sameWord(type, "Int"))
    return precision == 1   ? Number::Int8
           : precision == 2 ? Number::Int16
           : precision == 4 ? Number::Int32
                            : Number::Int64;
  if (sameWord(type, "UInt"))
    return precision == 1   ? Number::UInt8
           : precision == 2 ? Number::UInt16
           : precision == 4 ? Number::UInt32
                            : Number::UInt64;
  return {};
}

bool isHdf(std::string_view format) {
  return sameWord(format, "HDF") || sameWord(format, "HDF5") || sameWord(format, "H5");
}

} // namespace

void XdmfData::fail(pugi::xml_node item, const std::string& what, const char* advice) const {
  throw Error(Status::Invalid, markup_.where(item), what, advice);
}

std::vector<std::uint64_t> XdmfData::wholeNumbers(pugi::xml_node item,
                                                  const std::string& text) const {
  NumberParser in(text, markup_.where(item));
  std::vector<std::uint64_t> numbers;
  while (!in.atEnd()) {
    const std::int64_t number = in.integer();
    if (number < 0 || numbers.size() > 3 * kMaxDimensions)
      fail(item, "'" + text.substr(0, 40) + "' are no dimensions");
    numbers.push_back(static_cast<std::uint64_t>(number));
  }
  return numbers;
}

std::vector<std::uint64_t> XdmfData::dimensions(pugi::xml_node item) const {
  return wholeNumbers(item, item.attribute("Dimensions").value());
}

std::size_t XdmfData::product(pugi::xml_node item,
                              const std::vector<std::uint64_t>& factors) const {
  std::uint64_t all = 1;
  for (const std::uint64_t factor : factors) {
    if (factor != 0 && all > (std::uint64_t(1) << 60) / factor)
      fail(item, "its dimensions are too large");
    all *= factor;
  }
  return all;
}

// Start, stride and count of each dimension: three rows of numbers in the XML.
Slab XdmfData::slabOf(pugi::xml_node item, std::size_t rank) const {
  const std::vector<std::uint64_t> numbers = wholeNumbers(item, std::string(trimmedText(item)));
  if (numbers.size() != 3 * rank)
    fail(item, "a hyperslab of " + std::to_string(rank) + " dimensions needs " +
                   std::to_string(3 * rank) + " numbers: starts, strides, counts");
  const auto row = [&](std::size_t r) {
    const auto from = numbers.begin() + static_cast<std::ptrdiff_t>(r * rank);
    return std::vector<std::uint64_t>(from, from + static_cast<std::ptrdiff_t>(rank));
  };
  return {row(0), row(1), row(2)};
}

XdmfData::Item XdmfData::resolve(pugi::xml_node asked) const {
  Item result;
  pugi::xml_node item = markup_.resolved(asked);
  if (std::string_view(item.name()) != "DataItem")
    fail(item, "is no <DataItem>");
  std::string_view kind = item.attribute("ItemType").value();
  if (kind.empty())
    kind = item.attribute("Type").value();
  if (sameWord(kind, "HyperSlab")) {
    const std::vector<pugi::xml_node> parts = markup_.children(item, "DataItem");
    if (parts.size() != 2)
      fail(item, "a hyperslab needs two data items, its numbers and its source");
    const pugi::xml_node whole = parts[1];
    const std::string_view inner = whole.attribute("ItemType").value();
    if (!inner.empty() && !sameWord(inner, "Uniform"))
      fail(whole, "a hyperslab of an item of type '" + std::string(inner) + "' is not read");
    result.extent = dimensions(whole);
    if (result.extent.empty() || result.extent.size() > kMaxDimensions)
      fail(whole, "a hyperslab's source needs dimensions, at most eight");
    result.slab = slabOf(parts[0], result.extent.size());
    result.sliced = true;
    for (std::size_t k = 0; k < result.extent.size(); ++k)
      if (result.slab.stride[k] == 0 || result.slab.count[k] == 0 ||
          result.slab.start[k] >= result.extent[k] ||
          result.slab.count[k] - 1 >
              (result.extent[k] - 1 - result.slab.start[k]) / result.slab.stride[k])
        fail(parts[0], "the hyperslab lies outside its source");
    result.numbers = product(item, result.slab.count);
    result.declared = true;
    product(whole, result.extent);
    result.node = whole;
    return result;
  }
  if (!kind.empty() && !sameWord(kind, "Uniform"))
    fail(item, "the item type '" + std::string(kind) + "' is not read",
         "export the arrays themselves rather than functions of them");
  const std::vector<std::uint64_t> sizes = dimensions(item);
  result.declared = !sizes.empty();
  result.numbers = product(item, sizes);
  result.node = item;
  return result;
}

Hdf5Dataset XdmfData::datasetOf(pugi::xml_node item) const {
  const std::string text(trimmedText(item));
  const std::size_t colon = datasetColon(text);
  if (colon == 0 || colon == std::string::npos || colon + 1 == text.size())
    fail(item, "'" + text.substr(0, 80) + "' names no dataset, as file.h5:/path does");
  Hdf5Dataset dataset;
  dataset.file = pathWithin(source_.path, text.substr(0, colon));
  dataset.path = text.substr(colon + 1);
  if (dataset.path.front() != '/') // FEniCS's checkpoints
    dataset.path.insert(dataset.path.begin(), '/');
  return dataset;
}

std::size_t XdmfData::fileBytes(pugi::xml_node item) const {
  const pugi::xml_node node = resolve(item).node;
  const std::string_view format = node.attribute("Format").value();
  if (isHdf(format))
    return std::filesystem::file_size(datasetOf(node).file);
  if (sameWord(format, "Binary"))
    return std::filesystem::file_size(pathWithin(source_.path, std::string(trimmedText(node))));
  return 0;
}

void XdmfData::need(pugi::xml_node asked) {
  if (const auto known = items_.find(asked.hash_value()); known != items_.end()) {
    ++known->second.uses;
    return;
  }
  Item item = resolve(asked);
  const std::string_view format = item.node.attribute("Format").value();
  if (isHdf(format)) {
    Hdf5Dataset dataset = datasetOf(item.node);
    dataset.sliced = item.sliced;
    dataset.slab = item.slab;
    dataset.min = item.declared ? item.numbers : 0;
    datasets_.push_back(std::move(dataset));
    item.dataset = datasets_.size();
  } else if (!format.empty() && !sameWord(format, "XML") && !sameWord(format, "Binary")) {
    fail(item.node, "the format '" + std::string(format) + "' is not read",
         "write XML, Binary or HDF");
  }
  items_[asked.hash_value()] = std::move(item);
}

void XdmfData::load() {
  loaded_ = readHdf5(datasets_, source_.path, report_, progress_);
}

Attribute::Values XdmfData::take(pugi::xml_node asked) {
  Item& item = items_.at(asked.hash_value());
  Attribute::Values values;
  if (item.dataset > 0) {
    Attribute::Values& loaded = loaded_.at(item.dataset - 1);
    values = --item.uses > 0 ? loaded : std::move(loaded);
  } else {
    const bool binary = sameWord(item.node.attribute("Format").value(), "Binary");
    values = binary ? fromBinary(item) : fromText(item);
    if (item.sliced)
      values = sliced(item, std::move(values));
  }
  // Removes numbers beyond the declared size.
  if (item.declared)
    std::visit([&](auto& numbers) { numbers.resize(item.numbers); }, values);
  return values;
}

Attribute::Values XdmfData::fromText(const Item& item) {
  const auto type = numberType(item.node);
  if (!type)
    fail(item.node, "its type of numbers is not known");
  const std::string_view text = item.node.text().get();
  NumberParser in(text, markup_.where(item.node));
  std::size_t numbers = item.sliced ? product(item.node, item.extent) : item.numbers;
  if (!item.declared) {
    numbers = 0;
    for (; !in.atEnd(); ++numbers)
      in.word();
    in.seek(0);
  }
  vtk::Array array = vtk::parseText(in, *type, numbers, progress_);
  array.where = markup_.where(item.node);
  return vtk::toAttribute("", Attribute::On::Points, 1, array).values;
}

Attribute::Values XdmfData::fromBinary(const Item& item) {
  const pugi::xml_node node = item.node;
  const auto type = numberType(node);
  if (!type)
    fail(node, "its type of numbers is not known");
  const std::string_view compression = node.attribute("Compression").value();
  if (!compression.empty() && !sameWord(compression, "Raw"))
    fail(node, "binary data compressed by '" + std::string(compression) + "' are not read",
         "write them uncompressed or into HDF5");
  const std::string_view endian = node.attribute("Endian").value();
  if (!endian.empty() && !sameWord(endian, "Native") && !sameWord(endian, "Big") &&
      !sameWord(endian, "Little"))
    fail(node, "Endian is none of Native, Big and Little");
  if (!item.declared)
    fail(node, "binary data need Dimensions");
  const std::string path = pathWithin(source_.path, std::string(trimmedText(node)));
  auto& file = files_[path];
  if (!file)
    file = std::make_unique<MappedFile>(path);
  const std::vector<std::uint64_t> seek = wholeNumbers(node, node.attribute("Seek").value());
  const std::uint64_t begin = seek.empty() ? 0 : seek.front();
  const std::size_t numbers = item.sliced ? product(node, item.extent) : item.numbers;
  const std::uint64_t bytes = vtk::bytesFor(*type, numbers);
  if (begin > file->bytes().size() || bytes > file->bytes().size() - begin)
    fail(node, std::to_string(numbers) + " numbers are declared, more than '" + path + "' holds",
         kCut);
  vtk::Array array;
  array.type = *type;
  array.swap = sameWord(endian, "Big"); // of little-endian machines
  array.data = file->bytes().data() + begin;
  array.count = numbers;
  array.where = path + " at byte " + std::to_string(begin);
  return vtk::toAttribute("", Attribute::On::Points, 1, array).values;
}

Attribute::Values XdmfData::sliced(const Item& item, Attribute::Values&& whole) const {
  return std::visit(
      [&](const auto& from) -> Attribute::Values {
        std::decay_t<decltype(from)> out;
        out.reserve(item.numbers);
        const std::size_t rank = item.extent.size();
        std::vector<std::uint64_t> at(rank, 0);
        for (std::size_t n = 0; n < item.numbers; ++n) {
          std::uint64_t place = 0;
          for (std::size_t k = 0; k < rank; ++k)
            place = place * item.extent[k] + item.slab.start[k] + at[k] * item.slab.stride[k];
          out.push_back(from[place]);
          for (std::size_t k = rank; k-- > 0 && ++at[k] == item.slab.count[k];)
            at[k] = 0;
        }
        return out;
      },
      whole);
}

} // namespace tetvdb
