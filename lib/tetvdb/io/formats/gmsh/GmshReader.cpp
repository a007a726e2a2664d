// SPDX-License-Identifier: Apache-2.0
//
// Format: Gmsh reference manual, "MSH file format" and "Legacy formats".
#include "tetvdb/io/formats/gmsh/GmshReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/cells/IdMap.h"
#include "tetvdb/io/formats/gmsh/GmshCursor.h"
#include "tetvdb/io/formats/gmsh/GmshData.h"
#include "tetvdb/io/formats/gmsh/GmshElements.h"
#include "tetvdb/io/formats/gmsh/GmshEntities.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

/// Consecutive elements with the same tags.
struct TagRun {
  std::size_t count;
  std::int32_t physical, geometrical;
  bool solid;
};

class MshReader {
public:
  /// `spool`: takes what is read, part by part; null: it stays in memory.
  MshReader(const Source& source, const ReadOptions& options, SpooledMesh* spool, Report& report,
            Progress& progress)
      : source_(source), options_(options), spool_(spool), report_(report), progress_(progress),
        in_(source), data_(in_, source.bytes.size(), report) {
    if (spool_ != nullptr)
      data_.spoolTo(*spool_);
  }

  CellMesh read() {
    while (!in_.text.atEnd())
      readSection();
    if (!haveNodes_)
      in_.fail("has no $Nodes section", kExportWithGmsh);
    if (!haveElements_)
      in_.fail("has no $Elements section", kExportWithGmsh);
    setRegions();
    if (spool_ != nullptr)
      data_.finish([&](const auto& visit) {
        for (const TagRun& run : tags_)
          visit(run.count, run.solid);
      });
    return std::move(mesh_);
  }

  /// Reads the elements up to the first solid one.
  bool hasSolidCells() {
    kindsAlone_ = true;
    try {
      while (!in_.text.atEnd() && !haveElements_)
        readSection();
    } catch (const SolidElement&) {
      return true;
    }
    return false;
  }

private:
  struct SolidElement {};

  // --- Sections ---------------------------------------------------------------------------------

  void readSection() {
    const std::string_view mark = in_.text.word();
    if (mark.empty() || mark[0] != '$')
      in_.fail("expected a section such as $Nodes", kExportWithGmsh);
    const std::string name(mark.substr(1, 60));
    const std::size_t start = in_.text.position();
    in_.text.line();
    if (name == "MeshFormat")
      readFormat();
    else if (name == "PhysicalNames")
      readNames();
    else if (name == "Entities")
      readEntities(in_, false, version_ < 4.05, volumes_);
    else if (name == "PartitionedEntities" && version_ > 4.05)
      readEntities(in_, true, version_ < 4.05, volumes_);
    else if (name == "Nodes" && kindsAlone_) {
      haveNodes_ = true;
      skipSection(name);
    } else if (name == "Nodes")
      version_ < 4 ? readNodes2() : readNodes4();
    else if (name == "NOD")
      readNodes2();
    else if (name == "Elements")
      version_ < 4 ? readElements2() : readElements4();
    else if (name == "ELM")
      readElements1();
    else if ((name == "NodeData" || name == "ElementData") && wantsData())
      readData(name == "NodeData");
    else {
      in_.text.seek(start);
      skipSection(name);
    }
    in_.leaveBinary();
    const bool version1 = name == "NOD" || name == "ELM";
    if (in_.text.word() != (version1 ? "$END" : "$End") + name)
      in_.fail("$" + name + " does not end with its $End" + name +
                   " where its declared numbers say",
               kExportWithGmsh);
  }

  bool wantsData() const { return options_.attributes || !options_.regionArray.empty(); }

  void readData(bool ofNodes) {
    if (!(ofNodes ? haveNodes_ : haveElements_))
      in_.fail("data come before the mesh", kExportWithGmsh);
    data_.read(ofNodes ? Attribute::On::Points : Attribute::On::Cells,
               ofNodes ? nodeIds_ : elementIds_, ofNodes ? pointCount() : elements_,
               mesh_.attributes);
  }

  void skipSection(const std::string& name) {
    const std::size_t at = in_.text.position();
    const std::size_t end = source_.bytes.find("$End" + name, at);
    if (end == std::string_view::npos)
      in_.fail("section $" + name + " has no end", "the file is cut off; export it again");
    in_.text.seek(end);
  }

