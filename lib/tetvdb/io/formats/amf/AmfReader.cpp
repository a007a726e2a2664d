// SPDX-License-Identifier: Apache-2.0
//
// Format: ISO/ASTM 52915, "Specification for Additive Manufacturing File Format (AMF)"; of
// PrusaSlicer's extensions the scale and mirror of an instance.
#include "tetvdb/io/formats/amf/AmfReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/PlacedFaces.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/text/XmlScanner.h"
#include "tetvdb/io/text/ZipDirectory.h"

#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

/// Scaled, then rotated about x, y and z, then moved.
struct Instance {
  std::string object; ///< of an object or a constellation
  std::array<double, 3> scale{1, 1, 1}, degrees{0, 0, 0}, shift{0, 0, 0};

  Placement placement() const {
    Placement all;
    for (std::size_t k = 0; k < 3; ++k)
      all.rows[k][k] = scale[k];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
      const double angle = degrees[axis] * kPi / 180, c = std::cos(angle), s = std::sin(angle);
      Placement turn;
      turn.rows[u][u] = turn.rows[v][v] = c;
      turn.rows[u][v] = -s;
      turn.rows[v][u] = s;
      all = turn * all;
    }
    for (std::size_t k = 0; k < 3; ++k)
      all.rows[k][3] = shift[k];
    return all;
  }
};

struct Object {
  std::vector<Vec3d> points; ///< NAN where they cannot be read
  std::vector<std::uint32_t> triangles;
};

class AmfFile {
public:
  AmfFile(std::string_view text, const Source& source, const std::string& path, Progress& progress)
      : text_(text), source_(source), progress_(progress), in_(text, path), faces_(source.path) {}

  TriangleMesh read(Report& report) {
    parse();
    std::set<std::string, std::less<>> placed;
    for (const auto& [id, instances] : constellations_)
      for (const Instance& instance : instances)
        placed.insert(instance.object);
    for (const auto& [id, instances] : constellations_)
      if (placed.count(id) == 0)
        place(id, {}, 0);
    for (const auto& [id, object] : objects_)
      if (placed.count(id) == 0)
        addMesh(object, {});
    if (missing_ > 0) {
      report.warn("missing-objects",
                  std::to_string(missing_) + " placed objects were left out: they do not exist");
      report.partial = true;
    }
    TriangleMesh mesh = faces_.finish(report);
    mesh.units = units_;
    return mesh;
  }

private:
  void parse() {
    bool isAmf = false;
    for (std::size_t tags = 0; in_.next(); ++tags) {
      if (tags % kItemsPerUpdate == 0)
        progress_.update(static_cast<double>(in_.position()) / static_cast<double>(text_.size()));
      if (!in_.begins())
        continue;
      if (lowerCase(in_.name()) == "amf" && in_.around(1).empty()) {
        isAmf = true;
        units_ = units(in_.attribute("unit"));
      } else {
        readElement();
      }
    }
    if (!isAmf)
      in_.fail("it holds no AMF model");
  }

  void readElement() {
    const std::string_view name = in_.name(), parent = in_.around(1);
    if (name == "object") {
      object_ = &objects_[std::string(in_.attribute("id"))];
      *object_ = {};
    } else if (name == "constellation") {
      constellation_ = &constellations_[std::string(in_.attribute("id"))];
    } else if (name == "instance" && parent == "constellation" && constellation_ != nullptr) {
      constellation_->emplace_back().object = in_.attribute("objectid");
    } else if (parent == "instance" && constellation_ != nullptr && !constellation_->empty()) {
      readPlacement(name, constellation_->back());
    } else if (object_ != nullptr) {
      readMesh(name, parent);
    }
  }

