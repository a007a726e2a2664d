// SPDX-License-Identifier: Apache-2.0
//
// Format: LM7 (libMeshb) documentation, "GMF: the Gamma Mesh Format".
#include "tetvdb/io/formats/medit/MeditReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/NodeOrder.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <limits>

namespace tetvdb {
namespace {

constexpr std::int32_t kDimension = 3, kVertices = 4, kPolyhedraCode = 46, kEnd = 54,
                       kPolyhedraHeaders = 207;

struct Keyword {
  std::int32_t code;     ///< in binary files
  std::string_view name; ///< in text files
  CellKind kind;
};

constexpr CellType kFlat = CellType::Flat;
constexpr Keyword kCellKeywords[] = {
    {5, "Edges", {"edge", kFlat, 0, 2}},
    {6, "Triangles", {"triangle", kFlat, 0, 3}},
    {7, "Quadrilaterals", {"quad", kFlat, 0, 4}},
    {8, "Tetrahedra", {"tetra", CellType::Tetra, 4, 4}},
    {9, "Prisms", {"wedge", CellType::Wedge, 6, 6}},
    {9, "Pentahedra", {"wedge", CellType::Wedge, 6, 6}}, // the older name of prisms
    {10, "Hexahedra", {"hexahedron", CellType::Hexahedron, 8, 8}},
    {24, "TrianglesP2", {"triangle6", kFlat, 0, 6}},
    {25, "EdgesP2", {"edge3", kFlat, 0, 3}},
    {27, "QuadrilateralsQ2", {"quad9", kFlat, 0, 9}},
    {30, "TetrahedraP2", {"tetra10", CellType::Tetra, 4, 10, 10}},
    {33, "HexahedraQ2", {"hexahedron27", CellType::Hexahedron, 8, 27}},
    {49, "Pyramids", {"pyramid", CellType::Pyramid, 5, 5}},
    {86, "PrismsP2", {"wedge18", CellType::Wedge, 6, 18}},
    {87, "PyramidsP2", {"pyramid14", CellType::Pyramid, 5, 14}},
    {88, "QuadrilateralsQ3", {"quad16", kFlat, 0, 16}},
    {89, "QuadrilateralsQ4", {"quad25", kFlat, 0, 25}},
    {90, "TrianglesP3", {"triangle10", kFlat, 0, 10}},
    {91, "TrianglesP4", {"triangle15", kFlat, 0, 15}},
    {92, "EdgesP3", {"edge4", kFlat, 0, 4}},
    {93, "EdgesP4", {"edge5", kFlat, 0, 5}},
    {96, "TetrahedraP3", {"tetra20", CellType::Tetra, 4, 20}},
    {97, "TetrahedraP4", {"tetra35", CellType::Tetra, 4, 35}},
    {98, "HexahedraQ3", {"hexahedron64", CellType::Hexahedron, 8, 64}},
    {99, "HexahedraQ4", {"hexahedron125", CellType::Hexahedron, 8, 125}},
    {100, "PyramidsP3", {"pyramid30", CellType::Pyramid, 5, 30}},
    {101, "PyramidsP4", {"pyramid55", CellType::Pyramid, 5, 55}},
    {102, "PrismsP3", {"wedge40", CellType::Wedge, 6, 40}},
    {103, "PrismsP4", {"wedge75", CellType::Wedge, 6, 75}},
    {200, "Prisms9", {"wedge9", CellType::Wedge, 6, 9}},
    {201, "Hexahedra12", {"hexahedron12", CellType::Hexahedron, 8, 12}},
};
constexpr CellKind kPolyhedra{"polyhedron", CellType::OtherSolid, 0, 0};

const CellKind* cellKind(std::int32_t code) {
  for (const Keyword& keyword : kCellKeywords)
    if (keyword.code == code)
      return &keyword.kind;
  return nullptr;
}

const CellKind* cellKind(std::string_view name) {
  for (const Keyword& keyword : kCellKeywords)
    if (keyword.name == name)
      return &keyword.kind;
  return nullptr;
}

/// Common part of the text and the binary form: `In` is the cursor, for messages.
template <class In>
class MeditMesh {
public:
  MeditMesh(In& in, const Source& source, const ReadOptions& options, Progress& progress)
      : in_(in), source_(source), options_(options), progress_(progress) {}

