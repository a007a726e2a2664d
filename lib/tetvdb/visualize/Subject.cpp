// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Subject.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/visualize/DefectMarks.h"
#include "tetvdb/visualize/LineDrawable.h"
#include "tetvdb/visualize/TetSkin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kDefectPixels = 3;
// Energies are shown from that of the regular tet to three times that at which meshers stop.
constexpr double kBestEnergy = 3, kPoorEnergy = 30;

class TriangleSubject : public Subject {
public:
  TriangleSubject(TriangleMesh mesh, const MeshLook& look)
      : mesh_(std::move(mesh)), look_(look), box_(boxOf(mesh_.points, mesh_.triangles)) {
    if (!look.color.empty())
      throw Error(Status::Usage, "",
                  "triangles have no values to colour them by '" + look.color + "'",
                  "colours are for tets and volumes");
  }

  Box bounds() const override { return box_; }

  Drawn draw(const ColorScale*, const std::optional<CutPlane>& cut, Progress& progress) override {
    Drawn drawn;
    drawn.triangles = mesh_.triangleCount();
    TriangleLook look;
    look.color = look_.plain;
    look.smooth = look_.smooth;
    look.wire = look_.wire;
    look.cut = cut;
    if (cut)
      look.closure = closureOf(mesh_, progress);
    std::vector<Line> lines;
    if (look_.defects) {
      DefectMarks marks = markDefects(mesh_, progress);
      look.marked = std::move(marks.flipped);
      lines = std::move(marks.lines);
      drawn.openEdges = marks.openEdges;
      drawn.nonManifoldEdges = marks.nonManifoldEdges;
      drawn.flippedFaces = marks.flippedFaces;
      if (cut)
        lines.erase(std::remove_if(lines.begin(), lines.end(),
                                   [&](const Line& line) { return isBeyond(*cut, line); }),
                    lines.end());
    }
    drawn.drawables.push_back(
        std::make_shared<TriangleDrawable>(std::move(mesh_), std::move(look), progress));
    if (!lines.empty())
      drawn.drawables.push_back(std::make_shared<LineDrawable>(std::move(lines), kDefectPixels));
    return drawn;
  }

private:
  static bool isBeyond(const CutPlane& cut, const Line& line) {
    const auto side = [&](const Vec3d& p) {
      return p[0] * cut.normal[0] + p[1] * cut.normal[1] + p[2] * cut.normal[2] - cut.offset;
    };
    return side(line.from) > 0 || side(line.to) > 0;
  }

  TriangleMesh mesh_;
  MeshLook look_;
  Box box_;
};

class TetSubject : public Subject {
public:
  TetSubject(TetMesh mesh, const MeshLook& look)
      : mesh_(std::move(mesh)), look_(look), box_(boxOf(mesh_.points, mesh_.tets)) {
    if (look.defects)
      throw Error(Status::Usage, "", "defects are those of triangles; the mesh has tets",
                  "colour them by their quality");
    if (look.color == "quality")
      takeQuality();
    else if ((look.color == "region" || look.color == "material") && find(look.color) == nullptr)
      takeRegions();
    else if (!look.color.empty())
      takeArray();
    std::vector<Attribute>().swap(mesh_.attributes);
  }

  Box bounds() const override { return box_; }

  std::optional<ColorScale> scale() const override {
    if (values_.on == SurfaceValues::On::Nothing)
      return std::nullopt;
    return values_.scale;
  }

  Drawn draw(const ColorScale* scale, const std::optional<CutPlane>& cut,
             Progress& progress) override {
    Drawn drawn;
    TetSkin skin = tetSkin(mesh_, cut, look_.shrink, progress);
    if (skin.mesh.triangles.empty())
      throw Error(Status::Invalid, "", "the cut leaves nothing of the mesh",
                  "move it within the box");
    drawn.triangles = skin.mesh.triangleCount();
    drawn.cutTets = skin.cutTets;
    TriangleLook look;
    look.color = look_.plain;
    look.smooth = look_.smooth;
    look.wire = look_.wire;
    if (scale != nullptr)
      values_.scale = *scale;
    look.values = skin.values(values_);
    values_ = {};
    mesh_ = {};
    TriangleMesh shown = std::move(skin.mesh);
    skin = {};
    drawn.drawables.push_back(
        std::make_shared<TriangleDrawable>(std::move(shown), std::move(look), progress));
    return drawn;
  }

private:
  const Attribute* find(const std::string& name) const {
    for (const Attribute& attribute : mesh_.attributes)
      if (attribute.name == name)
        return &attribute;
    return nullptr;
  }