  void readMesh(std::string_view name, std::string_view parent) {
    if (name == "coordinates" && parent == "vertex") {
      object_->points.push_back({NAN, NAN, NAN});
    } else if (parent == "coordinates" && name.size() == 1 && name[0] >= 'x' && name[0] <= 'z') {
      if (!object_->points.empty())
        object_->points.back()[static_cast<std::size_t>(name[0] - 'x')] = real();
    } else if (name == "triangle" && parent == "volume") {
      object_->triangles.insert(object_->triangles.end(), 3, FaceCollector::kNone);
    } else if (parent == "triangle" && name.size() == 2 && name[0] == 'v' && name[1] >= '1' &&
               name[1] <= '3' && !object_->triangles.empty()) {
      NumberParser number(in_.text(), "");
      std::int64_t value = 0;
      if (number.tryInteger(value) && value >= 0 && value < FaceCollector::kNone)
        object_
            ->triangles[object_->triangles.size() - 3 + static_cast<std::size_t>(name[1] - '1')] =
            static_cast<std::uint32_t>(value);
    }
  }

  void readPlacement(std::string_view name, Instance& instance) {
    if (name == "scale") {
      for (double& factor : instance.scale)
        factor *= finite(name);
      return;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const char axis = "xyz"[k];
      if (name == std::string("delta") + axis)
        instance.shift[k] = finite(name);
      else if (name == std::string("r") + axis)
        instance.degrees[k] = finite(name);
      else if (name == std::string("scale") + axis || name == std::string("mirror") + axis)
        instance.scale[k] *= finite(name);
    }
  }

  double real() const {
    NumberParser number(in_.text(), "");
    double value = 0;
    return number.tryReal(value) ? value : NAN;
  }
  double finite(std::string_view name) const {
    const double value = real();
    if (!std::isfinite(value))
      in_.fail("the " + std::string(name) + " of an instance is not a finite number");
    return value;
  }

  static std::string units(std::string_view name) {
    constexpr std::pair<std::string_view, const char*> names[] = {
        {"micron", "micrometre"}, {"inch", "inch"}, {"feet", "foot"}, {"meter", "metre"}};
    for (const auto& [theirs, ours] : names)
      if (name == theirs)
        return ours;
    return "millimetre"; // the default
  }

  void place(const std::string& id, const Placement& outer, std::size_t depth) {
    faces_.countPlacement(depth);
    if (const auto object = objects_.find(id); object != objects_.end()) {
      addMesh(object->second, outer);
      return;
    }
    const auto constellation = constellations_.find(id);
    if (constellation == constellations_.end()) {
      ++missing_;
      return;
    }
    for (const Instance& instance : constellation->second)
      place(instance.object, outer * instance.placement(), depth + 1);
  }

  void addMesh(const Object& object, const Placement& placement) {
    faces_.addMesh(placement, object.points, object.triangles, source_.bytes.size());
    progress_.check();
  }

  std::string_view text_;
  const Source& source_;
  Progress& progress_;
  XmlScanner in_;
  PlacedFaces faces_;
  std::string units_;
  std::map<std::string, Object, std::less<>> objects_;
  std::map<std::string, std::vector<Instance>, std::less<>> constellations_;
  Object* object_ = nullptr; ///< the current ones
  std::vector<Instance>* constellation_ = nullptr;
  std::size_t missing_ = 0;
};

} // namespace

TriangleMesh readAmf(const Source& source, Report& report, Progress& progress) {
  if (source.bytes.substr(0, 2) != "PK")
    return AmfFile(source.bytes, source, source.path, progress).read(report);
  const std::vector<ZipEntry> entries = readZipDirectory(source);
  checkZipSizes(entries, source);
  for (const ZipEntry& entry : entries) {
    const std::string name = lowerCase(entry.name);
    if (name.size() > 4 && name.compare(name.size() - 4, 4, ".amf") == 0) {
      const std::string text = unpackZipEntry(entry, source, progress);
      return AmfFile(text, source, source.path + ", " + entry.name, progress).read(report);
    }
  }
  throw Error(Status::Invalid, source.path, "there is no AMF model in the archive",
              "export it again");
}

} // namespace tetvdb