  /// With the corners of triangles and quadrilaterals where they are asked for.
  CellKind kept(CellKind kind) const {
    const std::string_view name = kind.name;
    if (options_.faces && kind.type == kFlat)
      kind.corners = name.rfind("triangle", 0) == 0 ? 3 : name.rfind("quad", 0) == 0 ? 4 : 0;
    return kind;
  }

  void beginVertices(std::size_t count) {
    if (haveVertices_)
      in_.fail("has Vertices twice", "keep one mesh in a file");
    haveVertices_ = true;
    checkPointCount(count, source_.path);
    mesh_.points.reserve(count);
  }

  void addVertex(const Vec3d& point) {
    if (!isFinite(point))
      in_.fail("vertex " + std::to_string(mesh_.points.size() + 1) +
                   " has a coordinate that is not a finite number",
               "repair the mesh");
    mesh_.points.push_back(point);
    if (mesh_.points.size() % kItemsPerUpdate == 0)
      update();
  }

  void beginCells(const CellKind& kind, std::size_t count) {
    mesh_.nodes.reserve(mesh_.nodes.size() + count * kind.stored());
    mesh_.regions.reserve(mesh_.regions.size() + count);
  }

  void addNode(std::int64_t number) {
    // Cells may come before the vertices; finish() checks those.
    if (number < 1 || number > (haveVertices_ ? static_cast<std::int64_t>(mesh_.points.size())
                                              : std::int64_t(IdMap::kNone)))
      in_.fail("a cell uses vertex " + std::to_string(number) + ", which does not exist",
               "the file is damaged; export it again");
    mesh_.nodes.push_back(static_cast<std::uint32_t>(number - 1));
  }

  void addRegion(std::int64_t reference) {
    if (reference < std::numeric_limits<std::int32_t>::min() ||
        reference > std::numeric_limits<std::int32_t>::max())
      in_.fail("a cell's reference is out of range");
    mesh_.regions.push_back(static_cast<std::int32_t>(reference));
    if (mesh_.regions.size() % kItemsPerUpdate == 0)
      update();
  }

  void endCells(const CellKind& kind, std::size_t count) { appendCells(mesh_, kind, count); }

  void skipCells(const CellKind& kind, std::size_t count) {
    mesh_.regions.insert(mesh_.regions.end(), count, 0);
    appendCells(mesh_, kind, count);
  }

  CellMesh finish() {
    if (!haveVertices_)
      in_.fail("has no Vertices", kCut);
    for (const std::uint32_t node : mesh_.nodes)
      if (node >= mesh_.points.size())
        in_.fail("a cell uses vertex " + std::to_string(std::uint64_t(node) + 1) + " of " +
                     std::to_string(mesh_.points.size()),
                 "the file is damaged; export it again");
    orderMids(mesh_);
    bool told = false;
    std::size_t cell = 0;
    for (const CellRun& run : mesh_.runs) {
      const auto begin = mesh_.regions.begin() + static_cast<std::ptrdiff_t>(cell);
      const auto end = begin + static_cast<std::ptrdiff_t>(run.count);
      told = told || (run.type != CellType::Flat &&
                      std::any_of(begin, end, [](std::int32_t region) { return region != 0; }));
      cell += run.count;
    }
    if (!told)
      mesh_.regions = {};
    return std::move(mesh_);
  }

private:
  void update() {
    source_.release();
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
  }

