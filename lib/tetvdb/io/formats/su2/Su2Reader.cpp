// SPDX-License-Identifier: Apache-2.0
//
// The format: "Mesh File", SU2 documentation, https://su2code.github.io/docs_v7/Mesh-File.
#include "tetvdb/io/formats/su2/Su2Reader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <limits>
#include <string>
#include <string_view>

namespace tetvdb {
namespace {

/// Elements have VTK's types and orders of nodes.
const CellKind* kindOf(std::int64_t type) {
  static const CellKind line{"line", CellType::Flat, 0, 2},
      triangle{"triangle", CellType::Flat, 0, 3},
      quadrilateral{"quadrilateral", CellType::Flat, 0, 4},
      tetra{"tetrahedron", CellType::Tetra, 4, 4},
      hexahedron{"hexahedron", CellType::Hexahedron, 8, 8}, prism{"prism", CellType::Wedge, 6, 6},
      pyramid{"pyramid", CellType::Pyramid, 5, 5};
  switch (type) {
  case 3:
    return &line;
  case 5:
    return &triangle;
  case 9:
    return &quadrilateral;
  case 10:
    return &tetra;
  case 12:
    return &hexahedron;
  case 13:
    return &prism;
  case 14:
    return &pyramid;
  default:
    return nullptr;
  }
}

class Su2File {
public:
  Su2File(const Source& source, const ReadOptions& options, Progress& progress)
      : source_(source), options_(options), progress_(progress), in_(source, '%') {}

  CellMesh read() {
    readKeywords();
    endZone();
    if (zones_ < declaredZones_)
      in_.fail("the file ends after " + std::to_string(zones_) + " of " +
                   std::to_string(declaredZones_) + " zones",
               kCut);
    return std::move(mesh_);
  }

  /// Reads the file up to the first solid cell.
  bool hasSolidCells() {
    kindsAlone_ = true;
    readKeywords();
    return isSolid_;
  }

private:
  // Lines between those that are used are of markers and of boxes for deformations.
  void readKeywords() {
    while (!isSolid_ && in_.remaining() > 0) {
      const std::string_view whole = in_.line(), line = whole.substr(0, whole.find('%'));
      const std::size_t equals = line.find('=');
      if (equals == line.npos)
        continue;
      const std::string_view key = trimmed(line.substr(0, equals)), value = line.substr(equals + 1);
      if (key == "NDIME")
        readDimension(value);
      else if (key == "NZONE")
        declaredZones_ = integer(value);
      else if (key == "IZONE")
        beginZone(value);
      else if (key == "NELEM")
        readElements(count(value, "elements", 6));
      else if (key == "NPOIN")
        readPoints(count(value, "points", 4));
      progress_.check();
    }
  }

  std::int64_t integer(std::string_view value) const {
    NumberParser number(value, in_.path());
    std::int64_t n = 0;
    if (!number.tryInteger(n))
      in_.fail("a keyword before this line has no number", kExport);
    return n;
  }
  std::size_t count(std::string_view value, const char* things, std::size_t bytesEach) const {
    const std::int64_t n = integer(value);
    in_.checkCount(n, things, bytesEach);
    return static_cast<std::size_t>(n);
  }

  void readDimension(std::string_view value) {
    dimension_ = integer(value);
    if (dimension_ != 2 && dimension_ != 3)
      in_.fail("the mesh has " + std::to_string(dimension_) + " dimensions, not 2 or 3", kExport);
  }

  void beginZone(std::string_view value) {
    if (zone_ > 0)
      endZone();
    const std::int64_t zone = integer(value);
    if (zone < 1 || zone > std::numeric_limits<std::int32_t>::max())
      in_.fail("a zone has the number " + std::to_string(zone), kExport);
    zone_ = static_cast<std::int32_t>(zone);
  }

  /// Its elements name points from 0 on, which may come after them.
  void endZone() {
    const std::size_t points = mesh_.points.size() - zonePoint_;
    if (points == 0 || cells_ == zoneCell_)
      in_.fail("the mesh before this line has no points (NPOIN) or no elements (NELEM)", kCut);
    for (std::size_t i = zoneNode_; i < mesh_.nodes.size(); ++i) {
      if (mesh_.nodes[i] >= points)
        in_.fail("an element before this line refers to point " + std::to_string(mesh_.nodes[i]) +
                     ", but there are " + std::to_string(points) + ", numbered from 0",
                 kCut);
      mesh_.nodes[i] += static_cast<std::uint32_t>(zonePoint_);
    }
    if (zone_ > 0)
      mesh_.regions.resize(cells_, zone_);
    zonePoint_ = mesh_.points.size();
    zoneNode_ = mesh_.nodes.size();
    zoneCell_ = cells_;
    ++zones_;
  }

  void readElements(std::size_t elements) {
    for (std::size_t i = 0; i < elements; ++i) {
      const std::int64_t type = in_.integer();
      const CellKind* known = kindOf(type);
      if (known == nullptr)
        in_.fail("an element has the type " + std::to_string(type), kExport);
      isSolid_ = isSolid_ || known->type != CellType::Flat;
      if (kindsAlone_ && isSolid_)
        return;
      CellKind kind = *known;
      if (options_.faces && kind.type == CellType::Flat && kind.nodes > 2)
        kind.kept = kind.nodes;
      for (std::uint32_t k = 0; k < kind.nodes; ++k) {
        const std::int64_t node = in_.integer();
        if (node < 0 || node >= std::int64_t(IdMap::kNone))
          in_.fail("an element refers to point " + std::to_string(node), kExport);
        if (k < kind.stored())
          mesh_.nodes.push_back(static_cast<std::uint32_t>(node));
      }
      in_.line(); // the number of the element, which is optional
      appendCells(mesh_, kind);
      ++cells_;
      if (i % 65536 == 0)
        update();
    }
    isSolid_ = false; // read on
  }

  void readPoints(std::size_t points) {
    if (dimension_ == 0)
      in_.fail("points stand before the number of dimensions (NDIME)", kExport);
    checkPointCount(mesh_.points.size() + points, source_.path);
    for (std::size_t i = 0; i < points; ++i) {
      Vec3d p{0, 0, 0};
      for (std::int64_t k = 0; k < dimension_; ++k)
        p[static_cast<std::size_t>(k)] = in_.real();
      in_.line();
      mesh_.points.push_back(p);
      if (i % 65536 == 0)
        update();
    }
  }

  void update() {
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
    source_.release();
  }

  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  NumberParser in_;
  bool kindsAlone_ = false, isSolid_ = false; ///< of hasSolidCells()
  std::int64_t dimension_ = 0;
  std::int32_t zone_ = 0;                                   ///< 0: the file has no zones
  std::size_t zonePoint_ = 0, zoneNode_ = 0, zoneCell_ = 0; ///< its first ones
  std::size_t cells_ = 0;
  std::int64_t declaredZones_ = 1, zones_ = 0;
  CellMesh mesh_;
};

} // namespace

CellMesh readSu2(const Source& source, const ReadOptions& options, Report&, Progress& progress) {
  return Su2File(source, options, progress).read();
}

bool su2HasSolidCells(const Source& source, Report&, Progress& progress) {
  const ReadOptions options;
  return Su2File(source, options, progress).hasSolidCells();
}

} // namespace tetvdb
