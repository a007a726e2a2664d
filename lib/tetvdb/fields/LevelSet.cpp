// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/LevelSet.h"

#include "tetvdb/core/Multiversion.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;
using FloatUpper = openvdb::FloatTree::RootNodeType::ChildNodeType;
using FloatLower = FloatUpper::ChildNodeType;
using MaskLeaf = openvdb::BoolTree::LeafNodeType;
using MaskUpper = openvdb::BoolTree::RootNodeType::ChildNodeType;
using MaskLower = MaskUpper::ChildNodeType;

constexpr std::int32_t kNodesAlong = kRootChildSize / kNodeSize;

// Values and active voxels of a leaf from squared distances in voxels and the inside voxels.
struct SignedLeaf {
  float values[kVoxelsInLeaf];
  std::uint64_t active[kLeafSize];
};

TETVDB_MULTIVERSION
bool signLeaf(const float* squared, const std::uint64_t* inside, const NarrowBand& narrow,
              SignedLeaf& leaf) {
  const NarrowBand band = narrow;
  std::uint64_t any = 0;
  for (int x = 0; x < kLeafSize; ++x) {
    float absolutes[kLeafSize * kLeafSize];
    std::uint8_t near[kLeafSize * kLeafSize];
    const float* row = squared + x * kLeafSize * kLeafSize;
    for (int i = 0; i < kLeafSize * kLeafSize; ++i) {
      const float distance = band.distance(row[i]);
      near[i] = band.isActive(distance);
      absolutes[i] = band.absolute(distance);
    }
    std::uint64_t active = 0;
    for (int i = 0; i < kLeafSize * kLeafSize; ++i) {
      active |= static_cast<std::uint64_t>(near[i]) << i;
      leaf.values[x * kLeafSize * kLeafSize + i] =
          (inside[x] >> i & 1) != 0 ? -absolutes[i] : absolutes[i];
    }
    leaf.active[x] = active;
    any |= active;
  }
  return any != 0;
}

// The inside voxels of a 128^3 node.
class InsideOfNode {
public:
  InsideOfNode(const openvdb::BoolTree& tree, const openvdb::Coord& origin)
      : node_(tree.probeConstNode<MaskLower>(origin)),
        full_(node_ == nullptr && tree.isValueOn(origin)) {}

  bool full(openvdb::Index leaf) const {
    return node_ == nullptr ? full_ : !node_->isChildMaskOn(leaf) && node_->isValueMaskOn(leaf);
  }
  /// Inside voxels of a leaf, eight words; returns whether both inside and outside voxels exist.
  bool words(openvdb::Index leaf, std::uint64_t* out) const {
    if (node_ == nullptr || !node_->isChildMaskOn(leaf)) {
      std::fill(out, out + kLeafSize, full(leaf) ? ~std::uint64_t(0) : 0);
      return false;
    }
    const auto& mask = node_->getTable()[leaf].getChild()->getValueMask();
    for (openvdb::Index x = 0; x < kLeafSize; ++x)
      out[x] = mask.getWord<openvdb::Index64>(x);
    return !mask.isOn() && !mask.isOff();
  }
  bool mixed(openvdb::Index leaf) const {
    std::uint64_t unused[kLeafSize];
    return node_ != nullptr && words(leaf, unused);
  }

private:
  const MaskLower* node_;
  bool full_;
};

FloatLeaf* makeLeaf(const openvdb::Coord& origin, const SignedLeaf& signs) {
  auto leaf = std::make_unique<FloatLeaf>(openvdb::PartialCreate(), origin, 0.0f, false);
  leaf->allocate();
  std::memcpy(leaf->buffer().data(), signs.values, sizeof signs.values);
  for (openvdb::Index x = 0; x < kLeafSize; ++x)
    leaf->getValueMask().getWord<openvdb::Index64>(x) = signs.active[x];
  return leaf.release();
}

// One 128^3 node of the level set; null, with one value, if it is all inside or outside.
struct Part {
  NodeIndex index;
  std::unique_ptr<FloatLower> node;
  bool inside = false;
};

class Builder {
public:
  Builder(const openvdb::BoolTree& inside, double halfWidth, double shell, double voxel)
      : inside_(inside), band_(halfWidth, shell, voxel) {}

  float background() const { return band_.background; }

