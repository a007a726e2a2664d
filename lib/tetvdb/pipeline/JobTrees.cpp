// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/JobTrees.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/fields/CapFaces.h"
#include "tetvdb/fields/FieldGrids.h"
#include "tetvdb/fields/FogVolume.h"
#include "tetvdb/fields/LevelSet.h"
#include "tetvdb/pipeline/OriginMetadata.h"
#include "tetvdb/voxelize/TreeBuilder.h"
#include "tetvdb/voxelize/VoxelizeMaterials.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

// Calls visit(node) for the 128^3 nodes that a box meets.
template <typename Visit>
void eachNodeIn(const VoxelBox& box, const Visit& visit) {
  if (box.empty())
    return;
  for (std::int32_t x = nodeOf(box.low[0]); x <= nodeOf(box.high[0]); ++x)
    for (std::int32_t y = nodeOf(box.low[1]); y <= nodeOf(box.high[1]); ++y)
      for (std::int32_t z = nodeOf(box.low[2]); z <= nodeOf(box.high[2]); ++z)
        visit(NodeIndex{x, y, z});
}

// Where a band is only needed to know how many leaves a node has, and to find holes.
constexpr double kNarrowBand = 1, kBandOfHoles = 3;

bool isEmpty(const NodeBox& box) {
  return box.low[0] == box.high[0];
}

const openvdb::BoolGrid& maskOf(const openvdb::GridPtrVec& grids) {
  return static_cast<const openvdb::BoolGrid&>(
      **std::find_if(grids.begin(), grids.end(),
                     [](const auto& grid) { return grid->template isType<openvdb::BoolGrid>(); }));
}

} // namespace

bool isWholeBox(const VoxelizeJob& job) {
  return job.shapes.halfWidth == kWholeBox && contains(job.grids, GridKind::Surface);
}

openvdb::CoordBBox insideBox(OccupancySource& source, const GridTransform& transform) {
  openvdb::CoordBBox box;
  for (const RootCube& cube : source.cubes())
    for (std::int32_t x = 0; x < kStackNodes; ++x) {
      NodeBox layer;
      for (std::size_t k = 0; k < 3; ++k) {
        layer.low[k] = cube.origin[k] / kNodeSize;
        layer.high[k] = layer.low[k] + kStackNodes;
      }
      layer.low[0] += x;
      layer.high[0] = layer.low[0] + 1;
      TreeBuilder builder({GridKind::Mask}, TetMesh());
      source.rasterize(layer, builder);
      box.expand(builder.finish(transform).front()->evalActiveVoxelBoundingBox());
    }
  return box;
}

JobTrees::JobTrees(const VoxelizeJob& job, const TreeInputs& inputs, Progress& progress)
    : job_(job), inputs_(inputs),
      voxelized_(madeBy(job.grids, {GridMaker::Occupancy, GridMaker::Owner})),
      shapes_(madeBy(job.grids, {GridMaker::Distance, GridMaker::Share})), made_(voxelized_) {
  const bool owners = !madeBy(job.grids, {GridMaker::Owner}).empty();
  owners_ = owners && inputs.tets != nullptr;
  materials_ = owners && !owners_;
  if (!shapes_.empty() && !contains(made_, GridKind::Mask))
    made_.push_back(GridKind::Mask);
  if (!owners_ && !made_.empty())
    for (const SolidFaces* faces : inputs.faces)
      sources_.push_back(std::make_unique<OccupancySource>(
          faces->snapped, faces->chain, faces->fill(), job.voxelize.rule, progress));
  materialVoxels_.assign(sources_.size(), 0);
  if (has(GridKind::Coverage))
    coverage_.emplace(inputs.shares->points, inputs.shares->faces, inputs.transform, progress);
  findBand(progress);
  findBox();
  weighNodes(progress);
  findCubes();
}

void JobTrees::findBand(Progress& progress) {
  if (!hasDistances())
    return;
  const ShapeSolid& solid = *inputs_.distances;
  if (!isWholeBox(job_))
    band_.emplace(solid.mesh, solid.faces, job_.shapes.halfWidth, progress);
  else if (solid.boundary)
    band_.emplace(solid.mesh, solid.faces, kBandOfHoles, progress);
}

void JobTrees::findBox() {
  if (!isWholeBox(job_))
    return;
  const ShapeSolid& solid = *inputs_.distances;
  for (const auto& source : sources_)
    inside_.expand(insideBox(*source, inputs_.transform));
  box_ = wholeBox(solid.mesh, solid.faces, inside_, 0);
  // Faces over holes lie between neighbouring voxels, of which one is inside.
  for (std::size_t k = 0; k < 3 && solid.boundary; ++k) {
    --box_.low[k];
    ++box_.high[k];
  }
}

