// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

/// A keyword; longer words are not keywords.
std::string lower(std::string_view word) {
  return lowerCase(word.substr(0, 64));
}

// Names contain %20 for a space, and so on.
std::string percentDecoded(std::string_view name) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '%' && i + 2 < name.size() && digit(name[i + 1]) >= 0 &&
        digit(name[i + 2]) >= 0) {
      out += static_cast<char>(digit(name[i + 1]) * 16 + digit(name[i + 2]));
      i += 2;
    } else {
      out += name[i];
    }
  }
  return out;
}

class VtkFile {
public:
  VtkFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), in_(source) {}

  CellMesh read() {
    readHeader();
    while (!in_.atEnd()) {
      const std::string keyword = lower(in_.word());
      if (!readGeometry(keyword) && !readData(keyword))
        fail("unknown keyword '" + readable(keyword) + "'", kExport);
      source_.release();
      progress_.update(static_cast<double>(in_.position()) /
                       static_cast<double>(source_.bytes.size()));
    }
    if (!seenPoints_)
      fail("the file ends without POINTS", kCut);
    if (isPoly_)
      return finishPolygons();
    if (!seenCells_ || !seenTypes_)
      fail(seenCells_ ? "the file ends without CELL_TYPES" : "the file ends without CELLS", kCut);
    checkElements(Attribute::On::Points, mesh_.points.size());
    checkElements(Attribute::On::Cells, cells_.types.size());
    if (cells_.ends.size() != cells_.types.size())
      fail(std::to_string(cells_.ends.size()) + " cells, but " +
               std::to_string(cells_.types.size()) + " cell types",
           kExport);
    cells_.facesInConnectivity = true;
    appendCells(std::move(cells_), mesh_, progress_, options_.faces);
    return std::move(mesh_);
  }