  void readFormat() {
    version_ = in_.text.real();
    const std::int64_t kind = in_.text.integer();
    in_.sizeBytes = static_cast<std::size_t>(in_.text.integer());
    in_.text.line();
    if (version_ < 2 || version_ >= 5)
      in_.fail("unknown version of the .msh format", "save it as version 4.1 or 2.2");
    in_.binary = kind == 1;
    if (!in_.binary)
      return;
    if (in_.sizeBytes != 8 && in_.sizeBytes != 4)
      in_.fail("unknown data size", kExportWithGmsh);
    if (version_ < 4.05)
      in_.sizeBytes = 8;
    in_.enterBinary();
    const auto one = in_.bytes.get<std::int32_t>();
    if (one != 1 && byteSwapped(one) != 1)
      in_.fail("the byte order is not told (neither 1 nor its reverse)", kExportWithGmsh);
    in_.bytes.setSwap(one != 1);
  }

  void readNames() {
    const std::size_t n = in_.text.count("physical names", 6);
    for (std::size_t i = 0; i < n; ++i) {
      // Version 2.0 has names without dimensions.
      const std::int64_t first = in_.text.integer();
      const bool named = !in_.text.peekWord().empty() && in_.text.peekWord()[0] == '"';
      const std::int64_t dimension = named ? 3 : first;
      const std::int64_t number = named ? first : in_.text.integer();
      std::string_view name = in_.text.line();
      const std::size_t begin = name.find('"');
      const std::size_t end = name.rfind('"');
      if (begin != name.npos && end > begin)
        name = name.substr(begin + 1, end - begin - 1);
      if (dimension == 3)
        mesh_.regionNames[tag(number)] = name;
    }
  }

  std::int32_t tag(std::int64_t number) const { return gmshTag(in_, number); }

  // --- Nodes ------------------------------------------------------------------------------------

  void beginNodes() {
    if (haveNodes_)
      in_.fail("has two $Nodes sections", "keep one mesh in a file");
    haveNodes_ = true;
  }

  void addPoint(std::int64_t id, const Vec3d& point) {
    if (!isFinite(point))
      in_.fail("node " + std::to_string(id) + " has a coordinate that is not a finite number",
               "repair the mesh");
    nodeIds_.add(id);
    mesh_.points.push_back(point);
    if (mesh_.points.size() % kItemsPerUpdate == 0)
      flushPoints();
  }

  std::size_t pointCount() const {
    return mesh_.points.size() + (spool_ != nullptr ? spool_->pointCount() : 0);
  }
  void reservePoints(std::size_t n) {
    mesh_.points.reserve(spool_ != nullptr ? std::min(n, kItemsPerUpdate) : n);
  }
  void flushPoints() {
    update();
    if (spool_ == nullptr)
      return;
    spool_->points.append(mesh_.points);
    mesh_.points.clear();
  }

  void endNodes() {
    flushPoints();
    nodeIds_.finish();
    if (nodeIds_.duplicates() > 0)
      report_.warn("duplicate-ids", std::to_string(nodeIds_.duplicates()) +
                                        " node numbers are used twice; the last one counts");
  }

