// SPDX-License-Identifier: Apache-2.0
//
// Format: "Definition of NRRD File Format", NRRD0001 to NRRD0005: lines of a header, an empty line,
// the numbers; in a .nhdr file the numbers are in a file beside it.
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/HeaderInput.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace tetvdb {
namespace {

struct NrrdType {
  std::string_view name;
  ElementType element;
};
constexpr NrrdType kNrrdTypes[] = {{"signed char", ElementType::Int8},
                                   {"int8", ElementType::Int8},
                                   {"int8_t", ElementType::Int8},
                                   {"uchar", ElementType::UInt8},
                                   {"unsigned char", ElementType::UInt8},
                                   {"uint8", ElementType::UInt8},
                                   {"uint8_t", ElementType::UInt8},
                                   {"short", ElementType::Int16},
                                   {"short int", ElementType::Int16},
                                   {"signed short", ElementType::Int16},
                                   {"signed short int", ElementType::Int16},
                                   {"int16", ElementType::Int16},
                                   {"int16_t", ElementType::Int16},
                                   {"ushort", ElementType::UInt16},
                                   {"unsigned short", ElementType::UInt16},
                                   {"unsigned short int", ElementType::UInt16},
                                   {"uint16", ElementType::UInt16},
                                   {"uint16_t", ElementType::UInt16},
                                   {"int", ElementType::Int32},
                                   {"signed int", ElementType::Int32},
                                   {"int32", ElementType::Int32},
                                   {"int32_t", ElementType::Int32},
                                   {"uint", ElementType::UInt32},
                                   {"unsigned int", ElementType::UInt32},
                                   {"uint32", ElementType::UInt32},
                                   {"uint32_t", ElementType::UInt32},
                                   {"longlong", ElementType::Int64},
                                   {"long long", ElementType::Int64},
                                   {"long long int", ElementType::Int64},
                                   {"signed long long", ElementType::Int64},
                                   {"signed long long int", ElementType::Int64},
                                   {"int64", ElementType::Int64},
                                   {"int64_t", ElementType::Int64},
                                   {"ulonglong", ElementType::UInt64},
                                   {"unsigned long long", ElementType::UInt64},
                                   {"unsigned long long int", ElementType::UInt64},
                                   {"uint64", ElementType::UInt64},
                                   {"uint64_t", ElementType::UInt64},
                                   {"float", ElementType::Float32},
                                   {"double", ElementType::Float64}};

class NrrdInput : HeaderInput {
public:
  explicit NrrdInput(const Source& source) : HeaderInput(source) { readHeader(); }

  void read(const ArraySink& sink, Progress& progress) {
    setShape();
    setPlace();
    if (const std::string* name = find({"data file", "datafile"})) {
      if (name->find('%') != name->npos || lowerCase(name->substr(0, 4)) == "list")
        fail("its numbers are in several files, which are not joined", "save it as one .nrrd file");
      useFile(*name);
    }
    if (const std::string* order = find({"endian"}))
      array_.swap = lowerCase(*order) == "big";
    if (const std::string* lines = find({"line skip", "lineskip"}))
      skipLines(*lines);
    const std::string* skip = find({"byte skip", "byteskip"});
    pass(encoding(), skip == nullptr ? 0 : NumberParser(*skip, source_.path).integer(), sink,
         progress);
  }

private:
  void readHeader() {
    NumberParser in(source_);
    in.line(); // the magic
    while (in.remaining() > 0) {
      const std::string_view line = in.line();
      if (trimmed(line).empty()) {
        data_ = source_.bytes.substr(in.position());
        return;
      }
      const std::size_t colon = line.find(':');
      if (line[0] == '#' || colon == line.npos)
        continue;
      const bool isKey = line.substr(colon, 2) == ":=";
      const std::string value(trimmed(line.substr(colon + (isKey ? 2 : 1))));
      // Keys of key:=value have ':' before them.
      fields_[isKey ? ":" + std::string(line.substr(0, colon)) : lowerCase(line.substr(0, colon))] =
          value;
    }
    if (find({"data file", "datafile"}) == nullptr)
      fail("the header does not end", kCut);
  }

  std::vector<std::uint64_t> sizes() const {
    NumberParser in(needed("sizes"), source_.path);
    std::vector<std::uint64_t> sizes;
    std::int64_t size = 0;
    while (in.tryInteger(size) && size > 0 && sizes.size() < 16)
      sizes.push_back(static_cast<std::uint64_t>(size));
    NumberParser dimension(needed("dimension"), source_.path);
    if (dimension.integer() != static_cast<std::int64_t>(sizes.size()))
      fail("'sizes' are not as many numbers as 'dimension' says");
    return sizes;
  }

  // The vectors of a field like "none (1,0,0) (0,1,0) (0,0,1)".
  std::vector<std::optional<Vec3d>> vectors(const std::string& text) const {
    std::vector<std::optional<Vec3d>> all;
    std::string rest;
    for (const char c : text)
      rest += c == '(' || c == ')' || c == ',' ? ' ' : c;
    NumberParser in(rest, source_.path);
    while (!in.atEnd() && all.size() < 16) {
      Vec3d vector{};
      if (!in.tryReal(vector[0])) {
        in.word(); // "none"
        all.emplace_back();
        continue;
      }
      vector[1] = in.real();
      vector[2] = in.real();
      all.emplace_back(vector);
    }
    return all;
  }

  // The axis of components among four: that without a direction in space, else a short one.
  std::size_t componentAxis(const std::vector<std::uint64_t>& sizes) const {
    if (const std::string* text = find({"space directions"}))
      if (const auto all = vectors(*text); all.size() == 4)
        for (std::size_t i = 0; i < 4; ++i)
          if (!all[i])
            return i;
    if (const std::string* text = find({"kinds"})) {
      NumberParser in(*text, source_.path);
      for (std::size_t i = 0; i < 4; ++i) {
        const std::string kind = lowerCase(in.word());
        if (kind != "domain" && kind != "space" && kind != "none" && kind != "???")
          return i;
      }
    }
    return sizes[0] <= kMostFastComponents || sizes[3] > kMostSlowComponents ? 0 : 3;
  }

  void setShape() {
    const std::string type = lowerCase(needed("type"));
    const auto* known = std::find_if(std::begin(kNrrdTypes), std::end(kNrrdTypes),
                                     [&](const NrrdType& t) { return t.name == type; });
    if (known == std::end(kNrrdTypes))
      fail("numbers of type '" + type + "' are not read", "convert them to float");
    array_.element = known->element;
    std::vector<std::uint64_t> all = sizes();
    while (all.size() < 3)
      all.push_back(1);
    if (all.size() > 4)
      fail("has " + std::to_string(all.size()) + " axes, not three", "save one volume of it");
    const std::size_t component = all.size() == 4 ? componentAxis(all) : 4;
    std::uint64_t step = 1;
    for (std::size_t i = 0, k = 0; i < all.size(); step *= all[i], ++i) {
      if (i == component) {
        array_.components = all[i];
        array_.componentStep = step;
        array_.separate = i == 3;
        continue;
      }
      axes_[k] = i;
      array_.size[k] = all[i];
      array_.step[k++] = step;
    }
  }

  void setPlace() {
    array_.placed = true;
    ArrayTransform& m = array_.transform;
    if (const std::string* text = find({"space directions"})) {
      const auto all = vectors(*text);
      for (std::size_t k = 0; k < 3; ++k)
        if (axes_[k] < all.size() && all[axes_[k]])
          for (std::size_t row = 0; row < 3; ++row)
            m[4 * row + k] = (*all[axes_[k]])[row];
    } else if (const std::string* spacings = find({"spacings"})) {
      NumberParser in(*spacings, source_.path);
      std::vector<double> all;
      while (!in.atEnd() && all.size() < 16)
        all.push_back(in.value());
      for (std::size_t k = 0; k < 3; ++k)
        if (axes_[k] < all.size() && std::isfinite(all[axes_[k]]) && all[axes_[k]] != 0)
          m[5 * k] = all[axes_[k]];
    } else {
      array_.placed = false;
    }
    Vec3d first{0, 0, 0};
    if (const std::string* text = find({"space origin"}))
      if (const auto all = vectors(*text); !all.empty() && all[0])
        first = *all[0];
    if (const std::string* text = find({":voxel_origin"})) { // of this program
      NumberParser in(*text, source_.path);
      for (std::int32_t& low : array_.low)
        low = static_cast<std::int32_t>(
            std::clamp<std::int64_t>(in.integer(), INT32_MIN / 2, INT32_MAX / 2));
      if (const std::string* name = find({"content"}))
        array_.name = *name;
    }
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t k = 0; k < 3; ++k)
        first[row] -= m[4 * row + k] * array_.low[k];
    if (const std::string* text = find({":world_origin"})) { // the same without rounding
      NumberParser in(*text, source_.path);
      for (double& number : first)
        number = in.real();
    }
    for (std::size_t row = 0; row < 3; ++row)
      m[4 * row + 3] = first[row];
  }

  Encoding encoding() const {
    const std::string name = lowerCase(needed("encoding"));
    if (name == "raw")
      return Encoding::Raw;
    if (name == "gzip" || name == "gz")
      return Encoding::Packed;
    if (name == "text" || name == "txt" || name == "ascii")
      return Encoding::Text;
    fail("its encoding '" + name + "' is not read", "save it as raw or gzip");
  }

  void skipLines(const std::string& text) {
    NumberParser in(data_, source_.path);
    for (std::int64_t n = NumberParser(text, source_.path).integer(); n > 0 && in.remaining() > 0;
         --n)
      in.line();
    data_ = data_.substr(in.position());
  }

  std::array<std::size_t, 3> axes_{}; ///< of the file that are x, y and z
};

} // namespace

void readNrrd(const Source& source, const ArraySink& sink, Progress& progress) {
  NrrdInput(source).read(sink, progress);
}

} // namespace tetvdb