private:
  std::string where() const {
    return binary_ ? source_.path + " at byte " + std::to_string(in_.position()) : in_.where();
  }
  [[noreturn]] void fail(const std::string& what, const char* advice) const {
    throw Error(Status::Invalid, where(), what, advice);
  }
  static std::string readable(std::string_view word) {
    std::string out(word.substr(0, 40));
    for (char& c : out)
      if (c < 0x20 || c > 0x7e)
        c = '?';
    return out;
  }

  void readHeader() {
    const std::string first = lower(in_.line());
    const std::size_t version = first.find("version");
    if (first.find("vtk datafile") == first.npos)
      fail("does not begin with '# vtk DataFile Version'", kExport);
    if (version != first.npos && first.find_first_of("0123456789", version) == first.npos)
      fail("has no file version", kExport);
    in_.line(); // the title
    const std::string mode = lower(in_.word());
    if (mode != "ascii" && mode != "binary")
      fail("the third line is neither ASCII nor BINARY", kExport);
    if (lower(in_.word()) != "dataset")
      fail("DATASET is missing", kExport);
    const std::string_view dataset = in_.word();
    isPoly_ = lower(dataset) == "polydata";
    if (lower(dataset) != "unstructured_grid" && !isPoly_)
      fail("holds a DATASET " + readable(dataset) + ", not an UNSTRUCTURED_GRID or POLYDATA",
           "save the mesh as an unstructured grid");
    binary_ = mode == "binary";
  }

  // --- pieces of the syntax ---

  std::size_t count() {
    std::int64_t n = 0;
    if (!in_.tryInteger(n) || n < 0)
      fail("expected a count, found '" + readable(in_.peekWord()) + "'", kCut);
    return static_cast<std::size_t>(n);
  }
  std::size_t product(std::size_t a, std::size_t b) const {
    if (b != 0 && a > std::numeric_limits<std::size_t>::max() / 16 / b)
      fail("more numbers are declared than the file holds", kCut);
    return a * b;
  }
  std::string name() {
    in_.skipSpace();
    const std::string_view rest = source_.bytes.substr(in_.position());
    if (!rest.empty() && rest[0] == '"') {
      const std::size_t end = rest.substr(0, 1000).find_first_of("\"\n\r", 1);
      if (end != rest.npos && rest[end] == '"') {
        in_.seek(in_.position() + end + 1);
        return percentDecoded(rest.substr(1, end - 1));
      }
    }
    return percentDecoded(in_.word());
  }
  Number type() {
    const std::string_view word = in_.word();
    const auto found = legacyNumber(word);
    if (!found)
      fail("unknown number type '" + readable(word) + "'", kExport);
    return *found;
  }
  /// Whether the next word is `keyword` (lower case), which is then consumed. Reads no more than
  /// that many bytes, since binary data may follow.
  bool next(std::string_view keyword) {
    const std::size_t before = in_.position();
    in_.skipSpace();
    const std::string_view rest = source_.bytes.substr(in_.position());
    if (lower(rest.substr(0, keyword.size())) == keyword &&
        (rest.size() == keyword.size() || isBlank(rest[keyword.size()]))) {
      in_.seek(in_.position() + keyword.size());
      return true;
    }
    in_.seek(before);
    return false;
  }
  /// Binary data begin on the next line.
  void endLine() {
    if (binary_ && !trimmed(in_.line()).empty())
      fail("more words than expected before binary data", kCut);
  }

  /// The `n` numbers that follow the header line.
  Array numbers(Number type, std::size_t n) {
    if (!binary_) {
      const std::string start = in_.where();
      Array array = parseText(in_, type, n, progress_);
      array.where = start;
      return array;
    }
    Array array;
    array.where = where();
    const std::uint64_t bytes = bytesFor(type, n);
    if (bytes > in_.remaining())
      fail(std::to_string(n) + " numbers are declared, more than the file holds", kCut);
    array.type = type;
    array.swap = machineIsLittleEndian();
    array.data = source_.bytes.data() + in_.position();
    array.count = n;
    in_.seek(in_.position() + bytes);
    return array;
  }
  void skipNumbers(Number type, std::size_t n) {
    if (binary_) {
      numbers(type, n);
      return;
    }
    in_.checkCount(static_cast<std::int64_t>(std::min<std::size_t>(n, SIZE_MAX / 2)), "numbers");
    for (std::size_t i = 0; i < n; ++i) {
      if (i % 65536 == 0)
        progress_.check();
      if (in_.word().empty())
        in_.failNumber("a number");
    }
  }
  static bool machineIsLittleEndian() {
    const std::uint16_t one = 1;
    return *reinterpret_cast<const char*>(&one) == 1;
  }

  // --- points and cells ---

  bool readGeometry(const std::string& keyword) {
    if (isPoly_ && readPolygons(keyword))
      return true;
    if (keyword == "points")
      readPoints();
    else if (keyword == "cells")
      readCells();
    else if (keyword == "cell_types")
      readTypes();
    else if (keyword == "metadata")
      skipMetadata();
    else
      return false;
    return true;
  }

  void once(bool& seen, const char* what) {
    if (seen)
      fail(std::string("a second section ") + what, kExport);
    seen = true;
  }

  void readPoints() {
    once(seenPoints_, "POINTS");
    const std::size_t n = count();
    const Number as = type();
    endLine();
    mesh_.points = toPoints(numbers(as, product(n, 3)));
    if (n >= 0xffffffffu)
      throw Error(Status::Limit, source_.path, "more than 2^32 - 2 points", "split the mesh");
  }

  // Sections of polygonal data in VTK's order, and the types of their cells.
  bool readPolygons(const std::string& keyword) {
    static constexpr std::pair<std::string_view, std::uint8_t> kinds[] = {
        {"vertices", 2}, {"lines", 4}, {"polygons", 7}, {"triangle_strips", 6}};
    for (std::size_t i = 0; i < std::size(kinds); ++i) {
      if (keyword != kinds[i].first)
        continue;
      if (!polygons_[i].ends.empty())
        fail("a second section " + keyword, kExport);
      readConnectivity();
      cells_.types.assign(cells_.ends.size(), kinds[i].second);
      polygons_[i] = std::exchange(cells_, {});
      return true;
    }
    return false;
  }
  CellMesh finishPolygons() {
    std::size_t cells = 0;
    for (const Cells& some : polygons_)
      cells += some.ends.size();
    checkElements(Attribute::On::Points, mesh_.points.size());
    checkElements(Attribute::On::Cells, cells);
    for (Cells& some : polygons_)
      if (!some.ends.empty())
        appendCells(std::move(some), mesh_, progress_, options_.faces);
    return std::move(mesh_);
  }

  void readCells() {
    once(seenCells_, "CELLS");
    readConnectivity();
  }
  void readConnectivity() {
    const std::size_t n = count();
    const std::size_t size = count();
    endLine();
    if (next("offsets"))
      readOffsets(n, size);
    else
      readStream(n, size);
  }

  // Some writers do not include the node counts in the declared size: a text defines its own end.
  void readStream(std::size_t n, std::size_t size) {
    const Array array = numbers(binary_ ? Number::Int32 : Number::Int64, size);
    std::vector<std::uint32_t> stream = toIndices(array);
    if (!binary_) {
      for (std::int64_t more = 0; in_.tryInteger(more);)
        stream.push_back(more >= 0 && more < 0xffffffff ? static_cast<std::uint32_t>(more)
                                                        : 0xffffffffu);
      if (stream.size() > size)
        report_.warn("cells-size", "CELLS declares " + std::to_string(size) + " numbers, but has " +
                                       std::to_string(stream.size()));
    }
    unpack(n, std::move(stream), array.where);
  }

  // From version 5: an array of n offsets, the first of which is 0, and one of nodes.
  void readOffsets(std::size_t n, std::size_t size) {
    const Number offsetType = type();
    endLine();
    const Array offsets = numbers(offsetType, n);
    cells_.ends = toOffsets(offsets);
    if (!next("connectivity"))
      fail("CONNECTIVITY is missing", kCut);
    const Number nodeType = type();
    endLine();
    const Array nodes = numbers(nodeType, size);
    cells_.where = nodes.where;
    cells_.connectivity = toIndices(nodes);
    if (cells_.ends.empty() ? size != 0 : cells_.ends.front() != 0 || cells_.ends.back() != size)
      throw Error(Status::Invalid, offsets.where,
                  "OFFSETS do not go from 0 to the length of CONNECTIVITY", kExport);
    if (!cells_.ends.empty())
      cells_.ends.erase(cells_.ends.begin());
  }

  // Up to version 4: for each cell its node count and its nodes. Packed in place.
  void unpack(std::size_t n, std::vector<std::uint32_t> stream, const std::string& start) {
    cells_.where = start;
    if (n > stream.size())
      throw Error(Status::Invalid, start,
                  std::to_string(n) + " cells do not fit into " + std::to_string(stream.size()) +
                      " numbers",
                  kCut);
    cells_.ends.resize(n);
    std::size_t from = 0, to = 0;
    for (std::size_t cell = 0; cell < n; ++cell) {
      const std::size_t left = stream.size() - from;
      if (left == 0 || stream[from] >= left)
        throw Error(Status::Invalid, start,
                    "cell " + std::to_string(cell) + " ends beyond the section CELLS, which has " +
                        std::to_string(stream.size()) + " numbers",
                    kCut);
      const std::uint32_t nodes = stream[from++];
      for (std::uint32_t i = 0; i < nodes; ++i)
        stream[to++] = stream[from++];
      cells_.ends[cell] = to;
    }
    if (from != stream.size())
      throw Error(Status::Invalid, start,
                  "CELLS declares " + std::to_string(stream.size()) + " numbers, but its " +
                      std::to_string(n) + " cells have " + std::to_string(from),
                  kExport);
    stream.resize(to);
    cells_.connectivity = std::move(stream);
  }

  void readTypes() {
    once(seenTypes_, "CELL_TYPES");
    const std::size_t n = count();
    endLine();
    if (isTypeOfAll(n)) {
      report_.warn("cell-types",
                   "CELL_TYPES names one type in place of a list; it is taken for the "
                   "type of all cells");
      cells_.types.assign(cells_.ends.size(), static_cast<std::uint8_t>(n));
      return;
    }
    cells_.types = toTypes(numbers(Number::Int32, n));
  }

  // Bullet's files end with "CELL_TYPES 10": the type of all cells. A file truncated there would
  // have as many types as cells.
  bool isTypeOfAll(std::size_t n) {
    if (binary_ || !seenCells_ || n > 255 || n == cells_.ends.size() || !in_.atEnd())
      return false;
    const CellProperties& kind = cellKind(static_cast<std::uint8_t>(n));
    return kind.nodes != 0 && cells_.connectivity.size() == kind.nodes * cells_.ends.size();
  }

  /// Lines up to an empty one.
  void skipMetadata() {
    in_.line();
    do
      if (in_.remaining() == 0)
        fail("the file ends within METADATA", kCut);
    while (!trimmed(in_.line()).empty());
  }

  // --- arrays ---

  bool readData(const std::string& keyword) {
    if (keyword == "point_data" || keyword == "cell_data") {
      inData_ = true;
      on_ = keyword == "point_data" ? Attribute::On::Points : Attribute::On::Cells;
      elements_ = count();
      (on_ == Attribute::On::Points ? pointElements_ : cellElements_) = elements_;
    } else if (keyword == "field") {
      readField();
    } else if (keyword == "lookup_table") {
      name();
      const std::size_t n = product(count(), 4);
      endLine();
      skipNumbers(binary_ ? Number::UInt8 : Number::Float32, n);
    } else if (keyword == "scalars") {
      readScalars();
    } else if (keyword == "color_scalars") {
      std::string label = name();
      const std::size_t width = count();
      endLine();
      readArray(std::move(label), width, elements_, binary_ ? Number::UInt8 : Number::Float32);
    } else if (keyword == "texture_coordinates") {
      std::string label = name();
      const std::size_t width = count();
      const Number as = type();
      endLine();
      readArray(std::move(label), width, elements_, as);
    } else if (const std::size_t width = widthOf(keyword); width > 0) {
      std::string label = name();
      const Number as = type();
      endLine();
      readArray(std::move(label), width, elements_, as);
    } else {
      return false;
    }
    return true;
  }

  static std::size_t widthOf(const std::string& keyword) {
    if (keyword == "vectors" || keyword == "normals")
      return 3;
    if (keyword == "tensors")
      return 9;
    if (keyword == "tensors6")
      return 6;
    return keyword == "global_ids" || keyword == "pedigree_ids" || keyword == "edge_flags" ? 1 : 0;
  }

  // SCALARS name type [components], on one line.
  void readScalars() {
    std::string label = name();
    const Number as = type();
    const std::string_view rest = in_.line();
    NumberParser words(rest, source_.path);
    std::int64_t width = 1;
    if (!words.atEnd() && (!words.tryInteger(width) || width < 1))
      fail("expected a number of components, found '" + readable(rest) + "'", kExport);
    if (next("lookup_table")) {
      name();
      endLine();
    }
    readArray(std::move(label), static_cast<std::size_t>(width), elements_, as);
  }

  void readField() {
    name();
    const std::size_t arrays = count();
    for (std::size_t i = 0; i < arrays; ++i) {
      std::string label = name();
      while (lower(label) == "metadata") {
        skipMetadata();
        label = name();
      }
      if (label.empty())
        fail("the file ends within FIELD", kCut);
      if (label == "NULL_ARRAY")
        continue;
      const std::size_t width = count();
      const std::size_t tuples = count();
      const std::string word = lower(in_.peekWord());
      if (word == "string" || word == "utf8_string" || word == "variant") {
        in_.word();
        in_.line();
        skipStrings(product(width, tuples), binary_ && word != "variant");
        continue;
      }
      const Number as = type();
      endLine();
      readArray(std::move(label), width, tuples, as);
    }
  }

  // One per line, or after its length: the highest two bits of the first byte are the number of
  // bytes of the length.
  void skipStrings(std::size_t n, bool binary) {
    for (std::size_t i = 0; i < n; ++i) {
      if (in_.remaining() == 0)
        fail("the file ends within strings", kCut);
      if (i % 65536 == 0)
        progress_.check();
      if (!binary) {
        in_.line();
        continue;
      }
      const char* at = source_.bytes.data() + in_.position();
      const unsigned first = static_cast<unsigned char>(*at);
      const std::size_t bytes = std::size_t(8) >> (first >> 6);
      std::uint64_t length = first & 0x3f;
      if (bytes <= in_.remaining())
        for (std::size_t k = 1; k < bytes; ++k)
          length = length << 8 | static_cast<unsigned char>(at[k]);
      if (bytes > in_.remaining() || length > in_.remaining() - bytes)
        fail("a string is longer than the file", kCut);
      in_.seek(in_.position() + bytes + length);
    }
  }

  void readArray(std::string label, std::size_t width, std::size_t tuples, Number as) {
    const std::size_t n = product(width, tuples);
    const bool wanted = inData_ && !(options_.faces && on_ == Attribute::On::Cells) && width > 0 &&
                        width <= 1u << 16 && tuples == elements_ &&
                        (options_.wants(label) || label == options_.regionArray ||
                         (on_ == Attribute::On::Cells && isInteger(as)));
    if (!wanted) {
      if (inData_ && tuples != elements_)
        report_.warn("array-of-other-length",
                     "the array '" + label + "' is left out: it has " + std::to_string(tuples) +
                         " elements in place of " + std::to_string(elements_));
      else if (inData_ && options_.attributes && width > 0 && width <= 1u << 16)
        mesh_.unread.push_back({std::move(label), on_, static_cast<std::uint32_t>(width)});
      return skipNumbers(as, n);
    }
    const Array array = numbers(as, n);
    mesh_.attributes.push_back(
        toAttribute(std::move(label), on_, static_cast<std::uint32_t>(width), array));
  }

  void checkElements(Attribute::On on, std::size_t elements) const {
    const auto& declared = on == Attribute::On::Points ? pointElements_ : cellElements_;
    if (declared && *declared != elements)
      throw Error(Status::Invalid, source_.path,
                  std::string(on == Attribute::On::Points ? "POINT_DATA" : "CELL_DATA") + " has " +
                      std::to_string(*declared) + " elements, the mesh " + std::to_string(elements),
                  kExport);
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  NumberParser in_;
  bool binary_ = false;
  bool isPoly_ = false;
  bool seenPoints_ = false, seenCells_ = false, seenTypes_ = false;
  CellMesh mesh_;
  Cells cells_;
  std::array<Cells, 4> polygons_; ///< of polygonal data
  // The section to which arrays belong; preceding field data are the dataset's.
  bool inData_ = false;
  Attribute::On on_ = Attribute::On::Points;
  std::size_t elements_ = 0;
  std::optional<std::size_t> pointElements_, cellElements_;
};

} // namespace

