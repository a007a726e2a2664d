// SPDX-License-Identifier: Apache-2.0
//
// Format: "ITK/MetaIO/Documentation", MetaImage: lines "key = value", of which the last names the
// file of the numbers, or says that they follow. Rows of the matrix are directions of axes, as
// ITK's MetaImageIO writes them.
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/HeaderInput.h"

#include <algorithm>
#include <vector>

namespace tetvdb {
namespace {

struct MetaType {
  std::string_view name;
  ElementType element;
};
constexpr MetaType kMetaTypes[] = {
    {"MET_CHAR", ElementType::Int8},       {"MET_UCHAR", ElementType::UInt8},
    {"MET_SHORT", ElementType::Int16},     {"MET_USHORT", ElementType::UInt16},
    {"MET_INT", ElementType::Int32},       {"MET_UINT", ElementType::UInt32},
    {"MET_LONG", ElementType::Int32},      {"MET_ULONG", ElementType::UInt32},
    {"MET_LONG_LONG", ElementType::Int64}, {"MET_ULONG_LONG", ElementType::UInt64},
    {"MET_FLOAT", ElementType::Float32},   {"MET_DOUBLE", ElementType::Float64}};

class MetaInput : HeaderInput {
public:
  explicit MetaInput(const Source& source) : HeaderInput(source) { readHeader(); }

  void read(const ArraySink& sink, Progress& progress) {
    setShape();
    setPlace();
    const std::string& name = needed("ElementDataFile");
    if (lowerCase(name.substr(0, 4)) == "list" || name.find('%') != name.npos)
      fail("its numbers are in several files, which are not joined", "save it as one .mha file");
    if (lowerCase(name) != "local")
      useFile(name);
    const std::string* binary = find({"BinaryData"});
    const Encoding encoding = binary != nullptr && lowerCase(*binary) == "false" ? Encoding::Text
                              : isTrue({"CompressedData"})                       ? Encoding::Packed
                                                                                 : Encoding::Raw;
    const std::string* skip = find({"HeaderSize"});
    pass(encoding, skip == nullptr ? 0 : NumberParser(*skip, source_.path).integer(), sink,
         progress);
  }

private:
  void readHeader() {
    NumberParser in(source_);
    while (in.remaining() > 0) {
      const std::string_view line = in.line();
      const std::size_t equals = line.find('=');
      if (equals == line.npos)
        continue;
      const std::string key(trimmed(line.substr(0, equals)));
      fields_[key] = trimmed(line.substr(equals + 1));
      if (key == "ElementDataFile") {
        data_ = source_.bytes.substr(in.position());
        return;
      }
    }
    fail("the header ends without 'ElementDataFile'", kCut);
  }

  bool isTrue(std::initializer_list<const char*> names) const {
    const std::string* value = find(names);
    return value != nullptr && (lowerCase(*value) == "true" || *value == "1");
  }
  // The numbers of a field, as many as `count`; `missing` if there is no such field.
  std::vector<double> numbers(std::initializer_list<const char*> names, std::size_t count,
                              double missing) const {
    std::vector<double> all(count, missing);
    if (const std::string* text = find(names)) {
      NumberParser in(*text, source_.path);
      for (double& number : all)
        number = in.real();
    }
    return all;
  }

  void setShape() {
    const std::string& type = needed("ElementType");
    const auto* known = std::find_if(std::begin(kMetaTypes), std::end(kMetaTypes),
                                     [&](const MetaType& t) { return t.name == type; });
    if (known == std::end(kMetaTypes))
      fail("numbers of type '" + type + "' are not read", "convert them to MET_FLOAT");
    array_.element = known->element;
    const std::int64_t axes = NumberParser(needed("NDims"), source_.path).integer();
    if (axes < 2 || axes > 4)
      fail("has " + std::to_string(axes) + " axes, not three", "save one volume of it");
    axes_ = static_cast<std::size_t>(axes);
    NumberParser in(needed("DimSize"), source_.path);
    std::uint64_t frames = 1;
    array_.size = {1, 1, 1};
    for (std::size_t k = 0; k < axes_; ++k) {
      const std::int64_t size = in.integer();
      if (size < 1)
        fail("an axis has no voxels");
      (k < 3 ? array_.size[k] : frames) = static_cast<std::uint64_t>(size);
    }
    const double channels = numbers({"ElementNumberOfChannels"}, 1, 1)[0];
    if (!(channels >= 1 && channels <= 1000) || (channels > 1 && frames > 1))
      fail("has channels that are not read", "save one of them");
    array_.components = static_cast<std::uint64_t>(channels);
    array_.setSteps(kXFastest);
    if (frames > 1) {
      array_.components = frames;
      array_.componentStep = array_.size[0] * array_.size[1] * array_.size[2];
      array_.separate = true;
    }
    array_.swap = isTrue({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"});
  }

  void setPlace() {
    const std::vector<double> spacing = numbers({"ElementSpacing", "ElementSize"}, axes_, 1),
                              first = numbers({"Offset", "Position", "Origin"}, axes_, 0);
    std::vector<double> matrix(axes_ * axes_, 0);
    for (std::size_t k = 0; k < axes_; ++k)
      matrix[(axes_ + 1) * k] = 1;
    if (find({"TransformMatrix", "Rotation", "Orientation"}) != nullptr)
      matrix = numbers({"TransformMatrix", "Rotation", "Orientation"}, axes_ * axes_, 0);
    array_.placed = true;
    for (std::size_t row = 0; row < std::min<std::size_t>(axes_, 3); ++row) {
      for (std::size_t k = 0; k < std::min<std::size_t>(axes_, 3); ++k)
        array_.transform[4 * row + k] = matrix[axes_ * k + row] * spacing[k];
      array_.transform[4 * row + 3] = first[row];
    }
  }

  std::size_t axes_ = 3;
};

} // namespace

void readMetaImage(const Source& source, const ArraySink& sink, Progress& progress) {
  MetaInput(source).read(sink, progress);
}

} // namespace tetvdb
