// SPDX-License-Identifier: Apache-2.0
//
// Points and weights that make up a value at each voxel of a leaf, in meshes with cells that have
// shape functions of their own.
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

  /// Of a linear tet its corners by their weights; of a tet that is cut out of another cell the
  /// cell's nodes by their shape functions, at the place in the reference cell that is mapped to
  /// the voxel's centre. Where the cell is an affine image of the reference cell that place follows
  /// from the tet's weights; elsewhere it is found by Newton's method, beginning there. Where that
  /// does not end near the reference cell, as in cells that are turned inside out, it stays there
  /// in quadratic cells; in linear ones the tet's corners are taken (see missed()).
  void find(const LeafSample& sample);

  /// Whether the voxel lies outside of its linear cell, between a warped face and the tets' flat
  /// ones: values there go on by the shape functions, within the range of the cell's nodes.
  bool beyond(std::size_t voxel) const { return beyond_[voxel] != 0; }
  /// Voxels of linear cells, of all leaves so far, that have their tet's values.
  std::size_t missed() const { return missed_; }

  std::size_t count(std::size_t voxel) const { return counts_[voxel]; }
  const std::uint32_t* points(std::size_t voxel) const {
    return points_.data() + voxel * kMaxCurvedNodes;
  }
  const double* weights(std::size_t voxel) const {
    return weights_.data() + voxel * kMaxCurvedNodes;
  }

private:
  struct Slot {
    bool curved = false, affine = false;
    double size = 0;             ///< the cell's, along the axes, from its first node
    std::array<Vec3d, 4> places; ///< in the reference cell, of the corners by position
  };

  Slot slotOf(const LeafSample& sample, std::size_t slot) const;
  bool isAffine(const CurvedCells::Cell& cell) const;
  Vec3d centre(const LeafSample& sample, std::size_t voxel) const;
  double sizeOf(const CurvedCells::Cell& cell) const;
  /// Finds where the cell maps to `target`, beginning at `at`, and the shape functions' values
  /// there. Returns whether it does; else neither is of use.
  bool solve(const CurvedCells::Cell& cell, double size, const Vec3d& target, Vec3d& at,
             double* weights) const;

  const TetMesh* mesh_;
  GridTransform transform_;
  std::vector<Slot> slots_;
  std::vector<std::size_t> counts_;
  std::vector<std::uint8_t> beyond_;
  std::size_t missed_ = 0;
  std::vector<std::uint32_t> points_;
  std::vector<double> weights_;
};

} // namespace tetvdb
