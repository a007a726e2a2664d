// SPDX-License-Identifier: Apache-2.0
//
// The active states of a tree of any value type. Rays traverse it: node by node where it is empty,
// voxel by voxel where it is not.
#pragma once

#include "tetvdb/visualize/Drawable.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <openvdb/openvdb.h>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// A line in index space: voxel (i, j, k) takes up [i, i + 1) on each axis, so that centres lie at
/// halves here. `t` is that of the world's ray.
struct IndexRay {
  Vec3d origin{0, 0, 0};
  Vec3d direction{0, 0, 1};
  double tMin = 0, tMax = 0;
  Vec3d at(double t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1],
            origin[2] + t * direction[2]};
  }
};

/// Pointers to the masks of a tree 5-4-3, which must outlive it. Memory: 24 bytes a leaf and 0.1 to
/// 2 KB an internal node. Queries are const and thread-safe.
class ActiveTree {
  struct Leaf;
  struct Lower;

public:
  /// Any of KnownGrids (volume/GridTypes.h); Error(Usage) for others.
  explicit ActiveTree(const openvdb::GridBase& grid);

  bool isOn(const Vec3i& voxel) const;

  /// Active voxels, inclusive; low > high where there are none.
  const Vec3i& low() const { return low_; }
  const Vec3i& high() const { return high_; }

  /// The maximum of the dot product of `direction` with points of active voxels, in large trees
  /// with those of leaf nodes; -infinity where there are none. The first call visits all nodes.
  double support(const Vec3d& direction) const;

  /// Calls `f(low, side)` for every leaf node and active tile, cubes of 8, 128 or 4096 voxels a
  /// side from voxel `low`. In parallel.
  template <class F>
  void forCubes(const F& f) const;

  /// Calls `stop(begin, end)` with the t at which the ray enters and leaves a leaf node or an
  /// active tile, for all of them along the ray, in order, until it is true. Returns whether it
  /// was.
  template <class Stop>
  bool walk(const IndexRay& ray, const Stop& stop) const;

  struct Voxel {
    Vec3i at{0, 0, 0};
    double t = 0;
    int axis = -1; ///< along which the ray entered; -1: it began inside
  };
  /// The first active voxel along the ray.
  bool first(const IndexRay& ray, Voxel& found) const;

  /// isOn() for points that lie near one another.
  class Probe {
  public:
    explicit Probe(const ActiveTree& tree) : tree_(tree) {}
    bool isOn(const Vec3i& voxel);
    /// The shares of active voxels in four cubes of side 2^log2Side, 1 to 8, in a row along z that
    /// begins with `cell`, in units of the side.
    std::array<double, 4> filled(const Vec3i& cell, int log2Side);

  private:
    void find(const Vec3i& voxel);
    void findLower(const Vec3i& voxel);
    std::array<double, 4> filledLeaves(const Vec3i& leaf);

    const ActiveTree& tree_;
    Vec3i inLeaf_{0, 0, 0}, inLower_{0, 0, 0}; ///< voxels in leaf_ and lower_, if these are known
    bool isLowerKnown_ = false, isLeafKnown_ = false;
    const Leaf* leaf_ = nullptr;
    const Lower* lower_ = nullptr;
    bool tile_ = false, lowerTile_ = false;
  };

private:
  using Mask3 = openvdb::util::NodeMask<3>;
  using Mask4 = openvdb::util::NodeMask<4>;
  using Mask5 = openvdb::util::NodeMask<5>;

