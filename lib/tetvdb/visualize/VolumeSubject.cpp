// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/VolumeSubject.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/visualize/GridSpace.h"
#include "tetvdb/visualize/VolumeLook.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::array<const char*, 4> kShapes = {"surface", "density", "coverage", "mask"};
constexpr int kMaxVoxelsAsVoxels = 128; ///< along the longest side
constexpr std::size_t kMaxMaterials = 256;

// The numbers of the active voxels, ascending; none where they are too many to be told apart.
std::vector<std::int32_t> materialsOf(const openvdb::Int32Tree& tree) {
  std::set<std::int32_t> found;
  std::int32_t last = 0;
  for (auto value = tree.cbeginValueOn(); value && found.size() <= kMaxMaterials; ++value) {
    if (!found.empty() && *value == last)
      continue;
    last = *value;
    found.insert(last);
  }
  if (found.size() > kMaxMaterials)
    return {};
  return {found.begin(), found.end()};
}

class VolumeSubject : public Subject {
public:
  VolumeSubject(Volume volume, const VolumeShow& show) : volume_(std::move(volume)), show_(show) {
    infos_ = describe(volume_);
    shape_ = show.grid.empty() ? mainGrid() : named(show.grid, "`grid`");
    if (infos_[shape_].activeVoxels == 0)
      throw Error(Status::Invalid, infos_[shape_].name, "holds no active voxels");
    const bool isShape =
        std::find(kShapes.begin(), kShapes.end(), infos_[shape_].name) != kShapes.end();
    if (show.plainColor)
      color_ = std::nullopt;
    else if (!show.color.empty())
      color_ = named(show.color, "`color`");
    else if (infos_[shape_].minValue < infos_[shape_].maxValue &&
             (!isShape || show.style == VolumeStyle::Slice)) // one value needs no legend
      color_ = shape_;
    if (color_ && infos_[*color_].name == "material" && grid(*color_)->isType<openvdb::Int32Grid>())
      materials_ = materialsOf(static_cast<const openvdb::Int32Grid&>(*grid(*color_)).constTree());
    const GridInfo& info = infos_[shape_];
    const GridSpace space(grid(shape_)->transform());
    bounds_ = space.bounds(info.boxMin, info.boxMax);
    style_ = show.style == VolumeStyle::Auto ? styleFor(info) : show.style;
    if (style_ == VolumeStyle::Slice) {
      const auto axis = static_cast<std::size_t>(show.slice.axis);
      const double low = bounds_.low[axis], high = bounds_.high[axis];
      place_ = show.slice.inUnits ? show.slice.at : low + show.slice.at * (high - low);
      if (!(place_ >= low && place_ <= high))
        throw Error(Status::Usage, "`slice`",
                    "lies outside of the volume, which spans " + std::to_string(low) + " to " +
                        std::to_string(high) + " along that axis");
    }
  }

  Box bounds() const override {
    Box box = bounds_;
    if (style_ == VolumeStyle::Slice) {
      const auto axis = static_cast<std::size_t>(show_.slice.axis);
      box.low[axis] = box.high[axis] = place_;
    }
    return box;
  }

  std::optional<ColorScale> scale() const override {
    if (!color_)
      return std::nullopt;
    const GridInfo& info = infos_[*color_];
    ColorScale scale;
    if (!materials_.empty()) {
      scale.title = info.name;
      for (const std::int32_t material : materials_)
        scale.kinds.push_back(std::to_string(material));
      return scale;
    }
    scale.low = info.minValue;
    scale.high = info.maxValue;
    if (!(scale.low < scale.high)) { // one value, or none that is a number
      scale.low = std::isfinite(info.minValue) ? info.minValue : 0;
      scale.high = scale.low + 1;
    }
    scale.map = &ColorMap::named("viridis");
    scale.title = info.name;
    return scale;
  }

  Drawn draw(const ColorScale* scale, const std::optional<CutPlane>& cut,
             Progress& progress) override {
    GridPaint paint;
    paint.plain = show_.plain;
    if (color_ && scale != nullptr) {
      paint.grid = grid(*color_);
      if (materials_.empty())
        paint.colorOf = [colors = *scale](double value) { return colors(value); };
      else
        paint.colorOf = [colors = *scale, materials = materials_](double value) {
          const auto at = std::lower_bound(materials.begin(), materials.end(), value);
          return colors(static_cast<double>(at - materials.begin()));
        };
    }
    Drawn drawn;
    const openvdb::GridBase::ConstPtr shape = grid(shape_);
    if (style_ == VolumeStyle::Fog) {
      FogLook look;
      look.paint = paint;
      look.cut = cut;
      const double max = infos_[shape_].maxValue;
      look.depth /= max > 0 && std::isfinite(max) ? max : 1; // so much at the greatest value
      if (!color_)
        look.paint.plain = {0.9F, 0.9F, 0.9F};
      drawn.media.push_back(drawFog(shape, look, progress));
      return drawn;
    }
    VolumeLook look;
    look.paint = paint;
    look.cut = cut;
    if (style_ == VolumeStyle::Slice)
      drawn.drawables.push_back(drawSlice(shape, show_.slice.axis, place_, look));
    else if (style_ == VolumeStyle::Voxels)
      drawn.drawables.push_back(drawVoxels(shape, look));
    else
      drawn.drawables.push_back(drawSurface(shape, look));
    return drawn;
  }

private:
  openvdb::GridBase::ConstPtr grid(std::size_t i) const { return volume_.grids().all[i]; }

  std::size_t mainGrid() const {
    if (infos_.empty())
      throw Error(Status::Invalid, "", "holds no grids");
    for (const char* name : kShapes)
      for (std::size_t i = 0; i < infos_.size(); ++i)
        if (infos_[i].name == name && infos_[i].activeVoxels > 0)
          return i;
    return 0;
  }

  // "stress:mises" is the grid "stress.mises", as it is when arrays become grids.
  std::size_t named(const std::string& name, const char* option) const {
    std::string dotted = name;
    if (const auto colon = dotted.rfind(':'); colon != std::string::npos)
      dotted[colon] = '.';
    for (const std::string& sought : {name, dotted})
      for (std::size_t i = 0; i < infos_.size(); ++i)
        if (infos_[i].name == sought)
          return i;
    std::vector<std::string> names;
    std::string list;
    for (std::size_t i = 0; i < infos_.size(); ++i) {
      names.push_back(infos_[i].name);
      list += (list.empty() ? "it has " : ", ") + infos_[i].name;
    }
    throw Error(Status::Usage, option, "the volume has no grid '" + name + "'",
                suggestName(name, names, list.empty() ? "it holds none" : list));
  }

  static VolumeStyle styleFor(const GridInfo& info) {
    if (info.gridClass == "level set")
      return VolumeStyle::Surface;
    std::int64_t longest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      longest = std::max(longest, std::int64_t(info.boxMax[a]) - info.boxMin[a] + 1);
    return longest <= kMaxVoxelsAsVoxels ? VolumeStyle::Voxels : VolumeStyle::Surface;
  }

  Volume volume_;
  VolumeShow show_;
  std::vector<GridInfo> infos_;
  std::size_t shape_ = 0;
  std::optional<std::size_t> color_;
  std::vector<std::int32_t>
      materials_; ///< that are told apart, where the colours are such a grid's
  VolumeStyle style_ = VolumeStyle::Voxels;
  Box bounds_;
  double place_ = 0; ///< of a slice, world units
};

} // namespace

std::unique_ptr<Subject> subjectOf(Volume volume, const VolumeShow& show) {
  return std::make_unique<VolumeSubject>(std::move(volume), show);
}

} // namespace tetvdb
