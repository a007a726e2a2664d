// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification", "Production Extension" and
// "Beam Lattice Extension".
#include "tetvdb/io/formats/threemf/ThreeMfModel.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/text/XmlScanner.h"

#include <cmath>
#include <utility>

namespace tetvdb {
namespace {

/// Text of an attribute, whose five named entities represent characters.
std::string unescaped(std::string_view text) {
  constexpr std::pair<std::string_view, char> entities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string result;
  while (!text.empty()) {
    std::size_t used = 1;
    char c = text.front();
    for (const auto& [entity, character] : entities)
      if (text.substr(0, entity.size()) == entity) {
        used = entity.size();
        c = character;
      }
    result += c;
    text.remove_prefix(used);
  }
  return result;
}

class ModelParser {
public:
  ModelParser(std::string_view text, const std::string& path, Progress& progress)
      : text_(text), progress_(progress), in_(text, path) {}

  ThreeMfModel parse() {
    bool isModel = false;
    for (std::size_t tags = 0; in_.next(); ++tags) {
      if (tags % kItemsPerUpdate == 0)
        progress_.update(static_cast<double>(in_.position()) / static_cast<double>(text_.size()));
      if (!in_.begins())
        continue;
      if (in_.name() == "model" && in_.around(1).empty()) {
        isModel = true;
        model_.units = units(in_.attribute("unit"));
      } else {
        readElement();
      }
    }
    if (!isModel)
      in_.fail("it holds no 3MF model");
    return std::move(model_);
  }

private:
  /// Extensions use the same names in other contexts.
  void readElement() {
    const std::string_view name = in_.name(), parent = in_.around(1);
    if (name == "vertex" && parent == "vertices" && in_.around(2) == "mesh") {
      if (object_ != nullptr)
        object_->points.push_back({real("x"), real("y"), real("z")});
    } else if (name == "triangle" && parent == "triangles" && in_.around(2) == "mesh") {
      if (object_ != nullptr)
        for (const char* corner : {"v1", "v2", "v3"})
          object_->triangles.push_back(index(corner));
    } else if (name == "object" && parent == "resources") {
      object_ = &model_.objects[std::string(in_.attribute("id"))];
      *object_ = {};
      object_->name = unescaped(in_.attribute("name"));
    } else if ((name == "mesh" || name == "components") && parent == "object") {
      if (object_ != nullptr)
        object_->known = true;
    } else if (name == "component" && parent == "components") {
      if (object_ != nullptr)
        object_->components.push_back(reference());
    } else if (name == "item" && parent == "build") {
      model_.items.push_back(reference());
    } else if (object_ != nullptr && in_.around(2) == "beamlattice") {
      readLattice(name, parent);
    } else if (object_ != nullptr && name == "beamlattice" && parent == "mesh") {
      beginLattice();
    }
  }

  void beginLattice() {
    BeamLattice& lattice = object_->lattice;
    // The first files have other names for two attributes.
    const auto either = [&](const char* name, const char* earlier) {
      const std::string_view value = in_.attribute(name);
      return value.empty() ? in_.attribute(earlier) : value;
    };
    const std::string_view clipping = either("clippingmode", "clipping");
    lattice.clipped = !clipping.empty() && clipping != "none";
    lattice.representation = either("representationmesh", "representation");
    radius_ = real("radius");
    cap_ = capOf("cap", BeamCap::Sphere);
    ballRadius_ = real("ballradius");
    ballsEverywhere_ = in_.attribute("ballmode") == "all";
  }

  /// The elements of a lattice's lists.
  void readLattice(std::string_view name, std::string_view parent) {
    const auto realOr = [&](const char* attribute, double other) {
      return in_.attribute(attribute).empty() ? other : real(attribute);
    };
    BeamLattice& lattice = object_->lattice;
    if (name == "beam" && parent == "beams") {
      Beam beam;
      beam.ends = {index("v1"), index("v2")};
      beam.radius[0] = realOr("r1", radius_);
      beam.radius[1] = realOr("r2", beam.radius[0]);
      beam.cap = {capOf("cap1", cap_), capOf("cap2", cap_)};
      lattice.beams.push_back(beam);
      if (ballsEverywhere_)
        for (const std::uint32_t end : beam.ends)
          lattice.balls.push_back({end, ballRadius_});
    } else if (name == "ball" && parent == "balls") {
      lattice.balls.push_back({index("vindex"), realOr("r", ballRadius_)});
    }
  }

  BeamCap capOf(const char* attribute, BeamCap other) const {
    const std::string_view cap = in_.attribute(attribute);
    return cap == "sphere"       ? BeamCap::Sphere
           : cap == "hemisphere" ? BeamCap::Hemisphere
           : cap == "butt"       ? BeamCap::Butt
                                 : other;
  }

  static std::string units(std::string_view name) {
    constexpr std::pair<std::string_view, const char*> names[] = {{"micron", "micrometre"},
                                                                  {"centimeter", "centimetre"},
                                                                  {"inch", "inch"},
                                                                  {"foot", "foot"},
                                                                  {"meter", "metre"}};
    for (const auto& [theirs, ours] : names)
      if (name == theirs)
        return ours;
    return "millimetre"; // the default
  }

  double real(std::string_view name) const {
    NumberParser number(in_.attribute(name), "");
    double value = 0;
    return number.tryReal(value) && number.atEnd() ? value : NAN;
  }
  std::uint32_t index(std::string_view name) const {
    NumberParser number(in_.attribute(name), "");
    std::int64_t value = 0;
    return number.tryInteger(value) && number.atEnd() && value >= 0 && value < FaceCollector::kNone
               ? static_cast<std::uint32_t>(value)
               : FaceCollector::kNone;
  }

  ThreeMfReference reference() const {
    ThreeMfReference result;
    result.object = in_.attribute("objectid");
    result.path = in_.attribute("path");
    const std::string_view transform = in_.attribute("transform");
    NumberParser numbers(transform, "");
    if (numbers.atEnd())
      return result;
    // Matrices in the file multiply row vectors: rows are columns here.
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t i = 0; i < 3; ++i) {
        double& value = result.placement.rows[i][j];
        if (!numbers.tryReal(value) || !std::isfinite(value))
          in_.fail("a transform is not twelve finite numbers");
      }
    if (!numbers.atEnd())
      in_.fail("a transform is not twelve finite numbers");
    return result;
  }

  std::string_view text_;
  Progress& progress_;
  XmlScanner in_;
  ThreeMfModel model_;
  ThreeMfObject* object_ = nullptr; ///< the current object
  // Of its lattice, for beams and balls without their own.
  double radius_ = 0, ballRadius_ = 0;
  BeamCap cap_ = BeamCap::Sphere;
  bool ballsEverywhere_ = false;
};

} // namespace

ThreeMfModel parseThreeMfModel(std::string_view text, const std::string& path, Progress& progress) {
  return ModelParser(text, path, progress).parse();
}

} // namespace tetvdb
