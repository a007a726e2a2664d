// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/ply/PlyHeader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::pair<std::string_view, PlyType> kTypes[] = {
    {"char", PlyType::Int8},      {"int8", PlyType::Int8},     {"uchar", PlyType::UInt8},
    {"uint8", PlyType::UInt8},    {"short", PlyType::Int16},   {"int16", PlyType::Int16},
    {"ushort", PlyType::UInt16},  {"uint16", PlyType::UInt16}, {"int", PlyType::Int32},
    {"int32", PlyType::Int32},    {"uint", PlyType::UInt32},   {"uint32", PlyType::UInt32},
    {"float", PlyType::Float},    {"float32", PlyType::Float}, {"double", PlyType::Double},
    {"float64", PlyType::Double},
};

class HeaderParser {
public:
  explicit HeaderParser(const Source& source) : source_(source) {}

  PlyHeader parse() {
    if (nextLine() != "ply")
      fail("it does not begin with 'ply'");
    bool hasFormat = false;
    for (;;) {
      if (at_ >= source_.bytes.size())
        fail("the header has no end_header", kCut);
      const std::string_view line = nextLine();
      NumberParser words(line, source_.path);
      const std::string_view keyword = words.word();
      if (keyword == "end_header")
        break;
      if (keyword == "format") {
        parseFormat(words.word());
        hasFormat = true;
      } else if (keyword == "element") {
        parseElement(words);
      } else if (keyword == "property") {
        parseProperty(words);
      } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        // Blender 2.47 wrote a comment without its keyword. Behind an element it could be a
        // property.
        if (!header_.elements.empty())
          fail("an unknown statement stands in the header");
        header_.unknown = line.substr(0, 80);
      }
    }
    if (!hasFormat)
      fail("the header has no format");
    header_.bodyBegin = at_;
    checkContent();
    return std::move(header_);
  }

private:
  /// Lines end with '\n', which a '\r' may precede in some of them, or all with '\r': then a '\n'
  /// behind it is data.
  std::string_view nextLine() {
    const std::string_view bytes = source_.bytes;
    if (lineEnd_ == 0) {
      const std::size_t first = std::min(bytes.find_first_of("\r\n"), bytes.size());
      const bool isReturn = bytes.substr(first, 1) == "\r" && bytes.substr(first, 2) != "\r\n";
      lineEnd_ = isReturn ? '\r' : '\n';
    }
    const std::size_t end = std::min(bytes.find(lineEnd_, at_), bytes.size());
    const std::string_view line = bytes.substr(at_, end - at_);
    at_ = std::min(end + 1, bytes.size());
    ++line_;
    return trimmed(line);
  }
  static std::string_view trimmed(std::string_view text) {
    while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ')
      text.remove_suffix(1);
    return text;
  }

  void parseFormat(std::string_view name) {
    if (name == "ascii")
      header_.format = PlyHeader::Format::Text;
    else if (name == "binary_little_endian")
      header_.format = PlyHeader::Format::LittleEndian;
    else if (name == "binary_big_endian")
      header_.format = PlyHeader::Format::BigEndian;
    else
      fail("the format is not ascii, binary_little_endian or binary_big_endian");
  }

  void parseElement(NumberParser& words) {
    PlyElement element;
    element.name = words.word();
    std::int64_t count = 0;
    if (!words.tryInteger(count) || count < 0)
      fail("an element has no valid count");
    element.count = static_cast<std::uint64_t>(count);
    header_.elements.push_back(std::move(element));
  }

  void parseProperty(NumberParser& words) {
    if (header_.elements.empty())
      fail("a property stands before the first element");
    PlyProperty property;
    std::string_view word = words.word();
    if (word == "list") {
      property.list = true;
      property.countType = parseType(words.word());
      word = words.word();
    }
    property.type = parseType(word);
    property.name = words.word();
    if (property.name.empty())
      fail("a property has no name");
    header_.elements.back().properties.push_back(std::move(property));
  }
  PlyType parseType(std::string_view name) {
    for (const auto& [known, type] : kTypes)
      if (known == name)
        return type;
    fail("a property is of no known type (float, int, uchar, ...)");
  }

  void checkContent() {
    const auto has = [](const PlyElement& element, std::string_view name, bool list) {
      return std::any_of(element.properties.begin(), element.properties.end(),
                         [&](const PlyProperty& p) { return p.list == list && p.name == name; });
    };
    bool points = false, faces = false;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex")
        points = points ||
                 (has(element, "x", false) && has(element, "y", false) && has(element, "z", false));
      if (element.name == "face" || element.name == "tristrips")
        faces = faces || has(element, "vertex_indices", true) || has(element, "vertex_index", true);
    }
    if (!points)
      throw Error(Status::Invalid, source_.path, "it has no vertices with x, y and z",
                  "export it again");
    if (!faces)
      throw Error(Status::Invalid, source_.path, "it holds points but no faces",
                  "points alone have no inside; export the mesh with its faces");
  }

  [[noreturn]] void fail(std::string_view what,
                         std::string_view advice = "the file is damaged; export it again") const {
    throw Error(Status::Invalid,
                source_.path + ":" + std::to_string(std::max<std::size_t>(line_, 1)), what, advice);
  }

  const Source& source_;
  PlyHeader header_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  char lineEnd_ = 0; ///< of all lines
};

} // namespace

PlyHeader parsePlyHeader(const Source& source) {
  return HeaderParser(source).parse();
}

} // namespace tetvdb
