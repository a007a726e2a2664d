// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/RuleSink.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {

// A node under construction: the next sink's node, and the faces that pass through it.
struct RuleSink::RuledNode : NodeSink::Node {
  std::unique_ptr<NodeSink::Node> next;
  NodeIndex index;
  std::vector<TouchedFace> faces;
  std::array<bool, kSlabsPerNode> done{}; // slabs, each by one thread
};

RuledFaces::RuledFaces(const SnappedMesh& mesh, const Boundary& faces, Progress& progress)
    : mesh_(mesh), faces_(faces) {
  const auto addNodes = [&](std::size_t i, std::vector<NodeFace>& out) {
    const BoundaryFace& f = faces.faces[i];
    const TouchedFace face(mesh.points[f.a], mesh.points[f.b], mesh.points[f.c]);
    if (!face.passes())
      return;
    const auto first = [&](std::size_t k) { return nodeOf(face.first()[k]); };
    const auto last = [&](std::size_t k) { return nodeOf(face.last()[k]); };
    for (std::int32_t x = first(0); x <= last(0); ++x)
      for (std::int32_t y = first(1); y <= last(1); ++y)
        for (std::int32_t z = first(2); z <= last(2); ++z)
          if (face.mayMeet({x, y, z}))
            out.push_back({{x, y, z}, static_cast<std::uint32_t>(i)});
  };
  pairs_ = groupItems<NodeFace>(faces.faces.size(), 4096, addNodes, progress);
}

std::size_t RuledFaces::lowerBound(const NodeIndex& node) const {
  const auto at = std::lower_bound(pairs_.starts.begin(), pairs_.starts.end() - 1, node,
                                   [&](std::size_t start, const NodeIndex& wanted) {
                                     return pairs_.items[start].node < wanted;
                                   });
  return static_cast<std::size_t>(at - pairs_.starts.begin());
}

void RuledFaces::prepare(std::size_t at, std::vector<TouchedFace>& faces) const {
  const std::vector<std::size_t>& starts = pairs_.starts;
  faces.reserve(starts[at + 1] - starts[at]);
  for (std::size_t i = starts[at]; i != starts[at + 1]; ++i) {
    const BoundaryFace& f = faces_.faces[pairs_.items[i].face];
    faces.emplace_back(mesh_.points[f.a], mesh_.points[f.b], mesh_.points[f.c]);
  }
}

RuleSink::RuleSink(NodeSink& next, const RuledFaces& faces, VoxelRule rule, std::size_t first,
                   std::size_t end)
    : next_(next), faces_(faces), adds_(rule == VoxelRule::Any), first_(first),
      seen_(end - first, 0) {}

std::size_t RuleSink::find(const NodeIndex& node) const {
  const std::size_t at = faces_.lowerBound(node);
  return at < first_ + seen_.size() && faces_.node(at) == node ? at : kNoFaces;
}

std::unique_ptr<NodeSink::Node> RuleSink::begin(const NodeIndex& index) {
  auto node = std::make_unique<RuledNode>();
  node->next = next_.begin(index);
  node->index = index;
  if (const std::size_t at = find(index); at != kNoFaces) {
    seen_[at - first_] = 1;
    faces_.prepare(at, node->faces);
  }
  return node;
}

// The voxels of a slab that faces pass through; false where there are no such faces.
bool RuleSink::touch(const RuledNode& node, int index, SlabBits& bits) const {
  const std::int64_t x0 = std::int64_t(node.index[0]) * kNodeSize + index * kLeafSize;
  bool any = false;
  for (const TouchedFace& face : node.faces) {
    if (face.last()[0] < x0 || face.first()[0] >= x0 + kLeafSize)
      continue;
    if (!any)
      std::memset(&bits, 0, sizeof bits);
    any = true;
    face.rasterize(x0, std::int64_t(node.index[1]) * kNodeSize,
                   std::int64_t(node.index[2]) * kNodeSize, bits);
  }
  return any;
}

// `inside` null: no centre of the slab is.
void RuleSink::passOn(RuledNode& node, int index, const SlabBits* inside) {
  node.done[static_cast<std::size_t>(index)] = true;
  const auto bits = std::make_unique<SlabBits>();
  if (!touch(node, index, *bits)) {
    if (inside != nullptr)
      next_.slab(*node.next, index, *inside, nullptr);
    return;
  }
  std::uint64_t any = 0;
  for (int row = 0; row < kSlabRows; ++row)
    for (int word = 0; word < 2; ++word) {
      std::uint64_t& touched = bits->rows[row][word];
      const std::uint64_t in = inside == nullptr ? 0 : inside->rows[row][word];
      touched = adds_ ? in | touched : in & ~touched;
      any |= touched;
    }
  if (any != 0)
    next_.slab(*node.next, index, *bits, nullptr);
}

void RuleSink::slab(Node& node, int index, const SlabBits& bits, const std::uint32_t*) {
  passOn(static_cast<RuledNode&>(node), index, &bits);
}

void RuleSink::end(std::unique_ptr<Node> node) {
  auto& ruled = static_cast<RuledNode&>(*node);
  for (int index = 0; adds_ && index < kSlabsPerNode; ++index)
    if (!ruled.done[static_cast<std::size_t>(index)])
      passOn(ruled, index, nullptr);
  next_.end(std::move(ruled.next));
}

void RuleSink::fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) {
  std::int32_t from = zBegin;
  const auto passRun = [&](std::int32_t to) {
    if (from < to)
      next_.fullRun(x, y, from, to);
  };
  for (std::int32_t z = zBegin; z < zEnd; ++z) {
    const NodeIndex index{x, y, z};
    const std::size_t at = find(index);
    if (at == kNoFaces)
      continue;
    if (adds_) { // full as it is
      seen_[at - first_] = 1;
      continue;
    }
    passRun(z);
    from = z + 1;
    const auto full = std::make_unique<SlabBits>();
    std::memset(full.get(), 0xFF, sizeof *full);
    std::unique_ptr<Node> node = begin(index);
    for (int i = 0; i < kSlabsPerNode; ++i)
      slab(*node, i, *full, nullptr);
    end(std::move(node));
  }
  passRun(zEnd);
}

void RuleSink::fullNode(const NodeIndex& node, std::uint32_t) {
  fullRun(node[0], node[1], node[2], node[2] + 1);
}

void RuleSink::finish() {
  if (!adds_)
    return;
  tbb::parallel_for(std::size_t(0), seen_.size(), [&](std::size_t i) {
    if (seen_[i] == 0)
      end(begin(faces_.node(first_ + i)));
  });
}

} // namespace tetvdb
