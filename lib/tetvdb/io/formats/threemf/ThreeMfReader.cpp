// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification"; the archive follows the
// Open Packaging Conventions. lib3mf is not used: it refuses files with a face that names a point
// twice or a coordinate beyond 1e9, rounds to floats, and does not terminate for nested components.
#include "tetvdb/io/formats/threemf/ThreeMfReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/formats/threemf/ThreeMfModel.h"
#include "tetvdb/io/text/XmlScanner.h"
#include "tetvdb/io/text/ZipDirectory.h"

#include <map>
#include <utility>

namespace tetvdb {
namespace {

/// Names in archives: without the first slash, any case.
std::string normalized(std::string_view name) {
  return lowerCase(name.substr(name.substr(0, 1) == "/" ? 1 : 0));
}

class Package {
public:
  Package(const Source& source, Progress& progress)
      : source_(source), progress_(progress), faces_(source.path) {
    const std::vector<ZipEntry> entries = readZipDirectory(source);
    checkZipSizes(entries, source);
    for (const ZipEntry& entry : entries)
      entries_.emplace(normalized(entry.name), entry);
  }

  TriangleMesh read(Report& report, std::vector<MeshPart>& parts) {
    const std::string root = rootPath();
    const ThreeMfModel* start = model(root);
    if (start == nullptr)
      throw Error(Status::Invalid, source_.path, "there is no 3MF model in the archive",
                  "export it again");
    if (start->items.empty())
      throw Error(Status::Invalid, source_.path, "its build is empty: it places no object",
                  "place the parts on the build plate and export it again");
    for (const ThreeMfReference& item : start->items) {
      item_ = static_cast<std::size_t>(&item - start->items.data());
      place(item, root, Placement{}, 0);
    }
    if (missing_ > 0) {
      report.warn("missing-objects", std::to_string(missing_) +
                                         " placed objects were left out: they do not exist or "
                                         "hold neither a mesh nor components");
      report.partial = true;
    }
    if (invalidBeams_ > 0)
      report.warn("beams",
                  std::to_string(invalidBeams_) +
                      " beams and balls of lattices were left out: they have no radius above "
                      "0, or an end that is not a vertex");
    if (unclippedBeams_ > 0)
      report.warn("beams", std::to_string(unclippedBeams_) +
                               " beams of lattices are whole, which the file clips by another "
                               "object; use a program that writes the lattice as a mesh");
    report.partial = report.partial || invalidBeams_ > 0 || unclippedBeams_ > 0;
    TriangleMesh mesh = faces_.finish(report);
    mesh.units = start->units;
    parts = std::move(parts_);
    return mesh;
  }

private:
  /// The package's relations name its model.
  std::string rootPath() {
    const auto relations = entries_.find("_rels/.rels");
    if (relations != entries_.end()) {
      const std::string text = unpackZipEntry(relations->second, source_, progress_);
      XmlScanner in(text, source_.path + ", _rels/.rels");
      while (in.next()) {
        const std::string_view type = in.attribute("Type");
        constexpr std::string_view ending = "/3dmodel";
        if (in.begins() && in.name() == "Relationship" && type.size() > ending.size() &&
            type.substr(type.size() - ending.size()) == ending)
          return normalized(in.attribute("Target"));
      }
    }
    return "3d/3dmodel.model"; // the usual path
  }

  const ThreeMfModel* model(const std::string& path) {
    if (const auto known = models_.find(path); known != models_.end())
      return &known->second;
    const auto entry = entries_.find(path);
    if (entry == entries_.end())
      return nullptr;
    const std::string text = unpackZipEntry(entry->second, source_, progress_);
    ThreeMfModel parsed =
        parseThreeMfModel(text, source_.path + ", " + entry->second.name, progress_);
    return &models_.emplace(path, std::move(parsed)).first->second;
  }

  void place(const ThreeMfReference& reference, const std::string& path, const Placement& outer,
             std::size_t depth) {
    faces_.countPlacement(depth);
    const std::string inside = reference.path.empty() ? path : normalized(reference.path);
    const ThreeMfModel* part = model(inside);
    const ThreeMfObject* object = nullptr;
    if (part != nullptr)
      if (const auto found = part->objects.find(reference.object); found != part->objects.end())
        object = &found->second;
    if (object == nullptr || !object->known) {
      ++missing_;
      return;
    }
    const Placement placement = outer * reference.placement;
    if (depth == 0)
      itemName_ = object->name;
    if (!object->triangles.empty() || !object->lattice.isEmpty())
      parts_.push_back({object->name, faces_.pointCount(), item_, itemName_});
    if (!object->triangles.empty() || object->lattice.isEmpty())
      addMesh(object->points, object->triangles, placement);
    addLattice(*object, *part, placement);
    for (const ThreeMfReference& component : object->components)
      place(component, inside, placement, depth + 1);
  }

  void addMesh(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& triangles,
               const Placement& placement) {
    faces_.addMesh(placement, points, triangles, source_.bytes.size());
    progress_.check();
  }

  void addLattice(const ThreeMfObject& object, const ThreeMfModel& part,
                  const Placement& placement) {
    const BeamLattice& lattice = object.lattice;
    if (lattice.isEmpty())
      return;
    const auto shown = lattice.representation.empty() ? part.objects.end()
                                                      : part.objects.find(lattice.representation);
    if (shown != part.objects.end() && !shown->second.triangles.empty()) {
      addMesh(shown->second.points, shown->second.triangles, placement);
      return;
    }
    const LatticeFaces made = facesOfLattice(lattice, object.points, source_.path);
    invalidBeams_ += made.invalid;
    unclippedBeams_ += lattice.clipped ? lattice.beams.size() : 0;
    addMesh(made.points, made.triangles, placement);
  }

  const Source& source_;
  Progress& progress_;
  PlacedFaces faces_;
  std::map<std::string, ZipEntry, std::less<>> entries_; ///< by normalized name
  std::map<std::string, ThreeMfModel, std::less<>> models_;
  std::vector<MeshPart> parts_;
  std::size_t item_ = 0; ///< of the build: the one that is being placed
  std::string itemName_;
  std::size_t missing_ = 0;
  std::uint64_t invalidBeams_ = 0, unclippedBeams_ = 0;
};

} // namespace

TriangleMesh readThreeMf(const Source& source, Report& report, Progress& progress) {
  std::vector<MeshPart> parts;
  return readThreeMfParts(source, parts, report, progress);
}

TriangleMesh readThreeMfParts(const Source& source, std::vector<MeshPart>& parts, Report& report,
                              Progress& progress) {
  return Package(source, progress).read(report, parts);
}

} // namespace tetvdb