  // `distances`: of the node's leaves; null if the band does not reach it.
  void build(Part& part, const NodeLeaves* distances) const {
    const openvdb::Coord origin(part.index[0] * kNodeSize, part.index[1] * kNodeSize,
                                part.index[2] * kNodeSize);
    const InsideOfNode inside(inside_, origin);
    std::vector<FloatLeaf*> leaves(kLeavesInNode, nullptr);
    const auto leafOrigin = [&](int leaf) {
      return origin.offsetBy((leaf >> 8) * kLeafSize, (leaf >> 4 & 15) * kLeafSize,
                             (leaf & 15) * kLeafSize);
    };
    const auto add = [&](int leaf, const float* squared) {
      std::uint64_t words[kLeafSize];
      const bool mixed = inside.words(static_cast<openvdb::Index>(leaf), words);
      SignedLeaf signs;
      if (signLeaf(squared, words, band_, signs) || mixed)
        leaves[static_cast<std::size_t>(leaf)] = makeLeaf(leafOrigin(leaf), signs);
    };
    if (distances != nullptr)
      (*distances)(add);

    part.node = std::make_unique<FloatLower>(origin, background(), false);
    bool uniform = true;
    part.inside = inside.full(0);
    for (int i = 0; i < kLeavesInNode; ++i) {
      const auto leaf = static_cast<openvdb::Index>(i);
      FloatLeaf*& made = leaves[static_cast<std::size_t>(i)];
      if (made == nullptr && inside.mixed(leaf)) {
        // The solid's boundary is away from faces.
        const std::vector<float> far(kVoxelsInLeaf, std::numeric_limits<float>::max());
        add(i, far.data());
      }
      if (made != nullptr)
        part.node->addLeaf(made);
      else if (inside.full(leaf))
        part.node->addTile(leaf, -background(), false);
      uniform = uniform && made == nullptr && inside.full(leaf) == part.inside;
    }
    if (uniform)
      part.node.reset();
  }

private:
  const openvdb::BoolTree& inside_;
  NarrowBand band_;
};

NodeIndex upperOf(const NodeIndex& node) {
  return {node[0] >> 5, node[1] >> 5, node[2] >> 5};
}

openvdb::Coord upperOrigin(const NodeIndex& upper) {
  return {upper[0] * kRootChildSize, upper[1] * kRootChildSize, upper[2] * kRootChildSize};
}

openvdb::Index offsetInUpper(const NodeIndex& node) {
  const auto local = [](std::int32_t v) {
    return static_cast<openvdb::Index>(v & (kNodesAlong - 1));
  };
  return local(node[0]) << 10 | local(node[1]) << 5 | local(node[2]);
}

NodeIndex nodeAt(const openvdb::Coord& voxel) {
  return {nodeOf(voxel.x()), nodeOf(voxel.y()), nodeOf(voxel.z())};
}

