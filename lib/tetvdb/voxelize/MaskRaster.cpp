// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/MaskRaster.h"

#include "tetvdb/volume/GridTypes.h"

#include <cstdint>
#include <cstring>
#include <memory>
#include <openvdb/util/NodeMasks.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

using Masks = std::vector<openvdb::BoolGrid::ConstPtr>;
using Nodes = NodeLists<openvdb::BoolTree>;

// The content of a mask in a 128^3 node.
struct Piece {
  NodeIndex node;
  std::uint32_t owner;
  const Nodes::Lower* lower; // null: the node is full

  bool operator<(const Piece& o) const { return std::tie(node, owner) < std::tie(o.node, o.owner); }
};

NodeIndex nodeAt(const openvdb::Coord& c) {
  return {nodeOf(c.x()), nodeOf(c.y()), nodeOf(c.z())};
}

std::vector<Piece> piecesOf(const Masks& masks) {
  std::vector<Piece> pieces;
  for (std::uint32_t i = 0; i < masks.size(); ++i) {
    const openvdb::BoolTree& tree = masks[i]->constTree();
    const Nodes nodes(tree);
    for (const Nodes::Lower* lower : nodes.lowers)
      pieces.push_back({nodeAt(lower->origin()), i, lower});
    for (const Nodes::Upper* upper : nodes.uppers)
      for (auto tile = upper->cbeginValueOn(); tile; ++tile)
        pieces.push_back({nodeAt(tile.getCoord()), i, nullptr});
    constexpr int kSide = kRootChildSize / kNodeSize;
    for (auto tile = tree.root().cbeginValueOn(); tile; ++tile)
      for (int n = 0; n < kSide * kSide * kSide; ++n)
        pieces.push_back(
            {nodeAt(tile.getCoord().offsetBy(n / (kSide * kSide) * kNodeSize,
                                             n / kSide % kSide * kNodeSize, n % kSide * kNodeSize)),
             i, nullptr});
  }
  tbb::parallel_sort(pieces.begin(), pieces.end());
  return pieces;
}

// Active voxels of the leaf number `offset` of a node at x slab x: bit 8 y + z.
std::uint64_t activeWord(const Piece& piece, openvdb::Index offset, int x) {
  if (piece.lower == nullptr)
    return ~std::uint64_t(0);
  if (piece.lower->isChildMaskOn(offset)) {
    const auto& leaf = *piece.lower->getTable()[offset].getChild();
    return leaf.getValueMask().getWord<openvdb::Index64>(static_cast<openvdb::Index>(x));
  }
  return piece.lower->isValueMaskOn(offset) ? ~std::uint64_t(0) : 0;
}

struct SlabOwners {
  SlabBits bits;
  std::vector<std::uint32_t> owners = std::vector<std::uint32_t>(kSlabRows * kNodeSize);
};

// The owner of a voxel that is in several masks is the first of them.
bool fillSlab(const Piece* begin, const Piece* end, int index, SlabOwners& slab) {
  std::memset(&slab.bits, 0, sizeof slab.bits);
  bool any = false;
  for (int leaf = 0; leaf < kSlabsPerNode * kSlabsPerNode; ++leaf)
    for (int x = 0; x < kLeafSize; ++x) {
      const int y0 = leaf / kSlabsPerNode * kLeafSize, z0 = leaf % kSlabsPerNode * kLeafSize;
      std::uint64_t taken = 0;
      for (const Piece* piece = begin; piece != end && ~taken != 0; ++piece) {
        const std::uint64_t word =
            activeWord(*piece, static_cast<openvdb::Index>(index << 8 | leaf), x) & ~taken;
        taken |= word;
        for (std::uint64_t rest = word; rest != 0; rest &= rest - 1) {
          const auto bit = static_cast<int>(openvdb::util::FindLowestOn(rest));
          const int row = x * kNodeSize + y0 + bit / kLeafSize;
          slab.owners[static_cast<std::size_t>(row * kNodeSize + z0 + bit % kLeafSize)] =
              piece->owner;
        }
      }
      any = any || taken != 0;
      for (int y = 0; y < kLeafSize; ++y)
        slab.bits.rows[x * kNodeSize + y0 + y][z0 >> 6] |= (taken >> (8 * y) & 0xFF) << (z0 & 63);
    }
  return any;
}

} // namespace

void rasterizeMasks(const Masks& masks, NodeSink& sink, Progress& progress) {
  const std::vector<Piece> pieces = piecesOf(masks);
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (i == 0 || pieces[i].node != pieces[i - 1].node)
      starts.push_back(i);
  starts.push_back(pieces.size());
  tbb::enumerable_thread_specific<SlabOwners> scratch;
  tbb::parallel_for(std::size_t(0), starts.size() - 1, [&](std::size_t n) {
    progress.check();
    const Piece *begin = &pieces[starts[n]], *end = pieces.data() + starts[n + 1];
    if (begin->lower == nullptr)
      return sink.fullNode(begin->node, begin->owner);
    SlabOwners& slab = scratch.local();
    std::unique_ptr<NodeSink::Node> node = sink.begin(begin->node);
    for (int s = 0; s < kSlabsPerNode; ++s)
      if (fillSlab(begin, end, s, slab))
        sink.slab(*node, s, slab.bits, slab.owners.data());
    sink.end(std::move(node));
  });
}

} // namespace tetvdb
