// SPDX-License-Identifier: Apache-2.0
//
// Format: Abaqus Keywords Reference Guide; CalculiX CrunchiX user's manual.
#include "tetvdb/io/formats/abaqus/AbaqusReader.h"

#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/IdMap.h"
#include "tetvdb/io/formats/abaqus/AbaqusDeck.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::int64_t kMaxId = 0xfffffffe;

/// Elements named in a set: ranges of numbers, and other sets.
struct ElementSet {
  std::string shown; ///< name as in the file
  struct Range {
    std::int64_t first, last, step;
  };
  std::vector<Range> ranges;
  std::vector<std::string> sets;
  std::size_t lastMention = 0; ///< increases through the file
};

/// The content of a *PART, or of a deck without parts. mesh.nodes contains node numbers instead of
/// indices until finish().
struct Part {
  CellMesh mesh;
  IdMap nodeIds;
  IdMap elementIds;
  std::vector<std::uint32_t> elementNumbers;
  std::map<std::string, ElementSet> sets;
  std::vector<std::string> sections; ///< sets named by a *SOLID SECTION
};

/// A *INSTANCE: x -> rotation (x + translation).
struct Instance {
  std::string part;
  double translation[3] = {0, 0, 0};
  double axis[6] = {0, 0, 0, 0, 0, 0}; ///< two points on the axis of rotation
  double degrees = 0;
};

/// The kind of an element type such as C3D10M, DC3D8 or COH3D6; corners 0 for one without volume.
/// The midpoints of C3D10, C3D20, C3D15 and C3D13 are in VTK's order (Abaqus Analysis User's Guide,
/// "Three-dimensional solid element library", node ordering).
CellKind elementKind(const std::string& type) {
  std::size_t digits = std::string::npos;
  for (const char* family : {"COH3D", "C3D"})
    if (const std::size_t at = type.find(family); at != type.npos && digits == type.npos)
      digits = at + std::string_view(family).size();
  if (digits == type.npos && (type.rfind("SC6", 0) == 0 || type.rfind("SC8", 0) == 0))
    digits = 2;
  if (digits == type.npos)
    return {"", CellType::Flat, 0, 0};
  std::uint32_t nodes = 0;
  for (; digits < type.size() && type[digits] >= '0' && type[digits] <= '9' && nodes < 1000;
       ++digits)
    nodes = 10 * nodes + static_cast<std::uint32_t>(type[digits] - '0');
  switch (nodes) {
  case 4:
  case 10:
    return {"", CellType::Tetra, 4, nodes, keptNodes(CellType::Tetra, nodes)};
  case 5:
  case 13:
    return {"", CellType::Pyramid, 5, nodes, keptNodes(CellType::Pyramid, nodes)};
  case 6:
  case 15:
  case 18:
    return {"", CellType::Wedge, 6, nodes, nodes == 15 ? 15u : 0u};
  case 8:
  case 20:
  case 27:
    return {"", CellType::Hexahedron, 8, nodes, nodes == 20 ? 20u : 0u};
  default:
    return {"", CellType::OtherSolid, 0, 0};
  }
}

/// The kind of a shell, membrane, rigid face or plane element such as S4R, STRI65, M3D6, R3D3 or
/// CPS4, with its corners; corners 0 for another. meshio writes quadrilaterals of surfaces as
/// CAX4P.
CellKind faceKind(const std::string& type) {
  if (type == "STRI65")
    return {"", CellType::Flat, 3, 6};
  for (const std::string_view family :
       {"SFM3D", "M3D", "R3D", "STRI", "CPS", "CPE", "CAX", "DS", "S"})
    if (type.compare(0, family.size(), family) == 0 && type.size() > family.size())
      switch (type[family.size()]) {
      case '3':
        return {"", CellType::Flat, 3, 3};
      case '6':
        return {"", CellType::Flat, 3, 6};
      case '4':
        return {"", CellType::Flat, 4, 4};
      case '8':
        return {"", CellType::Flat, 4, 8};
      case '9':
        return {"", CellType::Flat, 4, 9};
      default:
        break;
      }
  return {"", CellType::Flat, 0, 0};
}

class AbaqusFile {
public:
  AbaqusFile(const Source& source, const ReadOptions& options, Report& report, Progress& progress)
      : source_(source), options_(options), report_(report), progress_(progress), deck_(source) {}

  /// Reads the keywords alone.
  bool hasSolidCells() {
    while (deck_.nextKeyword())
      if (deck_.keyword() == "ELEMENT" && elementKind(name("TYPE")).type != CellType::Flat)
        return true;
    return false;
  }

