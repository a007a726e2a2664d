// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/ActiveTree.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridTypes.h"

#include <algorithm>
#include <limits>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

/// Of the 4096^3 voxels around one, by their place in units of 4096: 20 bits an axis.
std::uint64_t cornerKey(const Vec3i& cell) {
  const auto part = [](std::int32_t v) { return std::uint64_t(std::uint32_t(v) & 0xFFFFF); };
  return part(cell[0]) << 40 | part(cell[1]) << 20 | part(cell[2]);
}

Vec3i cornerOf(const Vec3i& voxel) {
  return {voxel[0] >> 12, voxel[1] >> 12, voxel[2] >> 12};
}

/// Corners up to which a dense table of them is kept: 8 bytes each.
constexpr double kMaxInTable = 1 << 17;

/// Which of a leaf's 4^3 cells of 2^3 voxels hold anything.
std::uint64_t pairsOf(const openvdb::util::NodeMask<3>& mask) {
  std::uint64_t pairs = 0;
  for (std::uint32_t x = 0; x < 4; ++x) {
    std::uint64_t slab =
        mask.getWord<openvdb::Index64>(2 * x) | mask.getWord<openvdb::Index64>(2 * x + 1);
    slab |= slab >> 1; // of z
    slab = (slab | slab >> 8) & 0x0055005500550055;
    slab = (slab | slab >> 1) & 0x0033003300330033;
    slab = (slab | slab >> 2) & 0x000F000F000F000F;
    pairs |= ((slab | slab >> 12 | slab >> 24 | slab >> 36) & 0xFFFF) << 16 * x;
  }
  return pairs;
}

bool isSame(const Vec3i& a, const Vec3i& b, int log2Side) {
  return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) >> log2Side == 0;
}

/// Lines of leaf nodes up to which single voxels are visited for support().
constexpr std::size_t kFewLines = 4096;

Vec3i originOf(const openvdb::Coord& c) {
  return {c.x(), c.y(), c.z()};
}

} // namespace

template <class Mask>
void ActiveTree::Inner<Mask>::count() {
  std::uint32_t sum = 0;
  for (std::uint32_t word = 0; word < Mask::WORD_COUNT; ++word) {
    before[word] = static_cast<std::uint16_t>(sum);
    sum += openvdb::util::CountOn(children->template getWord<openvdb::Index64>(word));
  }
}

template struct ActiveTree::Inner<openvdb::util::NodeMask<5>>;
template struct ActiveTree::Inner<openvdb::util::NodeMask<4>>;

void ActiveTree::Lower::findBlocks() {
  // A word of the masks is a line of y and z with y / 4 the same: four lines of 16 cells along z.
  for (std::uint32_t word = 0; word < Mask4::WORD_COUNT; ++word) {
    const auto any =
        children->getWord<openvdb::Index64>(word) | tiles->getWord<openvdb::Index64>(word);
    const std::uint32_t x = word >> 2, y = word & 3;
    for (std::uint32_t z = 0; z < 4; ++z) {
      std::uint64_t lines = any >> (4 * z) & 0x000F000F000F000F;
      lines = (lines | lines >> 12 | lines >> 24 | lines >> 36) & 0xFFFF;
      const std::uint32_t block = (x >> 2) << 4 | y << 2 | z;
      cells[block] |= lines << 16 * (x & 3);
      blocks |= std::uint64_t(lines != 0) << block;
    }
  }
}

void ActiveTree::Upper::findGroups() {
  // A word of the masks is two lines of 32 cells along z.
  for (std::uint32_t word = 0; word < Mask5::WORD_COUNT; ++word) {
    const auto any =
        children->getWord<openvdb::Index64>(word) | tiles->getWord<openvdb::Index64>(word);
    const std::uint32_t x = word >> 4, y = (word & 15) << 1;
    for (std::uint32_t z = 0; z < 8; ++z) {
      const std::uint64_t lines = any >> (4 * z) & 0xF, next = any >> (32 + 4 * z) & 0xF;
      groups[(x >> 2) << 6 | (y >> 2) << 3 | z] |= (lines | next << 4)
                                                   << ((x & 3) << 4 | (y & 3) << 2);
    }
  }
}