  void takeQuality() {
    values_.on = SurfaceValues::On::Faces;
    values_.values = tetEnergies(mesh_);
    values_.scale.map = &ColorMap::named("viridis_r"); // good is bright
    values_.scale.title = "AMIPS energy";
    values_.scale.low = kBestEnergy;
    values_.scale.high = kPoorEnergy;
    values_.scale.logarithmic = true;
  }

  void takeRegions() {
    if (mesh_.regions.empty())
      throw Error(Status::Usage, "", "the mesh has no regions to colour");
    std::map<std::int32_t, std::size_t> kinds;
    for (const std::int32_t region : mesh_.regions)
      kinds.emplace(region, 0);
    ColorScale& scale = values_.scale;
    scale.title = "region";
    for (auto& [region, kind] : kinds) {
      kind = scale.kinds.size();
      const auto name = mesh_.regionNames.find(region);
      scale.kinds.push_back(name != mesh_.regionNames.end() ? name->second
                                                            : std::to_string(region));
    }
    values_.on = SurfaceValues::On::Faces;
    values_.values.resize(mesh_.tetCount());
    for (std::size_t tet = 0; tet < mesh_.tetCount(); ++tet)
      values_.values[tet] = static_cast<float>(kinds[mesh_.regions[mesh_.cell(tet)]]);
  }

  std::vector<Field> resolve(FieldPart part) const {
    FieldOptions wanted;
    wanted.requests.push_back({look_.color, look_.color, part, ""});
    Report told; // of names that points and cells have, and of values that are not finite
    try {
      return resolveFields(mesh_, wanted, told);
    } catch (const Error& error) {
      const std::vector<std::string> others = {"quality", "region"};
      if (error.status() != Status::Usage || closestName(look_.color, others).empty())
        throw;
      throw Error(Status::Usage, "", "the mesh has no array '" + look_.color + "'",
                  suggestName(look_.color, others, ""));
    }
  }

  // What --grid makes of the same name, vectors and other tuples by their length.
  void takeArray() {
    std::vector<Field> fields = resolve(FieldPart::Whole);
    const bool byLength = fields.size() > 1 || fields.front().kind == FieldKind::Vector;
    if (byLength)
      fields = resolve(FieldPart::Magnitude);
    const Field& field = fields.front();
    const FieldRule rule = field.rule();
    const bool onPoints = field.on == Attribute::On::Points;
    values_.on = onPoints ? SurfaceValues::On::Points : SurfaceValues::On::Faces;
    values_.values.resize(onPoints ? mesh_.points.size() : mesh_.tetCount());
    double read[FieldRule::kMaxNumbers], value[3];
    for (std::size_t i = 0; i < values_.values.size(); ++i) {
      for (std::size_t k = 0; k < field.sources.size(); ++k)
        read[k] = field.sources[k].array->number(onPoints ? i : mesh_.cell(i),
                                                 field.sources[k].component);
      rule.derive(read, value);
      values_.values[i] = static_cast<float>(value[0]);
    }
    ColorScale& scale = values_.scale;
    scale.map = &ColorMap::named("viridis");
    scale.title = byLength ? "|" + field.array + "|" : field.name;
    scale.low = INFINITY;
    scale.high = -INFINITY;
    for (const float number : values_.values)
      if (std::isfinite(number)) {
        scale.low = std::min(scale.low, double(number));
        scale.high = std::max(scale.high, double(number));
      }
    if (!(scale.low <= scale.high))
      scale.low = scale.high = 0;
  }

  TetMesh mesh_;
  MeshLook look_;
  Box box_;
  SurfaceValues values_; ///< over tets (On::Faces) or points
};

} // namespace

std::unique_ptr<Subject> subjectOf(TriangleMesh mesh, const MeshLook& look) {
  return std::make_unique<TriangleSubject>(std::move(mesh), look);
}

std::unique_ptr<Subject> subjectOf(TetMesh mesh, const MeshLook& look) {
  return std::make_unique<TetSubject>(std::move(mesh), look);
}

} // namespace tetvdb
