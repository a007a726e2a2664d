// SPDX-License-Identifier: Apache-2.0
//
// Points and weights that define the value at each voxel of a leaf,
// in meshes with cells that have their own shape functions.
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

  /// For a linear tet, its corners and their weights. For a tet that is part of another cell, the
  /// cell's nodes and their shape functions at the reference coordinates that are mapped to the
  /// voxel's centre. If the cell is an affine image of the reference cell, these follow from the
  /// tet's weights; otherwise they are found by Newton's method with this initial value. If it does
  /// not converge near the reference cell, as in inverted cells, the initial value is used in
  /// quadratic cells, and the tet's corners in linear ones (see missed()).
  void find(const LeafSample& sample);

  /// Whether the voxel lies outside of its linear cell, between a warped face and the flat faces of
  /// the tets: the shape functions are extrapolated there, within the range of the cell's nodes.
  bool beyond(std::size_t voxel) const { return beyond_[voxel] != 0; }
  /// Number of voxels of linear cells, in all leaves so far, that have their tet's values.
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
    double size = 0;             ///< of the cell, along the axes, from its first node
    std::array<Vec3d, 4> places; ///< of the corners by position, in the reference cell
  };

  Slot slotOf(const LeafSample& sample, std::size_t slot) const;
  bool isAffine(const CurvedCells::Cell& cell) const;
  Vec3d centre(const LeafSample& sample, std::size_t voxel) const;
  double sizeOf(const CurvedCells::Cell& cell) const;
  /// Finds the reference coordinates that map to `target`, starting at `at`, and the shape
  /// functions' values there. Returns false, with undefined results, if there are none.
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