  /// An internal node: which of its cells have children, which are active tiles. Children are
  /// numbered in the order of their bits.
  template <class Mask>
  struct Inner {
    const Mask* children = nullptr;
    const Mask* tiles = nullptr;
    std::uint32_t first = 0;
    std::array<std::uint16_t, Mask::WORD_COUNT> before{}; ///< children in earlier words
    void count();
    std::uint32_t child(std::uint32_t bit) const {
      const auto word = children->template getWord<openvdb::Index64>(bit >> 6);
      const std::uint64_t earlier = word & ((std::uint64_t(1) << (bit & 63)) - 1);
      return first + before[bit >> 6] + openvdb::util::CountOn(earlier);
    }
  };
  struct Upper : Inner<Mask5> {
    /// By group of 4^3 cells, of which it has 8^3: which of them hold anything.
    std::array<std::uint64_t, 512> groups{};
    void findGroups();
  };
  struct Lower : Inner<Mask4> {
    /// Which of its 4^3 blocks of 4^3 cells hold anything: rays cross the others in one step.
    std::uint64_t blocks = 0;
    std::array<std::uint64_t, 64> cells{}; ///< by block: which of its cells hold anything
    void findBlocks();
  };
  /// A leaf node, with a summary of its mask.
  struct Leaf {
    const Mask3* mask = nullptr;
    std::uint64_t pairs = 0; ///< which of its 4^3 cells of 2^3 voxels hold anything
    std::uint16_t count = 0; ///< of active voxels
  };
  struct Corner { ///< of the root: 4096^3 voxels
    const Upper* upper = nullptr;
    bool on = false;
  };
  struct Step;
  enum class Onward;
  bool enter(const IndexRay& ray, Step& step) const;
  /// Calls atLeaf(step, leaf, ahead, leave) for leaf nodes along the ray and atTile(step, log2Side)
  /// for active tiles, in order, until one says to stop; returns whether one did. atLeaf moves the
  /// step on by leave(log2Side), which is false where the ray ends.
  template <class AtLeaf, class AtTile>
  bool descend(const IndexRay& ray, const AtLeaf& atLeaf, const AtTile& atTile) const;

  /// The number of the cell of side 2^log2Side around a voxel in a node of 2^kLog2Cells of them.
  template <int kLog2Cells>
  static std::uint32_t place(const Vec3i& voxel, int log2Side) {
    constexpr std::int32_t kLast = (1 << kLog2Cells) - 1;
    return static_cast<std::uint32_t>((voxel[0] >> log2Side & kLast) << 2 * kLog2Cells |
                                      (voxel[1] >> log2Side & kLast) << kLog2Cells |
                                      (voxel[2] >> log2Side & kLast));
  }

  template <class TreeT>
  void index(const TreeT& tree);
  void findOutermost() const;
  /// Calls `f(low, mask)` for the leaf nodes in an internal node, and with a null mask for active
  /// tiles as large.
  template <class F>
  void forLeaves(std::size_t lower, const F& f) const;
  /// Calls `f(low, side)` for the active tiles of 128 and 4096 voxels.
  template <class F>
  void forLargeTiles(const F& f) const;
  const Corner* corner(const Vec3i& cell) const {
    std::size_t at = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t place = cell[a] - rootLow_[a];
      if (place < 0 || place >= rootCount_[a])
        return nullptr;
      at = at * static_cast<std::size_t>(rootCount_[a]) + static_cast<std::size_t>(place);
    }
    return rootTable_.empty() ? cornerInMap(cell) : rootTable_[at];
  }
  const Corner* cornerInMap(const Vec3i& cell) const;
  void tabulateRoot();
  /// The node of 128^3 voxels around one, or null; `on`: it is an active tile instead.
  const Lower* lowerAt(const Vec3i& voxel, bool& on) const;
  const Leaf* leafIn(const Lower& lower, const Vec3i& voxel, bool& on) const;

  std::unordered_map<std::uint64_t, Corner> root_; ///< by corner's place in units of 4096
  // The same as a dense table of the corners in the active voxels' box, where these are few.
  Vec3i rootLow_{0, 0, 0}, rootCount_{0, 0, 0};
  std::vector<const Corner*> rootTable_;
  std::vector<Upper> uppers_;
  std::vector<Lower> lowers_;
  std::vector<Leaf> leaves_;
  std::vector<Vec3i> lowerOrigins_;
  Vec3i low_{0, 0, 0}, high_{-1, -1, -1};
  mutable std::once_flag once_;
  mutable std::vector<Box> outermost_; ///< boxes whose hull is that of all
};

} // namespace tetvdb

#include "tetvdb/visualize/ActiveTreeCubes.h"
#include "tetvdb/visualize/ActiveTreeWalk.h"