// All of `nodes` and those that the boundary of `inside` passes through, ascending.
std::vector<NodeIndex> withMixedOf(std::vector<NodeIndex> nodes, const openvdb::BoolTree& inside) {
  for (auto upper = inside.root().cbeginChildOn(); upper; ++upper)
    for (auto lower = upper->cbeginChildOn(); lower; ++lower)
      nodes.push_back(nodeAt(lower->origin()));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// The tree of finished nodes; the gaps between them are tiles, by `inside`.
openvdb::FloatTree::Ptr assemble(std::vector<Part>& parts, const openvdb::BoolTree& inside,
                                 float background) {
  std::map<NodeIndex, std::vector<Part*>> uppers;
  for (Part& part : parts)
    uppers[upperOf(part.index)].push_back(&part);
  auto tree = std::make_shared<openvdb::FloatTree>(background);
  for (auto tile = inside.root().cbeginValueOn(); tile; ++tile)
    if (uppers.find(upperOf(nodeAt(tile.getCoord()))) == uppers.end())
      tree->root().addTile(tile.getCoord(), -background, false);
  for (auto child = inside.root().cbeginChildOn(); child; ++child)
    uppers.try_emplace(upperOf(nodeAt(child->origin()))); // of tiles only

  for (auto& [index, held] : uppers) {
    const openvdb::Coord origin = upperOrigin(index);
    const auto* mask = inside.probeConstNode<MaskUpper>(origin);
    const bool full = mask == nullptr && inside.isValueOn(origin);
    auto upper = std::make_unique<FloatUpper>(origin, full ? -background : background, false);
    if (mask != nullptr)
      for (auto tile = mask->cbeginValueOn(); tile; ++tile)
        upper->addTile(tile.pos(), -background, false);
    for (Part* part : held) {
      if (part->node)
        upper->addChild(part->node.release());
      else
        upper->addTile(offsetInUpper(part->index), part->inside ? -background : background, false);
    }
    float value = 0;
    bool active = false;
    if (upper->getChildMask().isOff() && upper->isConstant(value, active)) {
      if (value < 0)
        tree->root().addTile(origin, value, false);
    } else {
      tree->root().addChild(upper.release());
    }
  }
  return tree;
}

// The level set in the band's nodes `bandNodes`, ascending, and the nodes of `inside`. rasterize():
// passes these nodes of the band to the taker.
template <typename Rasterize>
openvdb::FloatGrid::Ptr
makeLevelSet(const DistanceBand& band, const std::vector<std::size_t>& bandNodes,
             const openvdb::BoolTree& inside, const GridTransform& transform, double halfWidth,
             double shell, const Rasterize& rasterize, Progress& progress) {
  const Builder builder(inside, halfWidth, shell, transform.voxelSize[0]);
  std::vector<NodeIndex> reached;
  for (const std::size_t node : bandNodes)
    reached.push_back(band.nodes()[node]);
  const std::vector<NodeIndex> nodes = withMixedOf(std::move(reached), inside);
  std::vector<Part> parts(nodes.size());
  std::vector<std::size_t> ofBand, others; // nodes of the band, in its order, and the others
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    parts[i].index = nodes[i];
    const bool isIn =
        ofBand.size() < bandNodes.size() && band.nodes()[bandNodes[ofBand.size()]] == nodes[i];
    (isIn ? ofBand : others).push_back(i);
  }
  std::atomic<std::size_t> done{0};
  const auto build = [&](std::size_t part, const NodeLeaves* leaves) {
    builder.build(parts[part], leaves);
    progress.update(static_cast<double>(++done) / static_cast<double>(nodes.size()));
  };
  rasterize([&](std::size_t node, const NodeLeaves& leaves) {
    const auto at = std::lower_bound(bandNodes.begin(), bandNodes.end(), node);
    build(ofBand[static_cast<std::size_t>(at - bandNodes.begin())], &leaves);
  });
  tbb::parallel_for(std::size_t(0), others.size(),
                    [&](std::size_t i) { build(others[i], nullptr); });
  auto grid = openvdb::FloatGrid::create(assemble(parts, inside, builder.background()));
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(makeTransform(transform));
  return grid;
}

void rasterizeNodes(const DistanceBand& band, const std::vector<std::size_t>& nodes,
                    const NodeTaker& take, Progress& progress) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, nodes.size(), 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          progress.check();
          take(nodes[i],
               [&](const DistanceBand::LeafSink& sink) { band.rasterize(nodes[i], sink); });
        }
      },
      tbb::simple_partitioner());
}

std::vector<std::size_t> allNodes(const DistanceBand& band) {
  std::vector<std::size_t> nodes(band.nodes().size());
  std::iota(nodes.begin(), nodes.end(), std::size_t(0));
  return nodes;
}

} // namespace

void rasterizeBand(const DistanceBand& band, const NodeTaker& take, Progress& progress) {
  rasterizeNodes(band, allNodes(band), take, progress);
}

openvdb::FloatGrid::Ptr levelSet(const SnappedMesh& mesh, const Boundary& faces,
                                 const openvdb::BoolGrid& inside, const GridTransform& transform,
                                 double halfWidth, double shell, const BandRasterizer& rasterize,
                                 Progress& progress) {
  const DistanceBand band(mesh, faces, halfWidth + shell, progress);
  return makeLevelSet(
      band, allNodes(band), inside.constTree(), transform, halfWidth, shell,
      [&](const NodeTaker& take) { rasterize(band, take, progress); }, progress);
}

openvdb::FloatGrid::Ptr levelSetWithin(const NodeBox& box, const DistanceBand& band,
                                       const openvdb::BoolGrid& inside,
                                       const GridTransform& transform, double halfWidth,
                                       double shell, Progress& progress) {
  std::vector<std::size_t> nodes;
  eachRangeIn(
      box, band.nodes().size(), [&](std::size_t i) { return band.nodes()[i]; },
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          nodes.push_back(i);
      });
  return makeLevelSet(
      band, nodes, inside.constTree(), transform, halfWidth, shell,
      [&](const NodeTaker& take) { rasterizeNodes(band, nodes, take, progress); }, progress);
}

} // namespace tetvdb