void JobTrees::findLargestDistance(Progress& progress) {
  const ShapeSolid& solid = *inputs_.distances;
  wholeBox_.emplace(solid.mesh, solid.faces, inputs_.transform,
                    wholeBox(solid.mesh, solid.faces, inside_, 0), progress);
}

bool JobTrees::has(GridKind kind) const {
  return contains(job_.grids, kind);
}

void JobTrees::weighNodes(Progress& progress) {
  nodes_.clear();
  // Bytes a leaf, of those at the surface and of those that tets fill.
  double atSurface = 0, filled = 0;
  const auto grids = static_cast<double>(made_.size() + shapes_.size() + 1 +
                                         (inputs_.fields ? inputs_.fields->size() : 0));
  for (const GridKind kind : made_)
    (owners_ ? filled : atSurface) += static_cast<double>(leafBytes(kind));
  if (materials_)
    atSurface += static_cast<double>(leafBytes(GridKind::Mask)); // of each
  for (const GridKind kind : shapes_)
    if (kind != GridKind::Surface || !isWholeBox(job_))
      atSurface += static_cast<double>(leafBytes(kind));
  if (has(GridKind::Fog))
    atSurface += static_cast<double>(leafBytes(GridKind::Fog)); // of its level set
  if (inputs_.fields != nullptr)
    for (const Field& field : *inputs_.fields)
      filled += static_cast<double>(leafBytes(field.kind));
  const double perNode = grids * static_cast<double>(kLowerNodeBytes);
  const auto addBand = [&](const DistanceBand& band) {
    const std::vector<float> leaves = estimateNodeLeaves(band);
    for (std::size_t i = 0; i < leaves.size(); ++i)
      nodes_.push_back({band.nodes()[i],
                        static_cast<float>(static_cast<double>(leaves[i]) * atSurface + perNode)});
  };
  if (band_)
    addBand(*band_);
  else
    for (const SolidFaces* faces : inputs_.faces)
      addBand(DistanceBand(faces->snapped, faces->chain, kNarrowBand, progress));
  eachNodeIn(box_, [&](const NodeIndex& node) {
    double leaves = 1;
    for (std::size_t k = 0; k < 3; ++k)
      leaves *= std::min((box_.high[k] - node[k] * kNodeSize) / kLeafSize, kLeavesAlong - 1) -
                std::max((box_.low[k] - node[k] * kNodeSize) / kLeafSize, 0) + 1;
    nodes_.push_back(
        {node, static_cast<float>(leaves * static_cast<double>(leafBytes(GridKind::Surface) + 32) +
                                  perNode)});
  });
  if (const TetSource* tets = inputs_.tets)
    for (std::size_t i = 0; i < tets->size(); ++i)
      nodes_.push_back(
          {tets->node(i),
           static_cast<float>(static_cast<double>(tets->mostLeaves(i)) * filled + perNode)});
  std::sort(nodes_.begin(), nodes_.end(),
            [](const NodeWeight& a, const NodeWeight& b) { return a.node < b.node; });
  std::size_t last = 0;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    if (nodes_[i].node == nodes_[last].node)
      nodes_[last].bytes += nodes_[i].bytes;
    else
      nodes_[++last] = nodes_[i];
  }
  if (!nodes_.empty())
    nodes_.resize(last + 1);
}

void JobTrees::findCubes() {
  std::set<Vec3i> cubes;
  Vec3i known{};
  for (const NodeWeight& one : nodes_) {
    const Vec3i cube{one.node[0] >> 5, one.node[1] >> 5, one.node[2] >> 5};
    if (cubes.empty() || cube != known)
      cubes.insert(cube);
    known = cube;
  }
  // The band of faces over holes may reach into the next cubes.
  const std::int32_t reach = hasDistances() && inputs_.distances->boundary ? 1 : 0;
  for (const auto& source : sources_)
    for (const RootCube& cube : source->cubes())
      for (std::int32_t x = -reach; x <= reach; ++x)
        for (std::int32_t y = -reach; y <= reach; ++y)
          for (std::int32_t z = -reach; z <= reach; ++z)
            cubes.insert({cube.origin[0] / kRootChildSize + x, cube.origin[1] / kRootChildSize + y,
                          cube.origin[2] / kRootChildSize + z});
  for (const Vec3i& cube : cubes) {
    origins_.push_back(
        {cube[0] * kRootChildSize, cube[1] * kRootChildSize, cube[2] * kRootChildSize});
    cubes_.push_back({origins_.back(), false});
  }
}

NodeBox JobTrees::boxOf(std::size_t cube) const {
  NodeBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = origins_[cube][k] / kNodeSize;
    box.high[k] = box.low[k] + kNodesInCube;
  }
  return box;
}

