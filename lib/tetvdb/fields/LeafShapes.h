// SPDX-License-Identifier: Apache-2.0
//
// Points and weights that make up a value at each voxel of a leaf, in meshes with quadratic cells.
// Internal.
#pragma once

#include "tetvdb/fields/LeafSample.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

class LeafShapes {
public:
  LeafShapes(const TetMesh& mesh, const GridTransform& transform)
      : mesh_(&mesh), transform_(transform) {}

  /// Of a linear tet its corners by their weights; of a tet that is cut out of a quadratic cell the
  /// cell's nodes by their shape functions, at the place in the reference cell that is mapped to
  /// the voxel's centre. Where the cell is an affine image of the reference cell that place follows
  /// from the tet's weights; elsewhere it is found by Newton's method, beginning there. Where that
  /// does not end near the reference cell, as in cells that are turned inside out, it stays there.
  void find(const LeafSample& sample);

  std::size_t count(std::size_t voxel) const { return counts_[voxel]; }
  const std::uint32_t* points(std::size_t voxel) const {
    return points_.data() + voxel * kMostCurvedNodes;
  }
  const double* weights(std::size_t voxel) const {
    return weights_.data() + voxel * kMostCurvedNodes;
  }

private:
  struct Slot {
    bool curved = false, affine = false;
    std::array<Vec3d, 4> places; ///< in the reference cell, of the corners by position
  };

  Slot slotOf(const LeafSample& sample, std::size_t slot) const;
  bool isAffine(const CurvedCells::Cell& cell) const;
  Vec3d centre(const LeafSample& sample, std::size_t voxel) const;
  /// The shape functions' values where the cell maps to `target`, beginning at `at`.
  void weigh(const CurvedCells::Cell& cell, const Vec3d& target, const Vec3d& at,
             double* weights) const;

  const TetMesh* mesh_;
  GridTransform transform_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> counts_;
  std::vector<std::uint32_t> points_;
  std::vector<double> weights_;
};

} // namespace tetvdb
