// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/ComparePicture.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/visualize/GridSpace.h"
#include "tetvdb/visualize/GridValues.h"
#include "tetvdb/visualize/PictureMaker.h"
#include "tetvdb/visualize/TriangleDrawable.h"
#include "tetvdb/visualize/VolumeLook.h"
#include "tetvdb/visualize/VolumeSubject.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <openvdb/tools/Mask.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kWidth = 480, kHeight = 400; ///< of a panel

Image takePicture(std::vector<PictureMaker::CaptionedSubject> subjects, Progress& progress) {
  PictureOptions options;
  options.width = kWidth * static_cast<int>(subjects.size());
  options.height = kHeight;
  options.captions = true;
  return PictureMaker(std::move(subjects), options, progress).take(0, progress);
}

// A mesh in the colours of its distance to another.
class DistanceSubject : public Subject {
public:
  DistanceSubject(const TriangleMesh& mesh, const TriangleScene& other, double largest)
      : mesh_(mesh), distances_(mesh.points.size()) {
    tbb::parallel_for(std::size_t(0), mesh.points.size(), [&](std::size_t i) {
      distances_[i] = static_cast<float>(other.closest(mesh.points[i]).distance);
    });
    for (const std::uint32_t point : mesh.triangles) {
      box_.add(mesh.points[point]);
      largest_ = std::max(largest_, double(distances_[point]));
    }
    largest_ = std::max(largest_, largest);
  }

  Box bounds() const override { return box_; }
  double largest() const { return largest_; }

  std::optional<ColorScale> scale() const override {
    ColorScale scale;
    scale.low = 0;
    scale.high = largest_ > 0 ? largest_ : 1;
    scale.map = &ColorMap::named("viridis");
    scale.title = "distance";
    return scale;
  }

  Drawn draw(const ColorScale* scale, const std::optional<CutPlane>& cut,
             Progress& progress) override {
    TriangleLook look;
    look.cut = cut;
    look.values.on = SurfaceValues::On::Points;
    look.values.values = std::move(distances_);
    look.values.scale = *scale;
    Drawn drawn;
    drawn.triangles = mesh_.triangleCount();
    drawn.drawables.push_back(
        std::make_shared<TriangleDrawable>(std::move(mesh_), std::move(look), progress));
    return drawn;
  }

private:
  TriangleMesh mesh_;
  std::vector<float> distances_;
  Box box_;
  double largest_ = 0;
};

// Voxels in colours of their own, or by the values of a grid.
class DifferenceSubject : public Subject {
public:
  struct Part {
    openvdb::GridBase::ConstPtr grid;
    Rgb color;
  };
  DifferenceSubject(const Box& bounds, std::vector<Part> parts)
      : bounds_(bounds), parts_(std::move(parts)) {}
  DifferenceSubject(const Box& bounds, openvdb::FloatGrid::ConstPtr values, double largest)
      : bounds_(bounds), parts_{{values, {}}}, largest_(largest) {}

  Box bounds() const override { return bounds_; }

  std::optional<ColorScale> scale() const override {
    if (!largest_)
      return std::nullopt;
    ColorScale scale;
    scale.low = 0;
    scale.high = *largest_;
    scale.map = &ColorMap::named("viridis");
    scale.title = "difference";
    return scale;
  }

  Drawn draw(const ColorScale* scale, const std::optional<CutPlane>& cut, Progress&) override {
    Drawn drawn;
    for (const Part& part : parts_) {
      VolumeLook look;
      look.cut = cut;
      look.paint.plain = part.color;
      if (largest_ && scale != nullptr) {
        look.paint.grid = part.grid;
        look.paint.colorOf = [colors = *scale](double value) { return colors(value); };
      }
      drawn.drawables.push_back(drawVoxels(part.grid, look));
    }
    return drawn;
  }

private:
  Box bounds_;
  std::vector<Part> parts_;
  std::optional<double> largest_;
};

// Active voxels; of a level set those inside.
openvdb::MaskGrid::Ptr solidOf(const openvdb::GridBase& grid) {
  openvdb::MaskGrid::Ptr mask;
  withKnownGrid(grid, [&](const auto& typed) {
    using GridT = std::decay_t<decltype(typed)>;
    if constexpr (std::is_floating_point<typename GridT::ValueType>::value) {
      if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) {
        const auto inside = openvdb::tools::interiorMask(typed);
        mask = openvdb::MaskGrid::create();
        mask->tree().topologyUnion(inside->tree());
        return;
      }
    }
    mask = openvdb::MaskGrid::create();
    mask->tree().topologyUnion(typed.tree());
  });
  if (!mask)
    throw Error(Status::Usage, grid.getName(),
                "a grid of type " + grid.valueType() + " is unknown");
  mask->setTransform(grid.transform().copy());
  return mask;
}

openvdb::GridBase::ConstPtr named(const Volume& volume, const std::string& name) {
  for (const auto& grid : volume.grids().all)
    if (grid->getName() == name)
      return grid;
  return nullptr;
}

