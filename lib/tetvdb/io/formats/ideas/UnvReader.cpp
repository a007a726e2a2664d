// SPDX-License-Identifier: Apache-2.0
//
// The format: SDRC I-DEAS, "Universal Dataset Number 2411, 2412, 2467", as archived by the
// University of Cincinnati's Structural Dynamics Research Laboratory.
#include "tetvdb/io/formats/ideas/UnvReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// Nodes go around a base, corners and midpoints in turn, then between the bases, then around the
// other one. VTK's node i is the file's node order[i].
constexpr std::uint8_t kTetra10[] = {0, 2, 4, 9, 1, 3, 5, 6, 7, 8};
constexpr std::uint8_t kWedge15[] = {0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8};
constexpr std::uint8_t kHexahedron20[] = {0, 2, 4,  6,  12, 14, 16, 18, 1,  3,
                                          5, 7, 13, 15, 17, 19, 8,  9,  10, 11};
constexpr std::uint8_t kTriangle6[] = {0, 2, 4}, kQuadrilateral8[] = {0, 2, 4, 6};

struct Element {
  CellKind kind;
  std::uint32_t faceCorners = 0; ///< of triangles and quadrilaterals
};

/// By the "FE descriptor id". Flat ones are those of plane stress, of plates, shells, ...
Element elementOf(std::int64_t descriptor, std::uint32_t nodes) {
  switch (descriptor) {
  case 111:
    return {{"solid linear tetrahedron", CellType::Tetra, 4, 4}};
  case 112:
    return {{"solid linear wedge", CellType::Wedge, 6, 6}};
  case 113:
    return {{"solid parabolic wedge", CellType::Wedge, 6, 15, 15, kWedge15}};
  case 115:
    return {{"solid linear brick", CellType::Hexahedron, 8, 8}};
  case 116:
    return {{"solid parabolic brick", CellType::Hexahedron, 8, 20, 20, kHexahedron20}};
  case 118:
    return {{"solid parabolic tetrahedron", CellType::Tetra, 4, 10, 10, kTetra10}};
  case 114:
  case 117:
    return {{"solid cubic element", CellType::OtherSolid, 0, nodes}};
  default:
    break;
  }
  if (descriptor > 40 && descriptor < 100)
    switch (descriptor % 10) {
    case 1:
      return {{"linear triangle", CellType::Flat, 0, 3}, 3};
    case 2:
      return {{"parabolic triangle", CellType::Flat, 0, 6, 0, kTriangle6}, 3};
    case 4:
      return {{"linear quadrilateral", CellType::Flat, 0, 4}, 4};
    case 5:
      return {{"parabolic quadrilateral", CellType::Flat, 0, 8, 0, kQuadrilateral8}, 4};
    default:
      break;
    }
  return {{"other element", CellType::Flat, 0, nodes}};
}

bool isBeam(std::int64_t descriptor) {
  return descriptor == 11 || (descriptor >= 21 && descriptor <= 24);
}

class UnvFile {
public:
  UnvFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), in_(source) {}

  CellMesh read() {
    readDatasets();
    finish();
    return std::move(mesh_);
  }

  /// Reads the file up to the first solid cell.
  bool hasSolidCells() {
    kindsAlone_ = true;
    readDatasets();
    return isSolid_;
  }