std::vector<std::uint64_t> JobTrees::weights() const {
  std::vector<std::uint64_t> weights;
  for (std::size_t c = 0; c < origins_.size(); ++c) {
    double bytes = 0;
    eachRangeIn(
        boxOf(c), nodes_.size(), [&](std::size_t i) { return nodes_[i].node; },
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            bytes += static_cast<double>(nodes_[i].bytes);
        });
    weights.push_back(1 + static_cast<std::uint64_t>(bytes / 1024));
  }
  return weights;
}

void JobTrees::restrict(const CubeRange& range) {
  const auto at = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
  cubes_ = {cubes_.begin() + at(range.begin), cubes_.begin() + at(range.end)};
  origins_ = {origins_.begin() + at(range.begin), origins_.begin() + at(range.end)};
}

void JobTrees::limitParts(std::size_t bytes) {
  partBytes_ = bytes;
  for (const NodeWeight& one : nodes_)
    if (static_cast<double>(one.bytes) > static_cast<double>(bytes))
      throw Error(Status::Limit, "",
                  fmt::format("the grids of 128^3 voxels need about {:.0f} MB, {:.0f} MB are left "
                              "for them",
                              static_cast<double>(one.bytes) * 1e-6,
                              static_cast<double>(bytes) * 1e-6),
                  "raise `max_memory` or make fewer grids at a time");
}

std::vector<NodeBox> JobTrees::parts(std::size_t cube) {
  const NodeBox whole = boxOf(cube);
  std::vector<SplitBox> parts;
  for (const SplitBox& box :
       inputs_.tets != nullptr ? inputs_.tets->boxes(whole) : std::vector<SplitBox>{{whole, 0}})
    splitBox(
        box, nodes_.size(), [&](std::size_t i) { return nodes_[i].node; },
        [&](std::size_t i) { return static_cast<double>(nodes_[i].bytes); },
        static_cast<double>(partBytes_), parts);
  std::vector<NodeBox> boxes;
  for (const SplitBox& part : parts)
    boxes.push_back(part.box);
  return boxes;
}

openvdb::GridPtrVec JobTrees::materials(const NodeBox& box, Progress& progress) {
  std::vector<openvdb::BoolGrid::ConstPtr> masks;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    TreeBuilder builder({GridKind::Mask}, TetMesh());
    if (!isEmpty(box))
      sources_[i]->rasterize(box, builder);
    masks.push_back(
        openvdb::gridPtrCast<openvdb::BoolGrid>(builder.finish(inputs_.transform).front()));
    materialVoxels_[i] += masks.back()->activeVoxelCount();
  }
  return materialGrids(made_, masks, inputs_.transform, progress);
}

openvdb::GridPtrVec JobTrees::occupancy(const NodeBox& box, Progress& progress) {
  if (materials_)
    return materials(box, progress);
  if (owners_) {
    const OwnerTets& tets = inputs_.tets->within(box, progress);
    TreeBuilder builder(made_, *tets.mesh, tets.cellNumbers);
    if (!isEmpty(box))
      tets.nodes->rasterize(box, true, builder, progress);
    return builder.finish(inputs_.transform);
  }
  TreeBuilder builder(made_, TetMesh());
  if (!isEmpty(box) && !sources_.empty())
    sources_.front()->rasterize(box, builder);
  return builder.finish(inputs_.transform);
}

// What is inside in the part, and in the nodes beyond its upper sides.
openvdb::BoolGrid::Ptr JobTrees::maskAround(const NodeBox& part, Progress& progress) {
  std::vector<openvdb::BoolGrid::ConstPtr> masks;
  for (const auto& source : sources_) {
    TreeBuilder builder({GridKind::Mask}, TetMesh());
    source->rasterize(part, builder);
    for (std::size_t k = 0; k < 3; ++k) { // without overlap
      NodeBox side = part;
      for (std::int32_t& high : side.high)
        ++high;
      side.low[k] = part.high[k];
      for (std::size_t before = 0; before < k; ++before)
        side.high[before] = part.high[before];
      source->peek(side, builder);
    }
    masks.push_back(
        openvdb::gridPtrCast<openvdb::BoolGrid>(builder.finish(inputs_.transform).front()));
  }
  return masks.size() == 1
             ? openvdb::ConstPtrCast<openvdb::BoolGrid>(masks.front())
             : openvdb::gridPtrCast<openvdb::BoolGrid>(
                   materialGrids({GridKind::Mask}, masks, inputs_.transform, progress).front());
}