  CellMesh read() {
    Part* part = &root_;
    while (deck_.nextKeyword()) {
      const std::string& keyword = deck_.keyword();
      if (keyword == "NODE")
        readNodes(*part);
      else if (keyword == "ELEMENT")
        readElements(*part);
      else if (keyword == "ELSET")
        readSet(*part);
      else if (keyword == "SOLIDSECTION")
        readSection(*part);
      else if (keyword == "PART")
        part = &parts_[name("NAME")];
      else if (keyword == "ENDPART")
        part = &root_;
      else if (keyword == "INSTANCE")
        part = readInstance();
      else if (keyword == "ENDINSTANCE")
        part = &root_;
      else
        refuseGenerators();
    }
    return assemble();
  }

private:
  std::string name(const std::string& parameter) const {
    const std::string* value = deck_.parameter(parameter);
    return value == nullptr ? std::string() : abaqusName(*value);
  }

  // The data lines of a keyword may be in another file.
  void openInput() {
    if (const std::string* file = deck_.parameter("INPUT"))
      deck_.include(*file);
  }

  void refuseGenerators() const {
    for (const char* keyword : {"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM"})
      if (deck_.keyword() == keyword)
        deck_.fail("*" + deck_.keyword() + " is not read",
                   "export the mesh with plain *NODE and *ELEMENT");
  }

  void readNodes(Part& part) {
    openInput();
    if (const std::string* system = deck_.parameter("SYSTEM");
        system != nullptr && abaqusName(*system) != "R")
      deck_.fail("nodes in cylindrical or spherical coordinates are not read",
                 "export them in rectangular ones");
    std::string_view field;
    while (deck_.nextLine()) {
      deck_.nextField(field);
      part.nodeIds.add(checkId(deck_.integer(field)));
      Vec3d point{0, 0, 0};
      for (double& x : point)
        if (deck_.nextField(field))
          x = deck_.real(field);
      part.mesh.points.push_back(point);
      if (part.mesh.points.size() % 65536 == 0)
        update();
    }
  }

  std::int64_t checkId(std::int64_t id) const {
    if (id < 0 || id > kMaxId)
      deck_.fail("number " + std::to_string(id) + " is out of range");
    return id;
  }

  void readElements(Part& part) {
    openInput();
    const std::string type = name("TYPE");
    CellKind kind = elementKind(type);
    if (options_.faces && kind.type == CellType::Flat)
      kind = faceKind(type);
    ElementSet* set = nullptr;
    if (deck_.parameter("ELSET") != nullptr)
      set = &openSet(part);
    std::size_t count = 0;
    std::string_view field;
    while (deck_.nextLine()) {
      if (!deck_.nextField(field))
        continue;
      const std::int64_t id = checkId(deck_.integer(field));
      part.elementIds.add(id);
      part.elementNumbers.push_back(static_cast<std::uint32_t>(id));
      if (set != nullptr)
        addToSet(*set, id, id, 1);
      std::uint32_t got = 0;
      // The corners may be on several lines; a comma may follow the last.
      for (;;) {
        while (deck_.nextField(field)) {
          if (field.empty())
            continue;
          if (got++ >= kind.stored())
            continue;
          part.mesh.nodes.push_back(static_cast<std::uint32_t>(checkId(deck_.integer(field))));
        }
        const std::uint32_t min = kind.nodes == 27 ? 21 : kind.nodes; // inner nodes may be missing
        const bool more = got < min || (deck_.continues() && got != kind.nodes);
        if (!more)
          break;
        if (!deck_.nextLine())
          deck_.fail("element " + std::to_string(id) + " has " + std::to_string(got) +
                         " nodes; type " + type.substr(0, 20) + " has " +
                         std::to_string(kind.nodes),
                     kCut);
      }
      if (kind.nodes > 0 && got > kind.nodes)
        deck_.fail("element " + std::to_string(id) + " has more nodes than its type " +
                   type.substr(0, 20));
      if (++count % 65536 == 0)
        update();
    }
    if (count == 0)
      return;
    std::vector<CellRun>& runs = part.mesh.runs;
    if (runs.empty() || runs.back().fileType != type)
      runs.push_back({kind.type, kind.stored(), 0, type.substr(0, 20), kind.quadratic()});
    runs.back().count += count;
  }

  // --- Sets -------------------------------------------------------------------------------------

  ElementSet& openSet(Part& part) {
    const std::string key = name("ELSET");
    const auto [at, isNew] = part.sets.try_emplace(key);
    if (isNew)
      at->second.shown = deck_.parameter("ELSET")->substr(0, 80);
    at->second.lastMention = ++mentions_;
    return at->second;
  }

  static void addToSet(ElementSet& set, std::int64_t first, std::int64_t last, std::int64_t step) {
    if (step == 1 && !set.ranges.empty() && set.ranges.back().step == 1 &&
        set.ranges.back().last + 1 == first)
      set.ranges.back().last = last;
    else
      set.ranges.push_back({first, last, step});
  }