template <class TreeT>
void ActiveTree::index(const TreeT& tree) {
  const NodeLists<TreeT> nodes(tree);
  const auto leaves = nodes.leaves();
  leaves_.resize(leaves.size());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    const Mask3& mask = leaves[i]->getValueMask();
    leaves_[i] = {&mask, pairsOf(mask), std::uint16_t(mask.countOn())};
  });
  const auto take = [](auto& into, const auto& from) {
    into.resize(from.size());
    tbb::parallel_for(std::size_t(0), from.size(), [&](std::size_t i) {
      into[i].children = &from[i]->getChildMask();
      into[i].tiles = &from[i]->getValueMask();
      into[i].count();
    });
    for (std::size_t i = 1; i < into.size(); ++i)
      into[i].first = into[i - 1].first + from[i - 1]->getChildMask().countOn();
  };
  take(uppers_, nodes.uppers);
  take(lowers_, nodes.lowers);
  tbb::parallel_for(std::size_t(0), lowers_.size(),
                    [&](std::size_t i) { lowers_[i].findBlocks(); });
  for (Upper& upper : uppers_)
    upper.findGroups();
  for (std::size_t i = 0; i < uppers_.size(); ++i)
    root_[cornerKey(cornerOf(originOf(nodes.uppers[i]->origin())))].upper = &uppers_[i];
  for (auto tile = tree.root().cbeginValueOn(); tile; ++tile)
    root_[cornerKey(cornerOf(originOf(tile.getCoord())))].on = true;
  for (const auto* lower : nodes.lowers)
    lowerOrigins_.push_back(originOf(lower->origin()));
  openvdb::CoordBBox box;
  if (tree.evalActiveVoxelBoundingBox(box)) {
    low_ = originOf(box.min());
    high_ = originOf(box.max());
  }
  tabulateRoot();
}

void ActiveTree::tabulateRoot() {
  if (low_[0] > high_[0])
    return;
  rootLow_ = cornerOf(low_);
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    rootCount_[a] = (high_[a] >> 12) - rootLow_[a] + 1;
    cells *= rootCount_[a];
  }
  if (cells > kMaxInTable)
    return;
  rootTable_.reserve(static_cast<std::size_t>(cells));
  for (std::int32_t i = 0; i < rootCount_[0]; ++i)
    for (std::int32_t j = 0; j < rootCount_[1]; ++j)
      for (std::int32_t k = 0; k < rootCount_[2]; ++k)
        rootTable_.push_back(cornerInMap({rootLow_[0] + i, rootLow_[1] + j, rootLow_[2] + k}));
}

ActiveTree::ActiveTree(const openvdb::GridBase& grid) {
  if (!withKnownGrid(grid, [&](const auto& typed) { index(typed.constTree()); }))
    throw Error(Status::Usage, grid.getName(),
                "a grid of type " + grid.valueType() + " is unknown");
}

const ActiveTree::Corner* ActiveTree::cornerInMap(const Vec3i& cell) const {
  const auto found = root_.find(cornerKey(cell));
  return found == root_.end() ? nullptr : &found->second;
}

const ActiveTree::Lower* ActiveTree::lowerAt(const Vec3i& voxel, bool& on) const {
  on = false;
  const Corner* at = corner(cornerOf(voxel));
  if (!at)
    return nullptr;
  on = at->on;
  if (!at->upper)
    return nullptr;
  const std::uint32_t bit = place<5>(voxel, 7);
  on = at->upper->tiles->isOn(bit);
  return at->upper->children->isOn(bit) ? &lowers_[at->upper->child(bit)] : nullptr;
}

const ActiveTree::Leaf* ActiveTree::leafIn(const Lower& lower, const Vec3i& voxel, bool& on) const {
  const std::uint32_t bit = place<4>(voxel, 3);
  on = lower.tiles->isOn(bit);
  return lower.children->isOn(bit) ? &leaves_[lower.child(bit)] : nullptr;
}

/// Of what lies in a line along z only the lowest and the highest can reach furthest in any
/// direction: of leaf nodes (and tiles as large), or in small trees, where those are a large part
/// of the whole, of voxels.
void ActiveTree::findOutermost() const {
  struct Line {
    std::int32_t x, y, low, high;
  };
  std::unordered_map<std::uint64_t, Line> lines;
  const auto add = [&lines](const Line& part) {
    const auto key = std::uint64_t(std::uint32_t(part.x)) << 32 | std::uint32_t(part.y);
    const auto [line, added] = lines.try_emplace(key, part);
    if (!added) {
      line->second.low = std::min(line->second.low, part.low);
      line->second.high = std::max(line->second.high, part.high);
    }
  };
  const auto forAll = [this](const auto& f) {
    for (std::size_t i = 0; i < lowers_.size(); ++i)
      forLeaves(i, f);
  };
  forAll([&](const Vec3i& node, const Mask3*) { add({node[0], node[1], node[2], node[2] + 8}); });
  std::int32_t side = 8;
  if (lines.size() <= kFewLines) {
    lines.clear();
    side = 1;
    forAll([&](const Vec3i& node, const Mask3* leaf) {
      for (std::uint32_t column = 0; column < 64; ++column) {
        const std::uint64_t slab =
            leaf ? leaf->getWord<openvdb::Index64>(column >> 3) : ~std::uint64_t(0);
        const auto run = static_cast<std::uint32_t>(slab >> (8 * (column & 7)) & 0xFF);
        if (run != 0)
          add({node[0] + std::int32_t(column >> 3), node[1] + std::int32_t(column & 7),
               node[2] + std::int32_t(openvdb::util::FindLowestOn(run)),
               node[2] + std::int32_t(openvdb::util::FindHighestOn(run)) + 1});
      }
    });
  }
  const auto addBox = [this](const Vec3i& low, std::int32_t width, std::int32_t height) {
    outermost_.push_back(
        {{double(low[0]), double(low[1]), double(low[2])},
         {double(low[0]) + width, double(low[1]) + width, double(low[2]) + height}});
  };
  for (const auto& [key, line] : lines)
    addBox({line.x, line.y, line.low}, side, line.high - line.low);
  forLargeTiles([&](const Vec3i& low, std::int32_t tile) { addBox(low, tile, tile); });
}

