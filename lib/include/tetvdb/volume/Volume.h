// SPDX-License-Identifier: Apache-2.0
//
// Sparse grids that belong together: one file, one transform. This header does not include
// OpenVDB; volume/Grids.h gives its types.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

/// Maps index space (voxel centres at integers) to world space: origin + index * voxelSize.
struct GridTransform {
  Vec3d voxelSize{1, 1, 1}; ///< world units
  Vec3d origin{0, 0, 0};    ///< world units: the centre of voxel (0, 0, 0)
};

struct GridSet; // volume/Grids.h

/// A grid that a file holds and the reader does not understand.
struct UnreadGrid {
  std::string name, type; ///< the type as OpenVDB names it: "Tree_ptdataidx32_5_4_3", ...
};

/// A handle; copies share the grids.
class Volume {
public:
  Volume();
  explicit Volume(std::shared_ptr<GridSet> grids);
  GridSet& grids() { return *grids_; }
  const GridSet& grids() const { return *grids_; }

  /// File-level metadata: "creator", "source", "units" and others.
  std::map<std::string, std::string> metadata;
  /// Of a file that was read: its grids of other types, such as points.
  std::vector<UnreadGrid> unread;
  /// Of arrays that were read: voxels that are NaN in the file, and inactive in the grids.
  std::uint64_t notNumbers = 0;

private:
  std::shared_ptr<GridSet> grids_;
};

/// What a grid holds; the counts are of its tree.
struct GridInfo {
  std::string name;
  std::string type;      ///< "float", "bool", "int32", ... as OpenVDB names value types
  std::string gridClass; ///< "level set", "fog volume", "unknown", ...
  GridTransform transform;
  bool linear = true; ///< false: `transform` is only the local scale (frustum, rotation, shear)
  std::uint64_t activeVoxels = 0; ///< tiles counted in full
  std::uint64_t activeTiles = 0;
  std::uint64_t leaves = 0;
  std::uint64_t bytes = 0; ///< memory of the tree
  double volume = 0;       ///< units^3: active voxels; level sets: those below 0; coverage: the sum
  Vec3i boxMin{0, 0, 0};   ///< active voxels, inclusive; boxMin > boxMax when there are none
  Vec3i boxMax{-1, -1, -1};
  double minValue = 0; ///< over active values; of the length for vectors
  double maxValue = 0;
  std::map<std::string, std::string> metadata;
};

/// Counts and ranges of every grid, in order. Parallel; linear in the number of nodes.
std::vector<GridInfo> describe(const Volume& volume);

/// 32 hexadecimal digits over names, classes, transforms, topology with tiles and values of every
/// grid, in order of name. Two volumes have equal hashes if and only if (but for chance) these are
/// equal; metadata and file encoding are not part of it. Parallel, independent of thread count.
std::string hash(const Volume& volume);

/// Result of compareVolumes() for one pair of grids of the same name.
struct GridComparison {
  std::string name;
  std::uint64_t activeA = 0, activeB = 0, activeBoth = 0; ///< voxels
  std::uint64_t stateDiffers = 0;                         ///< voxels active in one grid alone
  std::uint64_t valueDiffers = 0; ///< voxels active in both with other values
  double largestDifference = 0;   ///< over voxels active in either, background where inactive
  /// Active in both over active in either; 1 where both are empty.
  double iou() const {
    const auto either = activeA + activeB - activeBoth;
    return either == 0 ? 1.0 : static_cast<double>(activeBoth) / static_cast<double>(either);
  }
};

struct VolumeComparison {
  std::vector<GridComparison> grids;
  std::vector<std::string> onlyA, onlyB; ///< names of grids that the other volume lacks
  std::vector<std::string> incomparable; ///< same name, other value type
  bool sameTransform = true;
  bool sameHash = false;
  bool same() const;
};

/// Compares grid by grid in index space without densifying: cost follows the nodes of both trees.
VolumeComparison compareVolumes(const Volume& a, const Volume& b);

} // namespace tetvdb
