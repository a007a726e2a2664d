// SPDX-License-Identifier: Apache-2.0
//
// Format: .vol, the successor of Netgen's "Neutral" format, as written by its mesh class.
#include "tetvdb/io/formats/netgen/NetgenReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/NodeOrder.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <limits>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

constexpr CellKind kTriangle{"triangle", CellType::Flat, 0, 0};
constexpr CellKind kSegment{"segment", CellType::Flat, 0, 0};

/// Netgen numbers the corners of tetrahedra, pyramids and prisms in the orientation opposite to
/// VTK's, which is irrelevant here: cells may have any orientation.
const CellKind* volumeElement(std::int64_t nodes) {
  static const CellKind kinds[] = {{"tetra", CellType::Tetra, 4, 4},
                                   {"pyramid", CellType::Pyramid, 5, 5},
                                   {"wedge", CellType::Wedge, 6, 6},
                                   {"hexahedron", CellType::Hexahedron, 8, 8},
                                   {"tetra10", CellType::Tetra, 4, 10, 10},
                                   {"wedge12", CellType::Wedge, 6, 12},
                                   {"pyramid13", CellType::Pyramid, 5, 13},
                                   {"wedge15", CellType::Wedge, 6, 15},
                                   {"hexahedron20", CellType::Hexahedron, 8, 20}};
  for (const CellKind& kind : kinds)
    if (kind.nodes == nodes)
      return &kind;
  return nullptr;
}

const CellKind* surfaceElement(std::int64_t nodes) {
  static const CellKind kinds[] = {{"triangle", CellType::Flat, 3, 3},
                                   {"quad", CellType::Flat, 4, 4},
                                   {"triangle6", CellType::Flat, 3, 6},
                                   {"quad8", CellType::Flat, 4, 8}};
  for (const CellKind& kind : kinds)
    if (kind.nodes == nodes)
      return &kind;
  return nullptr;
}

class NetgenFile {
public:
  NetgenFile(const Source& source, const ReadOptions& options, Progress& progress)
      : source_(source), options_(options), progress_(progress), in_(source, '#') {}

