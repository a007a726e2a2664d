// SPDX-License-Identifier: Apache-2.0
//
// Computes occupancy stack by stack, for a writer that never holds a whole tree in memory
// (volume/BitSource.h). Memory: the faces and their nodes, the sums of one column of 4096^3 cubes
// (at most 64 MB, less than 3 MB where they are 0 or 1), and the stacks under construction.
#pragma once

#include "tetvdb/geometry/NodeBox.h"
#include "tetvdb/volume/BitSource.h"
#include "tetvdb/voxelize/BoundaryRaster.h"
#include "tetvdb/voxelize/RuleSink.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <optional>
#include <vector>

namespace tetvdb {

/// The voxels that rasterizeBoundary() computes, by any voxel rule.
class OccupancySource : public BitSource {
public:
  /// All but `progress` must outlive it. Finds the cubes, and which of them are full: of those
  /// that no face comes near by one stack, of others by as many as it takes to find a voxel that is
  /// not inside. Parallel. Throws as BoundaryStacks does.
  OccupancySource(const SnappedMesh& mesh, const Boundary& boundary, const FillOptions& fill,
                  VoxelRule rule, Progress& progress);

  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t cube) override;
  void fill(int stack, BitStack& out) override;
  /// Hands the nodes of `box`, which lies in one column of cubes, to `sink`, from several threads.
  /// Boxes are cheapest in the order of a file, one after the other.
  void rasterize(const NodeBox& box, NodeSink& sink);
  /// The same of any box, which leaves the order as it is: for nodes around one.
  void peek(const NodeBox& box, NodeSink& sink) const;

  /// The estimated work for each cube, at least 1. Depends only on the mesh and the options.
  std::vector<std::uint64_t> weights() const;
  /// Keeps only the cubes begin <= i < end.
  void restrict(std::size_t begin, std::size_t end);

private:
  /// A stack within a column of cubes: what faces meet, of the faces and of the rule's.
  struct Place {
    int stack = 0;
    std::int32_t zBegin = 0, zEnd = 0;              ///< nodes
    const BoundaryStacks::Column* column = nullptr; ///< null: no crossings
    std::size_t ruledBegin = 0, ruledEnd = 0;
  };
  /// A column of cubes.
  struct CubeColumn {
    std::int32_t x = 0, y = 0; ///< in cubes
    std::vector<Place> places; ///< by stack
  };
  /// Sums of a stack, at a height.
  struct Carried {
    std::int32_t z = 0;
    bool begun = false;
    BoundaryCarry sums;
  };

  void findColumns();
  void findCubes(const SnappedMesh& mesh, const Boundary& boundary, bool closed,
                 Progress& progress);
  bool isFull(const CubeColumn& column, std::int32_t z, bool quiet) const;
  void beginColumn(std::size_t column);
  std::size_t findColumn(std::int32_t x, std::int32_t y) const;
  static std::vector<const Place*> placesIn(const CubeColumn& column, const NodeBox& box);
  void rasterize(const CubeColumn& column, const Place& place, std::int32_t low, std::int32_t high,
                 Carried& carried, NodeSink& sink) const;

  VoxelRule rule_;
  BoundaryStacks stacks_;
  std::optional<RuledFaces> ruled_;
  std::vector<CubeColumn> columns_;
  std::vector<RootCube> cubes_;
  std::vector<std::size_t> columnOf_; ///< of each cube
  std::size_t cube_ = 0;              ///< begun last
  std::size_t carriedColumn_ = ~std::size_t(0);
  std::vector<Carried> carried_; ///< by stack, of that column
};

} // namespace tetvdb