double ActiveTree::support(const Vec3d& direction) const {
  std::call_once(once_, [this] { findOutermost(); });
  double reach = -std::numeric_limits<double>::infinity();
  for (const Box& box : outermost_)
    reach = std::max(reach, supportOf(box, direction));
  Box all;
  if (low_[0] <= high_[0]) {
    all.add(Vec3d{double(low_[0]), double(low_[1]), double(low_[2])});
    all.add(Vec3d{high_[0] + 1.0, high_[1] + 1.0, high_[2] + 1.0});
  }
  return std::min(reach, supportOf(all, direction));
}

bool ActiveTree::isOn(const Vec3i& voxel) const {
  return Probe(*this).isOn(voxel);
}

void ActiveTree::Probe::findLower(const Vec3i& voxel) {
  if (isLowerKnown_ && isSame(voxel, inLower_, 7))
    return;
  lower_ = tree_.lowerAt(voxel, lowerTile_);
  inLower_ = voxel;
  isLowerKnown_ = true;
}

void ActiveTree::Probe::find(const Vec3i& voxel) {
  if (isLeafKnown_ && isSame(voxel, inLeaf_, 3))
    return;
  findLower(voxel);
  inLeaf_ = voxel;
  isLeafKnown_ = true;
  tile_ = lowerTile_;
  leaf_ = lower_ ? tree_.leafIn(*lower_, voxel, tile_) : nullptr;
}

std::array<double, 4> ActiveTree::Probe::filledLeaves(const Vec3i& leaf) {
  std::array<double, 4> shares{};
  for (std::size_t k = 0; k < 4;) {
    const Vec3i voxel{leaf[0] * 8, leaf[1] * 8, (leaf[2] + std::int32_t(k)) * 8};
    findLower(voxel);
    // The row runs along a word of the node's masks, to the node's end at most.
    std::uint32_t bit = place<4>(voxel, 3);
    const std::size_t end = std::min<std::size_t>(4, k + 16 - (bit & 15));
    if (!lower_) {
      std::fill(&shares[k], shares.data() + end, lowerTile_ ? 1.0 : 0.0);
      k = end;
      continue;
    }
    for (std::uint32_t child = lower_->child(bit); k < end; ++k, ++bit) {
      if (lower_->children->isOn(bit))
        shares[k] = tree_.leaves_[child++].count / 512.0;
      else
        shares[k] = lower_->tiles->isOn(bit) ? 1 : 0;
    }
  }
  return shares;
}

std::array<double, 4> ActiveTree::Probe::filled(const Vec3i& cell, int log2Side) {
  if (log2Side == 3)
    return filledLeaves(cell);
  const std::int32_t side = 1 << log2Side;
  const std::uint64_t run = (std::uint64_t(1) << side) - 1; // along z
  std::uint64_t lines = 0;                                  // along y and z
  for (std::int32_t y = 0; y < side; ++y)
    lines |= run << (8 * y);
  std::array<double, 4> shares{};
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3i voxel{cell[0] * side, cell[1] * side, (cell[2] + std::int32_t(k)) * side};
    find(voxel);
    if (!leaf_) {
      shares[k] = tile_ ? 1 : 0;
      continue;
    }
    const std::uint64_t these = lines << (8 * (voxel[1] & 7) + (voxel[2] & 7));
    std::uint32_t on = 0;
    for (std::int32_t x = 0; x < side; ++x)
      on += openvdb::util::CountOn(
          leaf_->mask->getWord<openvdb::Index64>(std::uint32_t((voxel[0] & 7) + x)) & these);
    shares[k] = double(on) / double(side * side * side);
  }
  return shares;
}

bool ActiveTree::Probe::isOn(const Vec3i& voxel) {
  find(voxel);
  return leaf_ ? leaf_->mask->isOn(place<3>(voxel, 0)) : tile_;
}

} // namespace tetvdb