  In& in_;
  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  CellMesh mesh_;
  bool haveVertices_ = false;
};

void warnOfOrdering(Report& report) {
  report.warn("node-order", "the file has its own node order for curved cells; their first nodes "
                            "were taken as the corners all the same");
}

std::string_view withoutOrdering(std::string_view keyword) {
  constexpr std::string_view suffix = "Ordering";
  const bool has =
      keyword.size() > suffix.size() && keyword.substr(keyword.size() - suffix.size()) == suffix;
  return has ? keyword.substr(0, keyword.size() - suffix.size()) : std::string_view();
}

// --- Binary files.

// The version; numbers are in the file's byte order from then on.
std::int32_t beginBinary(ByteReader& in) {
  const auto one = in.get<std::int32_t>();
  in.setSwap(one != 1);
  if (one != 1 && byteSwapped(one) != 1)
    in.fail("not a .meshb file: it does not begin with 1", "check the file's format");
  const auto version = in.get<std::int32_t>();
  if (version < 1 || version > 4)
    in.fail("unknown version " + std::to_string(version) + " of the .meshb format",
            "save it as version 1 to 4");
  return version;
}

std::size_t integerBytes(std::int32_t version) {
  return version < 4 ? 4 : 8;
}

std::int64_t readInteger(ByteReader& in, std::size_t bytes) {
  return bytes == 4 ? in.get<std::int32_t>() : in.get<std::int64_t>();
}

// Position of the keyword behind this one, 0 where there is none.
std::int64_t readNext(ByteReader& in, std::int32_t code, std::int32_t version) {
  const std::int64_t next = version < 3 ? in.get<std::int32_t>() : in.get<std::int64_t>();
  // A position before the current one would be a loop.
  if (next != 0 && next < static_cast<std::int64_t>(in.position()))
    in.fail("keyword " + std::to_string(code) + " is followed by one that lies before it",
            "the file is damaged; export it again");
  return next;
}

} // namespace

CellMesh readMedit(const Source& source, const ReadOptions& options, Report& report,
                   Progress& progress) {
  NumberParser in(source, '#');
  MeditMesh<NumberParser> mesh(in, source, options, progress);
  std::int64_t dimension = 3;
  while (!in.atEnd()) {
    const std::string_view keyword = in.word();
    if (!isLetter(keyword[0])) {
      in.fail("expected a keyword such as Tetrahedra, found a number or other text",
              "a count before it is too small, or the file is damaged");
    } else if (keyword == "MeshVersionFormatted") {
      in.integer();
    } else if (keyword == "Dimension") {
      dimension = in.integer();
      if (dimension != 3)
        in.fail("the mesh has " + std::to_string(dimension) + " dimensions",
                "only three-dimensional meshes have a volume");
    } else if (keyword == "Vertices") {
      const std::size_t n = in.count("vertices", 8);
      mesh.beginVertices(n);
      for (std::size_t i = 0; i < n; ++i) {
        const double x = in.real(), y = in.real(), z = in.real();
        in.realInteger();
        mesh.addVertex({x, y, z});
      }
    } else if (keyword == "End") {
      break;
    } else if (const CellKind* found = cellKind(keyword)) {
      const CellKind kind = mesh.kept(*found);
      const std::size_t n = in.count(keyword, 2 * (kind.nodes + 1));
      mesh.beginCells(kind, n);
      for (std::size_t i = 0; i < n; ++i) {
        for (std::uint32_t k = 0; k < kind.nodes; ++k) {
          const std::int64_t number = in.integer();
          if (k < kind.stored())
            mesh.addNode(number);
        }
        mesh.addRegion(in.realInteger());
      }
      mesh.endCells(kind, n);
    } else {
      if (const CellKind* ordered = cellKind(withoutOrdering(keyword));
          ordered != nullptr && ordered->quadratic())
        warnOfOrdering(report);
      if (keyword == "Polyhedra" || keyword == "PolyhedraHeaders")
        mesh.skipCells(kPolyhedra, in.count("polyhedra", 4));
      // The next keyword is the next word that begins with a letter.
      while (!in.atEnd() && !isLetter(in.peekWord()[0]))
        in.word();
    }
  }
  return mesh.finish();
}

CellMesh readMeditBinary(const Source& source, const ReadOptions& options, Report& report,
                         Progress& progress) {
  ByteReader in(source);
  const std::int32_t version = beginBinary(in);
  const std::size_t width = integerBytes(version);
  const auto integer = [&] { return readInteger(in, width); };
  const auto real = [&]() { return version == 1 ? double(in.get<float>()) : in.get<double>(); };

  MeditMesh<ByteReader> mesh(in, source, options, progress);
  while (in.remaining() > 0) {
    const auto code = in.get<std::int32_t>();
    if (code == kEnd)
      break;
    const std::int64_t next = readNext(in, code, version);
    if (code == kDimension) {
      const auto dimension = in.get<std::int32_t>();
      if (dimension != 3)
        in.fail("the mesh has " + std::to_string(dimension) + " dimensions",
                "only three-dimensional meshes have a volume");
    } else if (code == kVertices) {
      const std::size_t n = in.checkCount(integer(), (version == 1 ? 12 : 24) + width, "vertices");
      mesh.beginVertices(n);
      for (std::size_t i = 0; i < n; ++i) {
        const double x = real(), y = real(), z = real();
        integer();
        mesh.addVertex({x, y, z});
      }
    } else if (const CellKind* found = cellKind(code)) {
      const CellKind kind = mesh.kept(*found);
      const std::size_t stride = width * (kind.nodes + 1);
      const std::size_t n = in.checkCount(integer(), stride, std::string(kind.name) + " cells");
      mesh.beginCells(kind, n);
      for (std::size_t i = 0; i < n; ++i) {
        const char* at = in.take(stride).data();
        const auto number = [&](std::size_t k) -> std::int64_t {
          return width == 4 ? loadNumber<std::int32_t>(at + 4 * k, in.swap())
                            : loadNumber<std::int64_t>(at + 8 * k, in.swap());
        };
        for (std::uint32_t k = 0; k < kind.stored(); ++k)
          mesh.addNode(number(k));
        mesh.addRegion(number(kind.nodes));
      }
      mesh.endCells(kind, n);
    } else {
      if (code == kPolyhedraCode || code == kPolyhedraHeaders)
        mesh.skipCells(kPolyhedra, in.checkCount(integer(), width, "polyhedra"));
      const bool ordering = code >= 133 && code <= 140; // of tetrahedra to hexahedra, order 2 and 3
      if (ordering)
        warnOfOrdering(report);
      if (next == 0)
        break;
    }
    if (next == 0)
      continue;
    if (next < static_cast<std::int64_t>(in.position()))
      in.fail("keyword " + std::to_string(code) + " holds more than its place in the file",
              "the file is damaged; export it again");
    in.seek(static_cast<std::uint64_t>(next));
  }
  return mesh.finish();
}

bool meditHasSolidCells(const Source& source, Report&, Progress& progress) {
  const auto holds = [&](std::string_view name) {
    progress.check();
    const std::string_view text = source.bytes;
    for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
      if (at > 0 && static_cast<unsigned char>(text[at - 1]) > ' ')
        continue;
      NumberParser in(source, '#', at);
      if (in.word() == name && in.integer() > 0)
        return true;
    }
    return false;
  };
  const auto holdsAny = [&](bool flat) {
    return std::any_of(std::begin(kCellKeywords), std::end(kCellKeywords),
                       [&](const Keyword& keyword) {
                         return (keyword.kind.type == kFlat) == flat && holds(keyword.name);
                       });
  };
  return holdsAny(false) || holds("Polyhedra") || holds("PolyhedraHeaders") || !holdsAny(true);
}

bool meditBinaryHasSolidCells(const Source& source, Report&, Progress& progress) {
  ByteReader in(source);
  const std::int32_t version = beginBinary(in);
  while (in.remaining() > 0) {
    progress.check();
    const auto code = in.get<std::int32_t>();
    if (code == kEnd)
      break;
    const std::int64_t next = readNext(in, code, version);
    const CellKind* kind = cellKind(code);
    if (((kind != nullptr && kind->type != kFlat) || code == kPolyhedraCode ||
         code == kPolyhedraHeaders) &&
        readInteger(in, integerBytes(version)) > 0)
      return true;
    if (next == 0)
      break;
    in.seek(static_cast<std::uint64_t>(next));
  }
  return false;
}

} // namespace tetvdb