openvdb::FloatGrid::Ptr JobTrees::surface(const NodeBox& box, const openvdb::GridPtrVec& occupancy,
                                          Progress& progress) const {
  if (wholeBox_)
    return wholeBox_->grid(box, maskOf(occupancy), progress);
  return levelSetWithin(box, *band_, maskOf(occupancy), inputs_.transform, job_.shapes.halfWidth, 0,
                        progress);
}

void JobTrees::addCaps(ShapeSolid& solid, const CubeRange& range, const ProgressShare& share,
                       Progress& progress) {
  QuietProgress quiet(progress);
  const auto isNear = [&](const Vec3i& a, const Vec3i& b) {
    for (std::size_t k = 0; k < 3; ++k)
      if (std::abs(a[k] / kRootChildSize - b[k] / kRootChildSize) > 1)
        return false;
    return true;
  };
  std::vector<CentrePair> pairs;
  for (std::size_t c = 0; c < origins_.size(); ++c) {
    bool near = c >= range.begin && c < range.end;
    for (std::size_t i = range.begin; i < range.end && !near; ++i)
      near = isNear(origins_[c], origins_[i]);
    if (!near)
      continue;
    for (const NodeBox& part : parts(c)) {
      NodeBox wide = part;
      for (std::int32_t& high : wide.high)
        ++high;
      const openvdb::BoolGrid::Ptr inside = maskAround(part, quiet);
      const openvdb::FloatGrid::Ptr level =
          levelSetWithin(wide, *band_, *inside, inputs_.transform,
                         isWholeBox(job_) ? kBandOfHoles : job_.shapes.halfWidth, 0, quiet);
      const std::vector<CentrePair> found =
          findPairsWithoutFace(*level, inside, inputs_.transform, &part, quiet);
      pairs.insert(pairs.end(), found.begin(), found.end());
    }
    share.update(double(c + 1) / double(origins_.size()));
  }
  if (pairs.empty())
    return;
  addCapFaces(std::move(pairs), *solid.boundary, solid.mesh, solid.faces, quiet);
  findBand(quiet);
  weighNodes(quiet);
}

void JobTrees::findFogDepth(const ProgressShare& share, Progress& progress) {
  if (!has(GridKind::Fog))
    return;
  fogDepth_ = std::numeric_limits<float>::max();
  QuietProgress quiet(progress);
  for (std::size_t c = 0; c < origins_.size(); ++c) {
    for (const NodeBox& part : parts(c)) {
      const openvdb::FloatGrid::Ptr grid = surface(part, occupancy(part, quiet), quiet);
      fogDepth_ = std::min(fogDepth_, fogDepth(*grid));
      if (fogDepth_ == -grid->background())
        return;
    }
    share.update(double(c + 1) / double(origins_.size()));
  }
}

void JobTrees::begin() {
  insideVoxels_ = 0;
  materialVoxels_.assign(sources_.size(), 0);
  anyOwned_ = false;
  sampled_ = {};
  if (coverage_)
    coverage_->begin();
}

openvdb::GridPtrVec JobTrees::make(const NodeBox& box, Progress& progress) {
  openvdb::GridPtrVec all;
  openvdb::GridPtrVec made;
  if (!made_.empty()) {
    made = occupancy(box, progress);
    insideVoxels_ += made.front()->activeVoxelCount();
    all.assign(made.begin(), made.begin() + static_cast<std::ptrdiff_t>(voxelized_.size()));
  }
  openvdb::FloatGrid::Ptr level;
  if (hasDistances())
    level = surface(box, made, progress);
  made.clear();
  for (const GridKind kind : shapes_) {
    if (kind == GridKind::Coverage) {
      all.push_back(coverage_->grid(box, progress));
    } else if (kind == GridKind::Surface) {
      all.push_back(level);
    } else {
      const openvdb::FloatGrid::Ptr fog =
          has(GridKind::Surface) ? level->deepCopy() : std::exchange(level, nullptr);
      makeFog(*fog, fogDepth_);
      fog->setTransform(makeTransform(inputs_.transform)); // deepCopy() rounds it
      all.push_back(fog);
    }
  }
  if (inputs_.fields != nullptr) {
    std::vector<std::unique_ptr<PackedGrid>> none;
    const OwnerTets& tets = inputs_.tets->within(box, progress);
    SampledGrids grids(*tets.mesh, *tets.snapped, inputs_.transform, *tets.fields, nullptr, none);
    if (!isEmpty(box))
      tets.nodes->rasterize(box, true, grids.grids(), progress);
    anyOwned_ = anyOwned_ || grids.grids().any();
    const openvdb::GridPtrVec fields = grids.finish(inputs_.transform, sampled_);
    all.insert(all.end(), fields.begin(), fields.end());
  }
  setMaskType(job_, all);
  setHalf(job_, all);
  return all;
}

} // namespace tetvdb