  void readNodes2() {
    beginNodes();
    const std::int64_t declared = in_.text.integer();
    in_.text.line();
    in_.enterBinary();
    const std::size_t n = in_.checkCount(declared, "nodes", 8, 4 + 3 * 8);
    checkPointCount(n, source_.path);
    reservePoints(n);
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t id = in_.integer();
      const double x = in_.real(), y = in_.real(), z = in_.real();
      addPoint(id, {x, y, z});
    }
    endNodes();
  }

  void readNodes4() {
    beginNodes();
    in_.enterBinary();
    const bool old = version_ < 4.05;
    const std::size_t blocks = in_.count("node blocks", 8, 12 + in_.sizeBytes);
    const std::size_t total = in_.count("nodes", 6, (old ? 4 : in_.sizeBytes) + 3 * 8);
    checkPointCount(total, source_.path);
    reservePoints(total);
    if (!old)
      in_.size(), in_.size(); // min and max tag
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int64_t first = in_.integer();
      const std::int64_t second = in_.integer();
      const std::int64_t dimension = old ? second : first;
      const bool parametric = in_.integer() != 0;
      const int parameters =
          parametric ? static_cast<int>(std::clamp<std::int64_t>(dimension, 0, 3)) : 0;
      const std::size_t n = in_.count("nodes", 6, (old ? 4 : in_.sizeBytes) + 3 * 8);
      if (pointCount() + n > total)
        in_.fail("node blocks hold more than the " + std::to_string(total) + " nodes declared",
                 kExportWithGmsh);
      if (old)
        readNodeBlock40(n, parameters);
      else
        readNodeBlock41(n, parameters);
    }
    if (pointCount() != total)
      in_.fail(std::to_string(total) + " nodes are declared, " + std::to_string(pointCount()) +
                   " are there",
               kExportWithGmsh);
    endNodes();
  }

  void readNodeBlock40(std::size_t n, int parameters) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::int64_t id = in_.integer();
      const double x = in_.real(), y = in_.real(), z = in_.real();
      for (int k = 0; k < parameters; ++k)
        in_.real();
      addPoint(id, {x, y, z});
    }
  }

  void readNodeBlock41(std::size_t n, int parameters) {
    if (in_.binary && parameters == 0) {
      for (std::size_t i = 0; i < n; ++i)
        nodeIds_.add(in_.size());
      in_.bytes.checkCount(n, sizeof(Vec3d), "nodes");
      for (std::size_t done = 0; done < n; done += kItemsPerUpdate)
        readCoordinates(std::min(kItemsPerUpdate, n - done));
      return;
    }
    std::vector<std::int64_t> ids(n);
    for (std::int64_t& id : ids)
      id = in_.size();
    for (const std::int64_t id : ids) {
      const double x = in_.real(), y = in_.real(), z = in_.real();
      for (int k = 0; k < parameters; ++k)
        in_.real();
      addPoint(id, {x, y, z});
    }
  }

  void readCoordinates(std::size_t n) {
    const std::size_t before = mesh_.points.size();
    mesh_.points.resize(before + n);
    in_.bytes.read<double>(mesh_.points[before].data(), 3 * n);
    const auto bad = std::find_if_not(mesh_.points.begin() + static_cast<std::ptrdiff_t>(before),
                                      mesh_.points.end(), isFinite);
    if (bad != mesh_.points.end())
      in_.fail("node " +
                   std::to_string(pointCount() -
                                  static_cast<std::size_t>(mesh_.points.end() - bad) + 1) +
                   " of the file has a coordinate that is not a finite number",
               "repair the mesh");
    flushPoints();
  }

  // --- Elements ---------------------------------------------------------------------------------

  void beginElements() {
    if (!haveNodes_)
      in_.fail("elements come before the nodes", kExportWithGmsh);
    if (haveElements_)
      in_.fail("has two $Elements sections", "keep one mesh in a file");
    haveElements_ = true;
  }

  const CellKind& kindOf(std::int64_t type) const {
    if (const CellKind* face = options_.faces ? gmshFace(type) : nullptr)
      return *face;
    const CellKind* kind = gmshElement(type);
    if (kind == nullptr)
      in_.fail("element type " + std::to_string(type) + " is not known",
               "save the mesh without polyhedra and sub-elements");
    return *kind;
  }

  void addElements(const CellKind& kind, std::size_t count, std::int32_t physical,
                   std::int32_t geometrical) {
    if (count == 0)
      return;
    appendCells(mesh_, kind, count);
    const bool solid = kind.type != CellType::Flat;
    if (solid && kindsAlone_)
      throw SolidElement();
    if (!tags_.empty() && tags_.back().physical == physical &&
        tags_.back().geometrical == geometrical && tags_.back().solid == solid)
      tags_.back().count += count;
    else
      tags_.push_back({count, physical, geometrical, solid});
    elements_ += count;
    if (elements_ >= IdMap::kNone)
      throw Error(Status::Limit, source_.path, "more than 4294967294 elements",
                  "split it into several files");
    if (elements_ / kItemsPerUpdate != (elements_ - count) / kItemsPerUpdate)
      flushElements();
  }

  void flushElements() {
    update();
    if (spool_ == nullptr)
      return;
    const std::uint32_t* nodes = mesh_.nodes.data();
    for (const CellRun& run : mesh_.runs) {
      spool_->cells[run.fileType] += run.count;
      if (run.type == CellType::Flat)
        continue;
      if (run.quadratic || run.nodesPerCell != SpooledMesh::cornersOf(run.type))
        refuseToSpool(source_.path, run.fileType);
      spool_->addCells(run.type, nodes, run.count);
      nodes += run.count * std::size_t(run.nodesPerCell);
    }
    mesh_.nodes.clear();
    mesh_.runs.clear();
  }

  void addNode(std::int64_t id) {
    if (kindsAlone_)
      return;
    const std::uint32_t index = nodeIds_.find(id);
    if (index == IdMap::kNone)
      in_.fail("element " + std::to_string(elements_ + 1) + " of the file uses node " +
                   std::to_string(id) + ", which does not exist",
               "the file is damaged; export it again");
    mesh_.nodes.push_back(index);
  }

  void numberElement(std::int64_t id) {
    if (wantsData())
      elementIds_.add(id);
  }

  void readElements1() {
    beginElements();
    const std::size_t n = in_.text.count("elements", 12);
    for (std::size_t i = 0; i < n; ++i) {
      numberElement(in_.text.integer());
      const CellKind& kind = kindOf(in_.text.integer());
      const std::int32_t physical = tag(in_.text.integer());
      const std::int32_t geometrical = tag(in_.text.integer());
      if (in_.text.integer() != kind.nodes)
        in_.fail("wrong number of nodes for the type", kExportWithGmsh);
      readNodesOf(kind);
      addElements(kind, 1, physical, geometrical);
    }
    elementIds_.finish();
  }

  void readNodesOf(const CellKind& kind) {
    for (std::uint32_t k = 0; k < kind.nodes; ++k) {
      const std::int64_t id = in_.text.integer();
      if (k < kind.stored())
        addNode(id);
    }
    if (!kindsAlone_)
      orderLast(mesh_, kind);
  }

  void readElements2() {
    beginElements();
    const std::int64_t declared = in_.text.integer();
    in_.text.line();
    in_.enterBinary();
    const std::size_t n = in_.checkCount(declared, "elements", 8, 8);
    for (std::size_t i = 0; i < n;)
      i += in_.binary ? readElementBlock2(n - i) : readElement2();
    elementIds_.finish();
  }

  std::size_t readElement2() {
    numberElement(in_.text.integer());
    const CellKind& kind = kindOf(in_.text.integer());
    const std::int64_t tags = in_.text.integer();
    std::int32_t values[2] = {0, 0};
    for (std::int64_t k = 0; k < tags; ++k) {
      const std::int64_t value = in_.text.integer();
      if (k < 2)
        values[k] = tag(value);
    }
    readNodesOf(kind);
    addElements(kind, 1, values[0], values[1]);
    return 1;
  }

  std::size_t readElementBlock2(std::size_t max) {
    const CellKind& kind = kindOf(in_.integer());
    const std::int64_t follow = in_.integer();
    const std::int64_t tags = in_.integer();
    if (follow < 1 || static_cast<std::uint64_t>(follow) > max || tags < 0 || tags > 1000000)
      in_.fail("an element block of impossible size", kExportWithGmsh);
    const auto skipped = static_cast<std::size_t>(tags);
    const std::size_t stride = 4 * (1 + skipped + kind.nodes);
    const std::size_t n = in_.bytes.checkCount(follow, stride, "elements");
    const std::size_t soon = spool_ != nullptr ? std::min(n, kItemsPerUpdate) : n;
    mesh_.nodes.reserve(mesh_.nodes.size() + std::size_t(kind.stored()) * (n > 1 ? soon : 0));
    std::int32_t physical = 0, geometrical = 0;
    std::size_t alike = 0; // elements not yet counted with these tags
    for (std::size_t i = 0; i < n; ++i) {
      const char* at = in_.bytes.take(stride).data();
      const auto number = [&](std::size_t k) {
        return loadNumber<std::int32_t>(at + 4 * k, in_.bytes.swap());
      };
      const std::int32_t first = skipped > 0 ? tag(number(1)) : 0;
      const std::int32_t second = skipped > 1 ? tag(number(2)) : 0;
      if (first != physical || second != geometrical || alike == kItemsPerUpdate) {
        addElements(kind, alike, physical, geometrical);
        physical = first;
        geometrical = second;
        alike = 0;
      }
      numberElement(number(0));
      for (std::uint32_t k = 0; k < kind.stored(); ++k)
        addNode(number(1 + skipped + k));
      if (!kindsAlone_)
        orderLast(mesh_, kind);
      ++alike;
    }
    addElements(kind, alike, physical, geometrical);
    return n;
  }

  void readElements4() {
    beginElements();
    in_.enterBinary();
    const bool old = version_ < 4.05;
    const std::size_t width = old ? 4 : in_.sizeBytes; // of a tag and a node number
    const std::size_t blocks = in_.count("element blocks", 8, 12 + in_.sizeBytes);
    const std::size_t total = in_.count("elements", 4, 2 * width);
    if (!old)
      in_.size(), in_.size(); // min and max tag
    std::size_t found = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::int64_t first = in_.integer();
      const std::int64_t second = in_.integer();
      const std::int64_t entity = old ? first : second;
      const CellKind& kind = kindOf(in_.integer());
      const std::size_t n =
          in_.count("elements", 2 * (1 + kind.nodes) - 1, width * (1 + kind.nodes));
      GmshVolumeTags tags{0, tag(entity)};
      if ((old ? second : first) == 3)
        if (const auto known = volumes_.find(entity); known != volumes_.end())
          tags = known->second;
      if (in_.binary && spool_ == nullptr)
        mesh_.nodes.reserve(mesh_.nodes.size() + n * std::size_t(kind.stored()));
      for (std::size_t done = 0; done < n; done += kItemsPerUpdate) {
        const std::size_t some = std::min(kItemsPerUpdate, n - done);
        if (in_.binary)
          readElementBlock4(kind, some, width);
        else
          for (std::size_t i = 0; i < some; ++i) {
            numberElement(in_.text.integer());
            readNodesOf(kind);
          }
        addElements(kind, some, tags.physical, tags.geometrical);
      }
      found += n;
    }
    if (found != total)
      in_.fail(std::to_string(total) + " elements are declared, " + std::to_string(found) +
                   " are there",
               kExportWithGmsh);
    elementIds_.finish();
  }

  void readElementBlock4(const CellKind& kind, std::size_t n, std::size_t width) {
    const std::string_view data = in_.bytes.take(n * width * (1 + kind.nodes));
    if (kindsAlone_)
      return;
    if (width == 8)
      copyElements<std::int64_t>(kind, n, data.data());
    else
      copyElements<std::int32_t>(kind, n, data.data());
  }

  template <class T>
  void copyElements(const CellKind& kind, std::size_t n, const char* from) {
    const bool swap = in_.bytes.swap();
    const std::size_t stride = sizeof(T) * (1 + kind.nodes);
    if (wantsData())
      for (std::size_t i = 0; i < n; ++i)
        elementIds_.add(loadNumber<T>(from + i * stride, swap));
    const std::size_t stored = kind.stored();
    const std::size_t before = mesh_.nodes.size();
    mesh_.nodes.resize(before + stored * n);
    std::uint32_t* to = mesh_.nodes.data() + before;
    for (std::size_t i = 0; i < n; ++i, from += stride) {
      for (std::size_t k = 0; k < stored; ++k) {
        const std::size_t place = 1 + (kind.order != nullptr ? kind.order[k] : k);
        const auto id = static_cast<std::int64_t>(loadNumber<T>(from + sizeof(T) * place, swap));
        const std::uint32_t index = nodeIds_.find(id);
        if (index == IdMap::kNone) {
          elements_ += i;
          addNode(id); // fails
        }
        *to++ = index;
      }
    }
  }

  void setRegions() {
    flushElements();
    bool physical = false;
    bool geometrical = false;
    for (const TagRun& run : tags_) {
      physical = physical || (run.solid && run.physical != 0);
      geometrical = geometrical || (run.solid && run.geometrical != 0);
    }
    if (!physical)
      mesh_.regionNames.clear();
    if (!physical && !geometrical)
      return;
    if (spool_ == nullptr)
      mesh_.regions.reserve(elements_);
    for (const TagRun& run : tags_) {
      const std::int32_t region = physical ? run.physical : run.geometrical;
      if (spool_ == nullptr)
        mesh_.regions.insert(mesh_.regions.end(), run.count, region);
      for (std::size_t i = 0; spool_ != nullptr && run.solid && i < run.count; ++i)
        spool_->regions.append(&region, sizeof region);
    }
  }

  void update() {
    source_.release();
    const std::size_t at = std::max(in_.text.position(), in_.bytes.position());
    progress_.update(static_cast<double>(at) / static_cast<double>(source_.bytes.size()));
  }

  const Source& source_;
  const ReadOptions& options_;
  SpooledMesh* spool_;
  Report& report_;
  Progress& progress_;
  GmshCursor in_;
  double version_ = 1;
  CellMesh mesh_;
  IdMap nodeIds_;
  IdMap elementIds_;
  std::size_t elements_ = 0;
  bool kindsAlone_ = false; ///< of hasSolidCells()
  bool haveNodes_ = false;
  bool haveElements_ = false;
  std::vector<TagRun> tags_;
  GmshVolumes volumes_;
  GmshData data_;
};

} // namespace

CellMesh readGmsh(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress) {
  return MshReader(source, options, nullptr, report, progress).read();
}

void spoolGmsh(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
               Progress& progress) {
  MshReader(source, options, &mesh, report, progress).read();
}

bool gmshHasSolidCells(const Source& source, Report& report, Progress& progress) {
  ReadOptions options;
  options.attributes = false;
  return MshReader(source, options, nullptr, report, progress).hasSolidCells();
}

} // namespace tetvdb