private:
  // A dataset is between two lines "-1"; its number is on the first line.
  void readDatasets() {
    while (!isSolid_ && !in_.atEnd()) {
      if (trimmed(in_.line()) != "-1")
        in_.fail("expected '-1', which begins a dataset", kCut);
      const std::string_view line = trimmed(in_.line());
      const std::string_view number = line.substr(0, line.find(' '));
      if (number == "2411" || number == "781")
        readNodes();
      else if (number == "2412")
        readElements();
      else if (number == "2435" || number == "2452" || number == "2467" || number == "2477")
        readGroups(4);
      else if (number == "2429" || number == "2430" || number == "2432")
        readGroups(2);
      else
        skipDataset();
      progress_.check();
    }
  }

  /// Whether "-1" alone on its line follows, which is then read.
  bool atEndOfDataset() {
    const std::size_t at = in_.position();
    in_.skipSpace();
    if (in_.remaining() == 0)
      in_.fail("a dataset does not end with '-1'", kCut);
    if (trimmed(in_.line()) == "-1")
      return true;
    in_.seek(at);
    return false;
  }
  void skipDataset() {
    for (std::size_t n = 0; trimmed(in_.line()) != "-1"; ++n) {
      if (in_.remaining() == 0)
        in_.fail("a dataset does not end with '-1'", kCut);
      if (n % 65536 == 0)
        progress_.check();
    }
  }

  void readNodes() {
    while (!atEndOfDataset()) {
      nodeIds_.add(in_.integer());
      in_.line();
      Vec3d p{in_.real(), in_.real(), in_.real()};
      in_.line();
      mesh_.points.push_back(p);
      if (mesh_.points.size() % 65536 == 0)
        update();
    }
    checkPointCount(mesh_.points.size(), source_.path);
  }

  void readElements() {
    while (!atEndOfDataset()) {
      const std::int64_t id = in_.integer(), descriptor = in_.integer();
      for (int i = 0; i < 3; ++i) // property, material, colour
        in_.integer();
      const std::size_t nodes = in_.count("nodes of an element", 2);
      in_.line();
      if (isBeam(descriptor))
        in_.line();
      Element element = elementOf(descriptor, static_cast<std::uint32_t>(nodes));
      CellKind& kind = element.kind;
      if (nodes != kind.nodes)
        in_.fail("element " + std::to_string(id) + " has " + std::to_string(nodes) + " nodes; a " +
                     kind.name + " has " + std::to_string(kind.nodes),
                 kExport);
      if (kindsAlone_ && kind.type != CellType::Flat) {
        isSolid_ = true;
        return;
      }
      if (options_.faces)
        kind.kept = std::max(kind.kept, element.faceCorners);
      readCell(kind);
      appendCells(mesh_, kind);
      elementIds_.add(id);
      if (elementIds_.size() % 65536 == 0)
        update();
    }
  }

  // Node numbers for now, in VTK's order.
  void readCell(const CellKind& kind) {
    file_.clear();
    for (std::uint32_t k = 0; k < kind.nodes; ++k) {
      const std::int64_t node = in_.integer();
      if (node < 0 || node >= std::int64_t(IdMap::kNone))
        in_.fail("an element has a node " + std::to_string(node), kExport);
      file_.push_back(static_cast<std::uint32_t>(node));
    }
    for (std::uint32_t k = 0; k < kind.stored(); ++k)
      mesh_.nodes.push_back(file_[kind.order == nullptr ? k : kind.order[k]]);
  }

  /// Entities have `numbers` numbers each, the kind and the label first.
  void readGroups(int numbers) {
    while (!atEndOfDataset()) {
      const std::int64_t group = in_.integer();
      for (int i = 0; i < 6; ++i) // sets
        in_.integer();
      const std::size_t count =
          in_.count("entities of a group", 2 * static_cast<std::size_t>(numbers));
      in_.line();
      const std::string name(trimmed(in_.line()));
      std::vector<std::int64_t> elements;
      for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t kind = in_.integer(), label = in_.integer();
        for (int k = 2; k < numbers; ++k)
          in_.integer();
        if (kind == kElements)
          elements.push_back(label);
        if (i % 65536 == 0)
          progress_.check();
      }
      if (!elements.empty())
        groups_.push_back({group, name, std::move(elements)});
    }
  }

  void finish() {
    if (mesh_.points.empty())
      in_.fail("the file has no nodes (dataset 2411)", kCut);
    nodeIds_.finish();
    elementIds_.finish();
    if (nodeIds_.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(nodeIds_.duplicates()) +
                                        " nodes have a number that a later one has too");
    for (std::uint32_t& node : mesh_.nodes) {
      const std::uint32_t point = nodeIds_.find(node);
      if (point == IdMap::kNone)
        throw Error(Status::Invalid, source_.path,
                    "an element refers to node " + std::to_string(node) + ", which does not exist",
                    kExport);
      node = point;
    }
    setRegions();
  }

  // By the groups' numbers, or by their order where these are no numbers of regions: Salome gives
  // all the number 0.
  void setRegions() {
    std::set<std::int64_t> numbers;
    for (const Group& group : groups_)
      if (group.number > 0 && group.number <= std::numeric_limits<std::int32_t>::max())
        numbers.insert(group.number);
    const bool areNumbered = numbers.size() == groups_.size();
    if (!groups_.empty())
      mesh_.regions.assign(elementIds_.size(), 0);
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const Group& group = groups_[i];
      const auto region =
          static_cast<std::int32_t>(areNumbered ? group.number : std::int64_t(i) + 1);
      if (!group.name.empty())
        mesh_.regionNames[region] = group.name;
      for (const std::int64_t id : group.elements)
        if (const std::uint32_t cell = elementIds_.find(id); cell != IdMap::kNone)
          mesh_.regions[cell] = region;
    }
    if (isSolidWithoutGroups())
      mesh_.regions.clear();
  }

  /// Whether groups have faces or edges of solid cells alone.
  bool isSolidWithoutGroups() const {
    bool isSolid = false;
    std::size_t cell = 0;
    for (const CellRun& run : mesh_.runs)
      for (const std::size_t end = cell + run.count; cell < end && !mesh_.regions.empty(); ++cell) {
        isSolid = isSolid || run.type != CellType::Flat;
        if (run.type != CellType::Flat && mesh_.regions[cell] != 0)
          return false;
      }
    return isSolid;
  }

  void update() {
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
    source_.release();
  }

  static constexpr std::int64_t kElements = 8; ///< a group's entities, by their kind
  struct Group {
    std::int64_t number;
    std::string name;
    std::vector<std::int64_t> elements;
  };

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  NumberParser in_;
  bool kindsAlone_ = false, isSolid_ = false; ///< of hasSolidCells()
  IdMap nodeIds_, elementIds_;
  std::vector<std::uint32_t> file_; ///< nodes of an element
  std::vector<Group> groups_;
  CellMesh mesh_;
};

} // namespace

CellMesh readUnv(const Source& source, const ReadOptions& options, Report& report,
                 Progress& progress) {
  return UnvFile(source, options, report, progress).read();
}

bool unvHasSolidCells(const Source& source, Report& report, Progress& progress) {
  const ReadOptions options;
  return UnvFile(source, options, report, progress).hasSolidCells();
}

} // namespace tetvdb