CellMesh readVtk(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return VtkFile(source, options, report, progress).read();
}

bool vtkHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const auto isSolid = [](std::int64_t type) {
    return type >= 0 && type < 256 &&
           cellKind(static_cast<std::uint8_t>(type)).type != CellType::Flat;
  };
  NumberParser in(source);
  in.line();
  in.line();
  const bool binary = lower(in.word()) == "binary";
  // The types follow the cells; arrays may follow.
  const std::size_t at = source.bytes.rfind("CELL_TYPES");
  if (at == source.bytes.npos) {
    ReadOptions options;
    options.attributes = false;
    options.faces = true;
    return hasSolidCells(readVtk(source, options, report, progress));
  }
  in.seek(at + std::string_view("CELL_TYPES").size());
  std::int64_t count = 0, type = 0;
  if (!in.tryInteger(count) || count < 0)
    throw Error(Status::Invalid, in.where(), "CELL_TYPES has no number of cells", kExport);
  in.line();
  if (binary) {
    ByteReader bytes(source);
    bytes.skip(in.position());
    bytes.setSwap(true);
    const std::size_t n = bytes.checkCount(count, 4, "types of cells");
    for (std::size_t i = 0; i < n; ++i)
      if (isSolid(bytes.get<std::int32_t>()))
        return true;
    return false;
  }
  for (std::int64_t i = 0; i < count; ++i)
    if (isSolid(type = in.integer()))
      return true;
  return false;
}

} // namespace tetvdb
