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
#include "tetvdb/geometry/WindingCube.h"
#include "tetvdb/voxelize/Slab.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace tetvdb {

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

  using Corner = std::array<std::int64_t, 3>;
  /// A cube of voxels with what its parts take over.
  struct Cube {
    Corner first{};
    std::int64_t size = 0; // voxels
    LatticePoint centre{0, 0, 0};
    bool expanded = false; // whether there is anything in the expansion
    Expansion far;
    std::vector<std::uint32_t> clusters, triangles; // that are near
  };

  /// Sets a cube's place, with nothing near.
  static void place(const Corner& first, std::int64_t size, Cube& cube);

  /// For those who evaluate octants of leaves themselves: the cubes as large as a leaf in which
  /// values may be needed.
  std::vector<Cube> leavesOf(const NodeIndex& node) const;
  /// The points at which expansions of octants of leaves are known, relative to the centre.
  static std::array<Vec3d, kExpansionPoints> octantPoints();
  const TriangleClusters& fill() const { return fill_; }
  /// Bound on what one cluster or triangle may be wrong by: a solid angle.
  double tolerance() const { return tolerance_; }

  struct Sphere;
  /// Evaluates octants of leaves one by one.
  class Octants {
  public:
    explicit Octants(const WindingBand& band);
    ~Octants();
    Octants(const Octants&) = delete;
    Octants& operator=(const Octants&) = delete;
    /// The solid angle of F divided by 4 pi at the octant's voxels; false where it is not needed.
    bool evaluate(const Cube& leaf, std::size_t octant, Cube& scratch, VoxelValues& values) const;

  private:
    const WindingBand& band_;
    std::unique_ptr<const Sphere> sphere_;
  };

private:
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
