// SPDX-License-Identifier: Apache-2.0
//
// Where the winding number of an open soup may pass a half off its faces: the voxels at which it
// has to be evaluated. Everywhere else the whole number nearest to it changes with the crossings of
// faces alone.
//
// Let S be the soup and F the triangles that fill its holes (geometry/FillHoles.h). S and the
// reversed F close, so that at any point
//
//     winding number of S  =  crossings of S below  -  crossings of F below  +  solid angle of F /
//     4 pi,
//
// where crossings are those of a ray straight down. The solid angles are summed here, cube by cube
// of voxels: a cube takes the local expansion of the cube around it, adds the clusters of triangles
// that are far from it, and passes on those that are near.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/LocalExpansion.h"
#include "tetvdb/geometry/TriangleClusters.h"
#include "tetvdb/voxelize/Slab.h"

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace tetvdb {

/// The error of the winding numbers that WindingBand computes: measured, not proved. Each
/// approximated cluster and triangle has a bound, and the sum of these bounds can be larger than
/// this. The largest error that was measured is four tenths of it (docs/algorithms.md, section 8a).
constexpr double kWindingBandError = 1e-3;

/// The whole number nearest to a winding number, of a half (within a tenth of kWindingBandError)
/// the one nearer to zero: what lies at most half around counts as outside.
std::int32_t nearestWinding(double winding);

/// A cube of voxels represents the columns through their centres, from the centre below the lowest
/// to the highest: what a sum carried up through the cube passes. It is passed over if the winding
/// number, faces aside, stays clear of every half in it.
class WindingBand {
public:
  /// Finds the nodes, in parallel. Both must outlive it; throws as progress.check() does, and
  /// Error(Limit) where nodes leave 32-bit index space.
  WindingBand(const TriangleClusters& fill, const Progress& progress);

  /// Nodes with voxels to evaluate, in order of (x, y, z).
  std::vector<NodeIndex> nodes() const;

  /// What evaluate() needs of a node, found in parallel.
  class Node;
  Node enter(const NodeIndex& node) const;

  /// The solid angle of F divided by 4 pi at the voxels of a slab where it has to be evaluated: row
  /// r, voxel z at values[r * 128 + z]. The rows' other bits of `flags` are cleared, other values
  /// kept. False where there are none.
  bool evaluate(const Node& node, int slab, SlabBits& flags, std::vector<double>& values) const;

private:
  using Corner = std::array<std::int64_t, 3>;
  struct Cube {
    Corner first{};
    std::int64_t size = 0; // voxels
    LatticePoint centre{0, 0, 0};
    bool expanded = false; // whether there is anything in the expansion
    Expansion far;
    std::vector<std::uint32_t> clusters, triangles; // that are near
  };
  struct Sphere;

  static void place(const Corner& first, std::int64_t size, Cube& cube);
  void enter(const Cube& around, std::size_t octant, const Sphere& sphere, Cube& cube) const;
  void sortCluster(std::uint32_t index, const Sphere& sphere, Cube& cube) const;
  void sortTriangle(std::uint32_t index, const Sphere& sphere, Cube& cube) const;
  bool mayPassHalf(const Cube& cube) const;
  std::vector<Cube> descend(std::vector<Cube> cubes, std::int64_t size) const;
  void evaluateVoxels(const Cube& cube, VoxelValues& values) const;
  template <typename Add>
  void addCluster(std::uint32_t index, const Cube& cube, const Add& add) const;

  const TriangleClusters& fill_;
  const Progress& progress_;
  double tolerance_; // of one cluster or triangle, a solid angle
  std::map<NodeIndex, Cube> nodes_;
};

/// The cubes as large as a leaf, slab by slab.
class WindingBand::Node {
  friend class WindingBand;
  std::array<std::vector<Cube>, kSlabsPerNode> leaves_;
};

} // namespace tetvdb