  void readSet(Part& part) {
    // Internal sets describe surfaces; a set of an assembly belongs to an instance, not to a part.
    if (deck_.parameter("ELSET") == nullptr || deck_.parameter("INTERNAL") != nullptr)
      return;
    openInput();
    ElementSet& set = openSet(*setOwner(part));
    const bool generate = deck_.parameter("GENERATE") != nullptr;
    std::string_view field;
    while (deck_.nextLine()) {
      std::int64_t numbers[3] = {0, 0, 1};
      int n = 0;
      while (deck_.nextField(field)) {
        if (field.empty())
          continue;
        const bool isNumber = (field[0] >= '0' && field[0] <= '9') || field[0] == '+';
        if (!isNumber) {
          set.sets.push_back(abaqusName(field));
          continue;
        }
        const std::int64_t number = checkId(deck_.integer(field));
        if (!generate)
          addToSet(set, number, number, 1);
        else if (n < 3)
          numbers[n++] = number;
      }
      if (generate && n >= 2) {
        if (numbers[2] < 1)
          deck_.fail("a step of 0 in a generated set");
        addToSet(set, numbers[0], numbers[1], numbers[2]);
      }
    }
  }

  /// The part to which a set's numbers refer: that of the named instance, else the current one.
  Part* setOwner(Part& part) {
    const auto instance = instanceParts_.find(name("INSTANCE"));
    if (instance == instanceParts_.end())
      return &part;
    return &parts_[instance->second];
  }

  void readSection(Part& part) {
    if (deck_.parameter("ELSET") != nullptr)
      part.sections.push_back(name("ELSET"));
  }

  Part* readInstance() {
    Instance instance;
    instance.part = name("PART");
    const std::string own = name("NAME");
    std::string_view field;
    if (deck_.nextLine()) {
      for (double& x : instance.translation)
        if (deck_.nextField(field))
          x = deck_.real(field);
      if (deck_.nextLine()) {
        for (double& x : instance.axis)
          if (deck_.nextField(field))
            x = deck_.real(field);
        if (deck_.nextField(field))
          instance.degrees = deck_.real(field);
      }
    }
    // An instance may contain its own mesh instead of a part's.
    if (instance.part.empty())
      instance.part = "\n" + own;
    if (instance.part[0] != '\n' && parts_.count(instance.part) == 0)
      deck_.fail("*INSTANCE of a part that the file does not have", "export the parts too");
    instanceParts_[own] = instance.part;
    instances_.push_back(instance);
    return &parts_[instance.part];
  }

  // --- From parts to one mesh -------------------------------------------------------------------

  void finish(Part& part) {
    part.nodeIds.finish();
    part.elementIds.finish();
    if (part.nodeIds.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(part.nodeIds.duplicates()) +
                                        " node numbers are used twice; the last one counts");
    for (std::uint32_t& node : part.mesh.nodes) {
      const std::uint32_t index = part.nodeIds.find(node);
      if (index == IdMap::kNone)
        throw Error(Status::Invalid, source_.path,
                    "an element uses node " + std::to_string(node) + ", which does not exist",
                    kCut);
      node = index;
    }
    setRegions(part);
  }

  void setRegions(Part& part) {
    part.mesh.regions.assign(part.elementNumbers.size(), 0);
    std::vector<std::string> order = part.sections;
    if (order.empty()) {
      // An element in several sets belongs to the last one, so that a set of all elements is
      // overridden by later sets.
      for (const auto& [key, set] : part.sets)
        order.push_back(key);
      std::sort(order.begin(), order.end(), [&](const std::string& a, const std::string& b) {
        return part.sets[a].lastMention < part.sets[b].lastMention;
      });
    }
    for (const std::string& key : order)
      if (const auto set = part.sets.find(key); set != part.sets.end())
        paint(part, key, regionOf(set->second.shown));
  }

  /// One number for all sets of one name, in any part.
  std::int32_t regionOf(const std::string& shown) {
    const auto next = static_cast<std::int32_t>(regionNumbers_.size() + 1);
    const std::int32_t number = regionNumbers_.try_emplace(shown, next).first->second;
    regionNames_[number] = shown;
    return number;
  }

  /// Assigns the region to the elements of a set, and of the sets in it.
  void paint(Part& part, const std::string& first, std::int32_t region) {
    const std::size_t cells = part.elementNumbers.size();
    std::set<std::string> seen{first};
    std::vector<std::string> open{first};
    while (!open.empty()) {
      const auto set = part.sets.find(open.back());
      open.pop_back();
      if (set == part.sets.end())
        continue;
      for (const ElementSet::Range& range : set->second.ranges) {
        if (range.last < range.first)
          continue;
        const auto wanted = static_cast<std::uint64_t>((range.last - range.first) / range.step);
        spend(std::min<std::uint64_t>(wanted, cells) + 1);
        if (wanted <= cells) {
          for (std::int64_t id = range.first; id <= range.last; id += range.step)
            if (const std::uint32_t cell = part.elementIds.find(id); cell != IdMap::kNone)
              part.mesh.regions[cell] = region;
        } else {
          for (std::size_t cell = 0; cell < cells; ++cell) {
            const std::int64_t id = part.elementNumbers[cell];
            if (id >= range.first && id <= range.last && (id - range.first) % range.step == 0)
              part.mesh.regions[cell] = region;
          }
        }
      }
      spend(set->second.sets.size());
      for (const std::string& other : set->second.sets)
        if (seen.insert(other).second)
          open.push_back(other);
    }
  }

