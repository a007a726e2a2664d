// SPDX-License-Identifier: Apache-2.0
//
// Format: 3MF Consortium, "3D Manufacturing Format Core Specification" and "Production Extension".
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
    } else if (name == "beam" && parent == "beams") {
      ++model_.beams;
    }
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
};

} // namespace

ThreeMfModel parseThreeMfModel(std::string_view text, const std::string& path, Progress& progress) {
  return ModelParser(text, path, progress).parse();
}

} // namespace tetvdb