  CellMesh read() {
    bool havePoints = false;
    while (!in_.atEnd()) {
      const std::string_view word = in_.word();
      if (word == "dimension") {
        if (in_.integer() != 3)
          in_.fail("the mesh is not three-dimensional",
                   "only three-dimensional meshes have a volume");
      } else if (word == "endmesh") {
        break;
      } else if (word == "points" || word == "pointsgi") {
        if (havePoints)
          in_.fail("has points twice", "keep one mesh in a file");
        havePoints = true;
        readPoints();
      } else if (word == "volumeelements" || word == "volumeelementsgi") {
        readVolumeElements();
      } else if (word == "surfaceelements" || word == "surfaceelementsgi" ||
                 word == "surfaceelementsuv") {
        const std::size_t n = in_.count("surface elements", 8);
        options_.faces ? readSurfaceElements(n) : skipLines(kTriangle, n);
      } else if (word == "edgesegments" || word == "edgesegmentsgi" || word == "edgesegmentsgi2") {
        skipLines(kSegment, in_.count("edge segments", 8));
      } else if (word == "bcnames" || word == "cd2names" || word == "cd3names") {
        // Names that could be mistaken for sections.
        for (std::size_t n = in_.count("names", 2); n > 0; --n) {
          in_.skipSpace();
          in_.line();
        }
      } else if (word == "materials") {
        readMaterials();
      } else if (!isLetter(word[0]) && !skipping_) {
        in_.fail("expected a section such as points or volumeelements",
                 "a count before it is too small, or the file is damaged");
      } else {
        // A section that is not needed: its numbers and names are skipped as words.
        skipping_ = true;
        continue;
      }
      skipping_ = false;
    }
    if (!havePoints)
      in_.fail("has no points", kCut);
    for (const std::uint32_t node : mesh_.nodes)
      if (node >= mesh_.points.size())
        in_.fail("an element uses point " + std::to_string(std::uint64_t(node) + 1) + " of " +
                     std::to_string(mesh_.points.size()),
                 "the file is damaged; export it again");
    orderMids(mesh_);
    return std::move(mesh_);
  }

private:
  void readPoints() {
    const std::size_t n = in_.count("points", 6);
    checkPointCount(n, source_.path);
    mesh_.points.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const double x = in_.real(), y = in_.real(), z = in_.real();
      mesh_.points.push_back({x, y, z});
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  void readVolumeElements() {
    const std::size_t n = in_.count("volume elements", 12);
    mesh_.regions.reserve(mesh_.regions.size() + n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t material = in_.integer();
      if (material < std::numeric_limits<std::int32_t>::min() ||
          material > std::numeric_limits<std::int32_t>::max())
        in_.fail("a material number is out of range");
      const std::int64_t nodes = in_.integer();
      const CellKind* kind = volumeElement(nodes);
      if (kind == nullptr)
        in_.fail("a volume element of " + std::to_string(nodes) + " nodes",
                 "known are 4, 5, 6, 8, 10, 12, 13, 15 and 20");
      for (std::uint32_t k = 0; k < kind->stored(); ++k)
        addNode();
      for (std::uint32_t k = kind->stored(); k < kind->nodes; ++k)
        in_.integer();
      mesh_.regions.push_back(static_cast<std::int32_t>(material));
      appendCells(mesh_, *kind);
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  // A line each: surface, condition, two domains, then the nodes, corners first.
  void readSurfaceElements(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 4; ++k)
        in_.integer();
      const std::int64_t nodes = in_.integer();
      const CellKind* kind = surfaceElement(nodes);
      if (kind == nullptr)
        in_.fail("a surface element of " + std::to_string(nodes) + " nodes",
                 "known are 3, 4, 6 and 8");
      for (std::uint32_t k = 0; k < kind->corners; ++k)
        addNode();
      in_.line();
      mesh_.regions.push_back(0);
      appendCells(mesh_, *kind);
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  void addNode() {
    const std::int64_t number = in_.integer();
    if (number < 1 || number >= std::int64_t(IdMap::kNone))
      in_.fail("an element uses point " + std::to_string(number) + ", which does not exist");
    mesh_.nodes.push_back(static_cast<std::uint32_t>(number - 1));
  }

  void skipLines(const CellKind& kind, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      if (in_.atEnd() || isLetter(in_.peekWord()[0]))
        in_.fail("fewer elements than declared", kCut);
      in_.line();
    }
    mesh_.regions.insert(mesh_.regions.end(), n, 0);
    appendCells(mesh_, kind, n);
  }

  void readMaterials() {
    const std::size_t n = in_.count("materials", 4);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t number = in_.integer();
      std::string_view name = in_.line();
      while (!name.empty() && static_cast<unsigned char>(name.front()) <= ' ')
        name.remove_prefix(1);
      while (!name.empty() && static_cast<unsigned char>(name.back()) <= ' ')
        name.remove_suffix(1);
      if (number >= 0 && number <= std::numeric_limits<std::int32_t>::max())
        mesh_.regionNames[static_cast<std::int32_t>(number)] = name;
    }
  }

  void update() {
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
  }

  const Source& source_;
  const ReadOptions& options_;
  Progress& progress_;
  NumberParser in_;
  CellMesh mesh_;
  bool skipping_ = true; ///< skips words that are not sections, such as those before the first
};

} // namespace

CellMesh readNetgen(const Source& source, const ReadOptions& options, Report&, Progress& progress) {
  return NetgenFile(source, options, progress).read();
}

bool netgenHasSolidCells(const Source& source, Report&, Progress&) {
  constexpr std::string_view section = "volumeelements";
  const std::string_view text = source.bytes;
  for (std::size_t at = text.find(section); at != text.npos; at = text.find(section, at + 1)) {
    NumberParser in(source, '#', at);
    in.word();
    if (in.integer() > 0)
      return true;
  }
  return false;
}

} // namespace tetvdb