// Where both are active and values differ: by how much.
openvdb::FloatGrid::Ptr valueDifference(const openvdb::GridBase& a, const openvdb::GridBase& b,
                                        double& largest) {
  const auto valuesA = valuesOf(a), valuesB = valuesOf(b);
  openvdb::MaskGrid::Ptr both = solidOf(a);
  both->tree().topologyIntersection(solidOf(b)->tree());
  auto result = openvdb::FloatGrid::create();
  result->setTransform(a.transform().copy());
  auto accessor = result->getAccessor();
  both->tree().voxelizeActiveTiles();
  for (auto voxel = both->cbeginValueOn(); voxel; ++voxel) {
    const openvdb::Coord at = voxel.getCoord();
    double one = 0, other = 0;
    valuesA->at({at.x(), at.y(), at.z()}, one);
    valuesB->at({at.x(), at.y(), at.z()}, other);
    const double difference = std::abs(one - other);
    if (difference > 0 || std::isnan(one) != std::isnan(other)) {
      accessor.setValueOn(at, static_cast<float>(difference));
      if (difference > largest)
        largest = difference;
    }
  }
  return result;
}

PictureMaker::CaptionedSubject subjectOf(const Volume& volume, const std::string& grid,
                                         const std::string& caption) {
  VolumeShow show;
  show.grid = grid;
  // One colour: the difference has the legend.
  auto alone = std::make_shared<GridSet>();
  for (const auto& one : volume.grids().all)
    if (one->getName() == grid)
      alone->all.push_back(one);
  show.plainColor = true;
  return {subjectOf(Volume(alone), show), caption};
}

} // namespace

Image comparePicture(const TriangleMesh& a, const TriangleMesh& b, const ComparedNames& names,
                     Progress& progress) {
  for (const TriangleMesh* mesh : {&a, &b})
    if (mesh->triangles.empty())
      throw Error(Status::Invalid, mesh == &a ? names.a : names.b, "has no faces");
  std::vector<PictureMaker::CaptionedSubject> subjects;
  {
    const TriangleScene sceneA(a), sceneB(b);
    auto first = std::make_unique<DistanceSubject>(a, sceneB, 0);
    auto second = std::make_unique<DistanceSubject>(b, sceneA, first->largest());
    subjects.push_back({std::move(first), "A: " + names.a});
    subjects.push_back({std::move(second), "B: " + names.b});
  }
  return takePicture(std::move(subjects), progress);
}

Image comparePicture(const Volume& a, const Volume& b, const VolumeComparison& comparison,
                     const ComparedNames& names, Progress& progress) {
  if (comparison.grids.empty())
    throw Error(Status::Invalid, names.a,
                "no grid has a partner of the same name and type in the "
                "other volume",
                "nothing can be drawn; leave -o out");
  const GridComparison* shown = &comparison.grids.front();
  for (const GridComparison& grid : comparison.grids)
    if (grid.stateDiffers + grid.valueDiffers > 0) {
      shown = &grid;
      break;
    }
  const openvdb::GridBase::ConstPtr first = named(a, shown->name), second = named(b, shown->name);
  std::vector<PictureMaker::CaptionedSubject> subjects;
  Box bounds;
  for (const auto& [volume, caption] : {std::pair{&a, "A: " + names.a}, {&b, "B: " + names.b}})
    if ((volume == &a ? shown->activeA : shown->activeB) > 0) {
      subjects.push_back(subjectOf(*volume, shown->name, caption));
      bounds.add(subjects.back().subject->bounds());
    }
  if (subjects.empty())
    throw Error(Status::Invalid, shown->name, "has no active voxels in either volume",
                "nothing can be drawn; leave -o out");
  progress.check();

  openvdb::MaskGrid::Ptr onlyA = solidOf(*first), onlyB = solidOf(*second);
  const openvdb::MaskGrid::Ptr allA = onlyA->deepCopy();
  onlyA->tree().topologyDifference(onlyB->tree());
  onlyB->tree().topologyDifference(allA->tree());
  progress.check();
  const bool sameStates = onlyA->activeVoxelCount() == 0 && onlyB->activeVoxelCount() == 0;
  if (sameStates && shown->valueDiffers > 0) {
    double largest = 0;
    const auto values = valueDifference(*first, *second, largest);
    subjects.push_back(
        {std::make_unique<DifferenceSubject>(bounds, values, largest > 0 ? largest : 1),
         "difference of " + shown->name});
  } else {
    subjects.push_back(
        {std::make_unique<DifferenceSubject>(
             bounds, std::vector<DifferenceSubject::Part>{{onlyA, {0.80F, 0.06F, 0.04F}},
                                                          {onlyB, {0.03F, 0.12F, 0.85F}}}),
         "red: A alone, blue: B alone"});
  }
  return takePicture(std::move(subjects), progress);
}

} // namespace tetvdb
