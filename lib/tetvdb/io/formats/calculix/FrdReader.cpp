// SPDX-License-Identifier: Apache-2.0
//
// The format: G. Dhondt, K. Wittig, "CALCULIX GraphiX", appendix "Result Format". Columns are
// fixed, so that numbers may touch each other.
#include "tetvdb/io/formats/calculix/FrdReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/TimeStep.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// In quadratic cells, the midpoints of vertical edges precede those above.
constexpr std::uint8_t kHexahedronOrder[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,
                                             10, 11, 16, 17, 18, 19, 12, 13, 14, 15};
constexpr std::uint8_t kWedgeOrder[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 13, 14, 9, 10, 11};

/// Element types 1 to 12.
const CellKind* kindOf(std::int64_t type) {
  static const CellKind kinds[] = {
      {"he8", CellType::Hexahedron, 8, 8},
      {"pe6", CellType::Wedge, 6, 6},
      {"te4", CellType::Tetra, 4, 4},
      {"he20", CellType::Hexahedron, 8, 20, keptNodes(CellType::Hexahedron, 20), kHexahedronOrder},
      {"pe15", CellType::Wedge, 6, 15, keptNodes(CellType::Wedge, 15), kWedgeOrder},
      {"te10", CellType::Tetra, 4, 10, keptNodes(CellType::Tetra, 10)},
      {"tr3", CellType::Flat, 0, 3},
      {"tr6", CellType::Flat, 0, 6},
      {"qu4", CellType::Flat, 0, 4},
      {"qu8", CellType::Flat, 0, 8},
      {"be2", CellType::Flat, 0, 2},
      {"be3", CellType::Flat, 0, 3}};
  return type >= 1 && type <= 12 ? &kinds[type - 1] : nullptr;
}

/// Corners of the polygon of an element of types 7 to 10; 0 for others.
std::uint32_t polygonCorners(std::int64_t type) {
  return type == 7 || type == 8 ? 3 : type == 9 || type == 10 ? 4 : 0;
}

/// The representation of the numbers of a block.
enum class Form : std::uint8_t { ShortText, LongText, Floats, Doubles };

/// A block of values at nodes: its header and the position of its numbers.
struct Result {
  double value = 0;
  std::int64_t step = 0;
  std::string name;
  std::uint32_t components = 0;
  std::uint64_t nodes = 0;
  Form form = Form::LongText;
};

/// A block of values, its step and the position of its numbers.
struct Block {
  Result result;
  std::size_t step = 0, at = 0, line = 0;
};

class FrdFile {
public:
  FrdFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress) {}

  /// The values of all steps, without reading arrays.
  std::vector<double> times() {
    scan([&](const Result& result) { skipValues(result); });
    return times_;
  }

  /// Reads the file up to the first solid cell.
  bool hasSolidCells() {
    kindsAlone_ = true;
    scan([&](const Result& result) { skipValues(result); });
    return isSolid_;
  }

  CellMesh read() {
    // The steps are known at the end of the file: values are read afterwards.
    std::vector<Block> blocks;
    keepMesh_ = true;
    scan([&](const Result& result) {
      blocks.push_back({result, times_.size() - 1, at_, line_});
      skipValues(result);
    });
    mesh_.times = times_;
    const auto wanted = chosenStep(times_.size(), options_.timeStep, source_.path);
    for (const Block& block : blocks)
      if (block.step == wanted && options_.attributes) {
        at_ = block.at;
        line_ = block.line;
        readValues(block.result);
      }
    if (mesh_.points.empty())
      fail("the file has no nodes", kCut);
    if (!anyMaterial_)
      mesh_.regions.clear();
    return std::move(mesh_);
  }

