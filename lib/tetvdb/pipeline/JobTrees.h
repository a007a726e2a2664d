// SPDX-License-Identifier: Apache-2.0
//
// The grids of a job, box by box: what each box needs of the mesh is found once, for all of it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/ProgressShare.h"
#include "tetvdb/fields/Coverage.h"
#include "tetvdb/fields/DistanceBand.h"
#include "tetvdb/fields/SampledGrids.h"
#include "tetvdb/fields/ShapeSolid.h"
#include "tetvdb/fields/WholeBoxLevelSet.h"
#include "tetvdb/pipeline/ShardRanges.h"
#include "tetvdb/pipeline/TetSource.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/volume/BitSource.h"
#include "tetvdb/volume/TreeSource.h"
#include "tetvdb/voxelize/OccupancySource.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace tetvdb {

/// What the grids are found from; what a job does not need is null or empty.
struct TreeInputs {
  GridTransform transform;
  /// Occupancy, where no owners are asked for; of the grid material of triangles, those of each.
  std::vector<const SolidFaces*> faces;
  TetSource* tets = nullptr; ///< owners and fields
  const std::vector<Field>* fields = nullptr;
  const ShapeSolid* distances = nullptr; ///< level set and fog, with the faces over its holes
  const ShapeSolid* shares = nullptr;    ///< coverage
};

/// Whether the job's level set is that of a whole box (fields/WholeBoxLevelSet.h).
bool isWholeBox(const VoxelizeJob& job);

/// Of what is inside.
openvdb::CoordBBox insideBox(OccupancySource& source, const GridTransform& transform);

class JobTrees : public TreeSource {
public:
  /// All but `progress` must outlive it. Memory: that of the parts (DistanceBand, CoverageParts,
  /// OccupancySource).
  JobTrees(const VoxelizeJob& job, const TreeInputs& inputs, Progress& progress);

  /// Adds the faces over the holes of open triangles to `solid`, which is that of
  /// TreeInputs::distances: those near the cubes of `range`. To be called first; weights() and the
  /// order of the cubes stay. Finds the level set of those cubes and the ones around them. Of a
  /// whole box, all faces over holes are needed.
  void addCaps(ShapeSolid& solid, const CubeRange& range, const ProgressShare& share,
               Progress& progress);

  /// Parts have trees of at most about so many bytes. Throws Error(Limit) where a single node of
  /// 128^3 voxels may take more.
  void limitParts(std::size_t bytes);
  const std::vector<RootCube>& rootCubes() const { return cubes_; }
  /// Of each cube: its share of the work, 1 at least. Depends on mesh and options alone.
  std::vector<std::uint64_t> weights() const;
  void restrict(const CubeRange& range);
  CubeRange all() const { return {0, origins_.size()}; }
  /// The fog's depth, which all of the level set decides (fields/FogVolume.h). To be called before
  /// make() and restrict() where there is a fog; stops at the first part that decides it.
  void findFogDepth(const ProgressShare& share, Progress& progress);
  /// The box and the background of the level set of a whole box. To be called before make() and
  /// restrict() where isWholeBox(), when faces over holes were added.
  void findLargestDistance(Progress& progress);

  const std::vector<Vec3i>& cubes() const override { return origins_; }
  void begin() override;
  std::vector<NodeBox> parts(std::size_t cube) override;
  openvdb::GridPtrVec make(const NodeBox& box, Progress& progress) override;

  /// Of the boxes since begin(): voxels inside, where occupancy or shapes are asked for; whether
  /// any voxel has an owner, where fields are.
  std::uint64_t insideVoxels() const { return insideVoxels_; }
  bool anyOwned() const { return anyOwned_; }
  /// Of each of TreeInputs::faces, where they are materials.
  const std::vector<std::uint64_t>& materialVoxels() const { return materialVoxels_; }
  CoverageSum coverageSum() const { return coverage_ ? coverage_->sum() : CoverageSum{}; }
  const SampledCounts& sampled() const { return sampled_; }

private:
  struct NodeWeight {
    NodeIndex node;
    float bytes; ///< of its trees
  };

  bool has(GridKind kind) const;
  bool hasDistances() const { return has(GridKind::Surface) || has(GridKind::Fog); }
  void findBand(Progress& progress);
  void findBox();
  void weighNodes(Progress& progress);
  void findCubes();
  NodeBox boxOf(std::size_t cube) const;
  openvdb::GridPtrVec occupancy(const NodeBox& box, Progress& progress);
  openvdb::GridPtrVec materials(const NodeBox& box, Progress& progress);
  openvdb::BoolGrid::Ptr maskAround(const NodeBox& part, Progress& progress);
  openvdb::FloatGrid::Ptr surface(const NodeBox& box, const openvdb::GridPtrVec& occupancy,
                                  Progress& progress) const;

  const VoxelizeJob& job_;
  TreeInputs inputs_;
  std::vector<GridKind> voxelized_, shapes_; ///< of the job
  std::vector<GridKind> made_;               ///< voxelized_, and the mask where shapes need it
  bool owners_ = false;                      ///< of tets
  bool materials_ = false;                   ///< of triangles
  std::vector<std::unique_ptr<OccupancySource>> sources_;
  std::optional<DistanceBand> band_;
  openvdb::CoordBBox inside_; ///< of the sources' voxels, for a whole box
  VoxelBox box_;              ///< that its level set is within; empty where there is none
  std::optional<WholeBoxParts> wholeBox_;
  std::optional<CoverageParts> coverage_;
  std::vector<NodeWeight> nodes_; ///< ascending
  std::vector<RootCube> cubes_;
  std::vector<Vec3i> origins_; ///< of these
  std::size_t partBytes_ = std::size_t(1) << 30;
  float fogDepth_ = 0;
  std::uint64_t insideVoxels_ = 0;
  std::vector<std::uint64_t> materialVoxels_;
  bool anyOwned_ = false;
  SampledCounts sampled_;
};

} // namespace tetvdb