  /// Limits the work for sets of sets and overlapping ranges.
  void spend(std::uint64_t steps) {
    steps_ += steps;
    if (steps_ > (std::uint64_t(1) << 26) + 64 * deck_.bytes())
      throw Error(Status::Invalid, source_.path, "its element sets overlap too often",
                  "export it without sets");
  }

  CellMesh assemble() {
    finish(root_);
    for (auto& [key, part] : parts_)
      finish(part);
    CellMesh mesh = std::move(root_.mesh);
    if (instances_.empty()) // parts without an assembly are not moved
      for (const auto& [key, part] : parts_)
        append(mesh, part.mesh, {});
    for (const Instance& instance : instances_)
      append(mesh, parts_[instance.part].mesh, instance);
    if (regionNames_.empty())
      mesh.regions = {};
    mesh.regionNames = regionNames_;
    return mesh;
  }

  void append(CellMesh& mesh, const CellMesh& part, const Instance& instance) {
    // A small file with many instances of a large part must not request too much memory.
    copied_ += part.points.size() + part.nodes.size();
    if (copied_ > (std::uint64_t(1) << 26) && copied_ / 256 > source_.bytes.size())
      throw Error(Status::Limit, source_.path, "instances make the mesh too large");
    checkPointCount(mesh.points.size() + part.points.size(), source_.path);
    const auto offset = static_cast<std::uint32_t>(mesh.points.size());
    for (const Vec3d& p : part.points)
      mesh.points.push_back(place(p, instance));
    for (const std::uint32_t node : part.nodes)
      mesh.nodes.push_back(node + offset);
    mesh.runs.insert(mesh.runs.end(), part.runs.begin(), part.runs.end());
    mesh.regions.insert(mesh.regions.end(), part.regions.begin(), part.regions.end());
  }

  Vec3d place(Vec3d p, const Instance& instance) const {
    for (std::size_t k = 0; k < 3; ++k)
      p[k] += instance.translation[k];
    const double* a = instance.axis;
    Vec3d u{a[3] - a[0], a[4] - a[1], a[5] - a[2]};
    const double length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    if (instance.degrees != 0 && length > 0) {
      // Rodrigues' formula about the axis through a[0..2].
      const double angle = instance.degrees * 3.14159265358979323846 / 180;
      const double c = std::cos(angle), s = std::sin(angle);
      const Vec3d q{p[0] - a[0], p[1] - a[1], p[2] - a[2]};
      for (double& x : u)
        x /= length;
      const double along = (1 - c) * (u[0] * q[0] + u[1] * q[1] + u[2] * q[2]);
      p = {a[0] + c * q[0] + s * (u[1] * q[2] - u[2] * q[1]) + along * u[0],
           a[1] + c * q[1] + s * (u[2] * q[0] - u[0] * q[2]) + along * u[1],
           a[2] + c * q[2] + s * (u[0] * q[1] - u[1] * q[0]) + along * u[2]};
    }
    if (!isFinite(p))
      throw Error(Status::Invalid, source_.path, "*INSTANCE moves nodes to infinity");
    return p;
  }

  void update() {
    progress_.update(static_cast<double>(deck_.position()) /
                     static_cast<double>(source_.bytes.size()));
  }

  const Source& source_;
  const ReadOptions& options_;
  Report& report_;
  Progress& progress_;
  AbaqusDeck deck_;
  Part root_;
  std::map<std::string, Part> parts_;
  std::map<std::string, std::string> instanceParts_; ///< part of each instance
  std::vector<Instance> instances_;
  std::map<std::string, std::int32_t> regionNumbers_;
  std::map<std::int32_t, std::string> regionNames_;
  std::size_t mentions_ = 0;
  std::uint64_t steps_ = 0;
  std::uint64_t copied_ = 0;
};

} // namespace

CellMesh readAbaqus(const Source& source, const ReadOptions& options, Report& report,
                    Progress& progress) {
  return AbaqusFile(source, options, report, progress).read();
}

bool abaqusHasSolidCells(const Source& source, Report& report, Progress& progress) {
  return AbaqusFile(source, {}, report, progress).hasSolidCells();
}

} // namespace tetvdb