private:
  // --- lines ---

  [[noreturn]] void fail(const std::string& what, const char* advice) const {
    throw Error(Status::Invalid,
                isBinary_ ? source_.path + " at byte " + std::to_string(at_)
                          : source_.path + ":" + std::to_string(line_),
                what, advice);
  }
  /// False at the end.
  bool nextLine(std::string_view& line) {
    if (at_ >= source_.bytes.size())
      return false;
    const std::size_t end = std::min(source_.bytes.find('\n', at_), source_.bytes.size());
    line = source_.bytes.substr(at_, end - at_);
    at_ = std::min(end + 1, source_.bytes.size());
    ++line_;
    if (!line.empty() && line.back() == '\r')
      line.remove_suffix(1);
    if (line_ % 65536 == 0) {
      progress_.update(static_cast<double>(at_) / static_cast<double>(source_.bytes.size()));
      source_.release();
    }
    return true;
  }
  std::string_view neededLine(const char* what) {
    std::string_view line;
    if (!nextLine(line))
      fail(std::string("the file ends within ") + what, kCut);
    return line;
  }
  static std::string_view field(std::string_view line, std::size_t begin, std::size_t width) {
    return begin >= line.size() ? std::string_view() : trimmed(line.substr(begin, width));
  }
  std::int64_t integer(std::string_view text, const char* what) const {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size())
      fail(std::string("expected ") + what + ", found '" + printable(text) + "'", kCut);
    return number;
  }
  double real(std::string_view text, const char* what) const {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc() && end == text.data() + text.size())
      return number;
    NumberParser in(text, source_.path); // 1.5-103, and numbers beyond a double's range
    if (!in.tryReal(number) || !in.atEnd())
      fail(std::string("expected ") + what + ", found '" + printable(text) + "'", kCut);
    return number;
  }
  static std::string printable(std::string_view text) {
    std::string out(text.substr(0, 40));
    for (char& c : out)
      if (c < 0x20 || c > 0x7e)
        c = '?';
    return out;
  }

  // --- blocks ---

  template <class UseResult>
  void scan(UseResult use) {
    std::string_view line;
    while (!isSolid_ && nextLine(line)) {
      const std::string_view key = field(line, 0, 6);
      if (key.empty() && trimmed(line).empty())
        continue;
      if (key == "9999")
        return;
      if (key == "2C")
        readNodes(line);
      else if (key == "3C")
        readElements(line);
      else if (key == "100C")
        use(readHeader(line));
      else if (key.substr(0, 1) == "1")
        readTitle(line);
      else
        fail("unknown record '" + printable(trimmed(line)) + "'", kExport);
    }
  }

  /// Text that defines names: "    1UMAT    1STEEL".
  void readTitle(std::string_view line) {
    if (line.substr(0, 9) != "    1UMAT" || !keepMesh_)
      return;
    std::int32_t number = 0;
    const std::string_view digits = field(line, 9, 5), name = field(line, 14, 80);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc() && end == digits.data() + digits.size() && !name.empty())
      mesh_.regionNames[number] = std::string(name);
  }

  Form formOf(std::string_view text) const {
    const std::int64_t form = text.empty() ? 1 : integer(text, "a format from 0 to 3");
    if (form < 0 || form > 3)
      fail("format " + std::to_string(form) + " is not known; 0 to 3 are", kExport);
    return static_cast<Form>(form);
  }
  std::uint64_t count(std::string_view text, std::size_t bytesEach) const {
    const std::int64_t n = integer(text, "a count");
    if (n < 0 || static_cast<std::uint64_t>(n) > (source_.bytes.size() - at_) / bytesEach)
      fail(std::to_string(n) + " elements are declared, more than the file holds", kCut);
    return static_cast<std::uint64_t>(n);
  }
  /// The next `bytes` bytes of a binary block.
  const char* take(std::size_t bytes) {
    if (bytes > source_.bytes.size() - at_)
      fail("the file ends within a binary block", kCut);
    const char* from = source_.bytes.data() + at_;
    at_ += bytes;
    return from;
  }
  /// Whether a text block continues with a record of this key: -1 or -2. -3 ends it.
  bool isRecord(std::string_view line, const char* key) const { return line.substr(0, 3) == key; }
  static std::size_t idWidth(Form form) { return form == Form::ShortText ? 5 : 10; }
  static bool isText(Form form) { return form <= Form::LongText; }

  void readNodes(std::string_view head) {
    const Form form = formOf(field(head, 73, 1));
    const std::size_t each = isText(form) ? 8 : form == Form::Doubles ? 28 : 16;
    const std::uint64_t n = count(field(head, 24, 12), each);
    checkPointCount(n, source_.path);
    if (keepMesh_ && seenNodes_)
      fail("a second block of nodes", kExport);
    seenNodes_ = true;
    isBinary_ = !isText(form);
    if (keepMesh_)
      mesh_.points.reserve(n);
    for (std::uint64_t i = 0; isBinary_ && i < n; ++i) {
      const char* at = take(each);
      Vec3d p{};
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = form == Form::Doubles ? loadNumber<double>(at + 4 + 8 * k, false)
                                     : double(loadNumber<float>(at + 4 + 4 * k, false));
      addPoint(loadNumber<std::int32_t>(at, false), p);
    }
    isBinary_ = false;
    if (!isText(form))
      return;
    const std::size_t width = idWidth(form);
    std::uint64_t seen = 0;
    for (std::string_view line = neededLine("the nodes"); !isRecord(line, " -3");
         line = neededLine("the nodes")) {
      if (!isRecord(line, " -1"))
        fail("expected the next node", kCut);
      ++seen;
      if (!keepMesh_)
        continue;
      Vec3d p{};
      for (std::size_t k = 0; k < 3; ++k)
        p[k] = real(field(line, 3 + width + 12 * k, 12), "a coordinate");
      addPoint(integer(field(line, 3, width), "a node's number"), p);
    }
    warnOfCount("nodes", n, seen);
  }
  void addPoint(std::int64_t id, const Vec3d& p) {
    if (!keepMesh_)
      return;
    if (!isFinite(p))
      fail("a coordinate of node " + std::to_string(id) + " is not finite", kExport);
    ids_.add(id);
    mesh_.points.push_back(p);
  }

  /// CalculiX declares too few if it expands shells and beams; a text block has its own end
  /// mark.
  void warnOfCount(const char* things, std::uint64_t declared, std::uint64_t seen) const {
    if (keepMesh_ && declared != seen)
      report_.warn("wrong-count", std::to_string(declared) + " " + things +
                                      " are declared, but there are " + std::to_string(seen));
  }

  // --- elements ---

  struct Element {
    std::int64_t id = 0, type = 0, material = 0;
    std::vector<std::int64_t> nodes;
  };

  void readElements(std::string_view head) {
    const Form form = formOf(field(head, 73, 1));
    const std::uint64_t n = count(field(head, 24, 12), isText(form) ? 8 : 24);
    if (keepMesh_) {
      if (!seenNodes_)
        fail("elements stand before the nodes", kExport);
      if (!seenElements_)
        finishIds();
    }
    seenElements_ = true;
    Element element;
    isBinary_ = !isText(form);
    for (std::uint64_t i = 0; isBinary_ && i < n; ++i) {
      const char* at = take(16);
      element.id = loadNumber<std::int32_t>(at, false);
      element.type = loadNumber<std::int32_t>(at + 4, false);
      element.material = loadNumber<std::int32_t>(at + 12, false);
      element.nodes.resize(checkedKind(element).nodes);
      if (isSolid_)
        return;
      at = take(4 * element.nodes.size());
      for (std::size_t k = 0; k < element.nodes.size(); ++k)
        element.nodes[k] = loadNumber<std::int32_t>(at + 4 * k, false);
      addElement(element);
      if (i % 65536 == 0)
        progress_.check();
    }
    isBinary_ = false;
    if (isText(form))
      readTextElements(n, form);
  }
  void finishIds() {
    ids_.finish();
    if (ids_.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(ids_.duplicates()) +
                                        " nodes have a number that a later one has too");
  }
  /// A material's number; names, which older files contain instead, are numbered from 1 in order.
  std::int64_t materialOf(std::string_view text) {
    if (text.empty() || text.find_first_not_of("+-0123456789") == text.npos)
      return text.empty() ? 0 : integer(text, "a material's number");
    if (!keepMesh_)
      return 0;
    const auto [named, isNew] =
        materials_.emplace(text, static_cast<std::int32_t>(materials_.size() + 1));
    if (isNew)
      mesh_.regionNames[named->second] = named->first;
    return named->second;
  }
  void readTextElements(std::uint64_t n, Form form) {
    const std::size_t width = idWidth(form), perLine = form == Form::ShortText ? 15 : 10;
    std::uint64_t seen = 0;
    Element element;
    for (std::string_view line = neededLine("the elements"); !isRecord(line, " -3");
         line = neededLine("the elements")) {
      if (!isRecord(line, " -1"))
        fail("expected the next element", kCut);
      ++seen;
      element.id = integer(field(line, 3, width), "an element's number");
      element.type = integer(field(line, 3 + width, 5), "an element's type");
      const std::string_view material = field(line, 3 + width + 10, 5);
      element.material = materialOf(material);
      element.nodes.resize(checkedKind(element).nodes);
      if (isSolid_)
        return;
      for (std::size_t i = 0; i < element.nodes.size(); ++i) {
        if (i % perLine == 0)
          line = neededLine("an element");
        if (!isRecord(line, " -2"))
          fail("expected the nodes of element " + std::to_string(element.id), kCut);
        if (keepMesh_)
          element.nodes[i] =
              integer(field(line, 3 + width * (i % perLine), width), "a node's number");
      }
      addElement(element);
    }
    warnOfCount("elements", n, seen);
  }
  const CellKind& checkedKind(const Element& element) {
    const CellKind* kind = kindOf(element.type);
    if (kind == nullptr)
      fail("element " + std::to_string(element.id) + " has the type " +
               std::to_string(element.type) + "; types are 1 to 12",
           kExport);
    isSolid_ = kindsAlone_ && kind->type != CellType::Flat;
    return *kind;
  }
  void addElement(const Element& element) {
    if (!keepMesh_)
      return;
    CellKind kind = *kindOf(element.type);
    if (options_.faces)
      kind.kept = std::max(kind.kept, polygonCorners(element.type));
    for (std::uint32_t i = 0; i < kind.nodes; ++i) {
      const std::uint32_t node = ids_.find(element.nodes[i]);
      if (node == IdMap::kNone)
        fail("element " + std::to_string(element.id) + " refers to node " +
                 std::to_string(element.nodes[i]) + ", which does not exist",
             kExport);
      if (i < kind.stored())
        mesh_.nodes.push_back(node);
    }
    if (kind.type != CellType::Flat)
      orderLast(mesh_, kind);
    appendCells(mesh_, kind);
    const bool fits = element.material == static_cast<std::int32_t>(element.material);
    mesh_.regions.push_back(fits ? static_cast<std::int32_t>(element.material) : 0);
    anyMaterial_ = anyMaterial_ || mesh_.regions.back() != 0;
  }

  // --- values at nodes ---

  Result readHeader(std::string_view head) {
    Result result;
    result.value = real(field(head, 12, 12), "the value of a step");
    result.step = integer(field(head, 58, 5), "the number of a step");
    result.form = formOf(field(head, 73, 2));
    std::string_view line = neededLine("the header of an array");
    if (!isRecord(line, " -4"))
      fail("expected the name of an array", kCut);
    result.name = std::string(field(line, 5, 8));
    const std::int64_t declared = integer(field(line, 13, 5), "a number of components");
    if (declared < 0 || declared > 1000)
      fail("an array has " + std::to_string(declared) + " components", kExport);
    for (std::int64_t i = 0; i < declared; ++i) {
      line = neededLine("the header of an array");
      if (!isRecord(line, " -5"))
        fail("expected the name of a component", kCut);
      const std::string_view computed = field(line, 33, 5); // to be computed by readers
      result.components += computed.empty() || computed == "0" ? 1 : 0;
    }
    const std::size_t number = result.form == Form::Doubles ? 8 : 4;
    result.nodes =
        count(field(head, 24, 12), isText(result.form) ? 4 : 4 + number * result.components);
    if (times_.empty() || result.step != lastStep_ || result.value != times_.back())
      times_.push_back(result.value);
    lastStep_ = result.step;
    return result;
  }

  void skipValues(const Result& result) {
    if (!isText(result.form)) {
      isBinary_ = true;
      const std::size_t number = result.form == Form::Doubles ? 8 : 4;
      take(result.nodes * (4 + number * result.components));
      isBinary_ = false;
      return;
    }
    while (!isRecord(neededLine("an array"), " -3")) {
    }
  }

  void readValues(const Result& result) {
    const bool known =
        std::any_of(mesh_.attributes.begin(), mesh_.attributes.end(),
                    [&](const Attribute& array) { return array.name == result.name; });
    if (known)
      report_.warn("array-left-out",
                   "a second array '" + result.name + "' of one step is left out");
    const bool wanted = !known && result.components > 0 && options_.wants(result.name);
    if (!wanted) {
      if (!known && result.components > 0)
        mesh_.unread.push_back({result.name, Attribute::On::Points, result.components});
      return skipValues(result);
    }
    if (!seenElements_)
      fail("values stand before the elements", kExport);
    if (static_cast<double>(mesh_.points.size()) * result.components >
        static_cast<double>(source_.bytes.size()) * 16)
      fail("an array has more numbers than the file can hold", kCut);
    if (result.form == Form::Floats)
      readNumbers<float>(result);
    else
      readNumbers<double>(result);
  }

  template <class T>
  void readNumbers(const Result& result) {
    const std::size_t width = result.components;
    std::vector<T> values((mesh_.points.size() + 1) * width, std::numeric_limits<T>::quiet_NaN());
    strangers_ = 0;
    if (isText(result.form))
      readTextNumbers(result, values);
    isBinary_ = !isText(result.form);
    for (std::uint64_t i = 0; isBinary_ && i < result.nodes; ++i) {
      const char* at = take(4 + sizeof(T) * width);
      T* to = values.data() + placeOf(loadNumber<std::int32_t>(at, false)) * width;
      for (std::size_t k = 0; k < width; ++k)
        to[k] = loadNumber<T>(at + 4 + sizeof(T) * k, false);
    }
    isBinary_ = false;
    values.resize(mesh_.points.size() * width);
    if (strangers_ > 0)
      report_.warn("unknown-ids", "the array '" + result.name + "' has values for " +
                                      std::to_string(strangers_) +
                                      " nodes that the mesh does not have");
    mesh_.attributes.push_back(
        {result.name, Attribute::On::Points, result.components, std::move(values)});
  }
  template <class T>
  void readTextNumbers(const Result& result, std::vector<T>& values) {
    const std::size_t width = idWidth(result.form), components = result.components;
    std::size_t place = 0, next = components;
    for (std::string_view line = neededLine("an array"); !isRecord(line, " -3");
         line = neededLine("an array")) {
      if (isRecord(line, " -1") && next == components) {
        place = placeOf(integer(field(line, 3, width), "a node's number"));
        next = 0;
      } else if (!isRecord(line, " -2") || next == components) {
        fail("expected the values of a node", kCut);
      }
      for (std::size_t k = 0; k < 6 && next < components; ++k, ++next)
        values[place * components + next] =
            static_cast<T>(real(field(line, 3 + width + 12 * k, 12), "a value"));
    }
    if (next != components)
      fail("the last node of '" + result.name + "' has too few values", kCut);
  }
  /// The index of a node's values; those of nodes that are not in the mesh, which CalculiX also
  /// writes, follow the others.
  std::size_t placeOf(std::int64_t id) {
    const std::uint32_t node = ids_.find(id);
    if (node != IdMap::kNone)
      return node;
    ++strangers_;
    return mesh_.points.size();
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  std::size_t at_ = 0, line_ = 0;
  bool isBinary_ = false; ///< the cursor is in a binary block
  bool keepMesh_ = false;
  bool kindsAlone_ = false, isSolid_ = false; ///< of hasSolidCells()
  bool seenNodes_ = false, seenElements_ = false, anyMaterial_ = false;
  std::vector<double> times_; ///< of the steps so far
  std::int64_t lastStep_ = 0;
  std::map<std::string, std::int32_t> materials_; ///< by names that elements have
  std::uint64_t strangers_ = 0; ///< values of an array for nodes that are not in the mesh
  IdMap ids_;
  CellMesh mesh_;
};

} // namespace

CellMesh readFrd(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return FrdFile(source, options, report, progress).read();
}

bool frdHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return FrdFile(source, {}, report, progress).hasSolidCells();
}

std::vector<double> frdTimes(const Source& source, Report& report, Progress& progress) {
  return FrdFile(source, {}, report, progress).times();
}

} // namespace tetvdb
