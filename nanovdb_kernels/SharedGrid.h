// SPDX-License-Identifier: Apache-2.0
//
// One grid from several backends, each of which builds some columns of root tiles. A share's nodes
// follow those of the share before on every level, so that each is written as if in the whole
// buffer. The head of the grid is made on the host by the same kernel.
#pragma once

#include "Pipeline.h"

namespace tetvdb::nano {

/// The contribution of one share to the grid's head, in host memory.
struct RootsOfShare {
  std::vector<RootEntry> entries;
  std::vector<u64> voxels;
  std::vector<Moments> moments;
  u64 totals[4] = {};
};

/// Computes the layouts of the shares from their counts. Throws Error(Limit) for 2^32 nodes of a
/// level.
struct SharedLayout {
  SharedLayout(Kind kind, const std::vector<NodeCounts>& counts) {
    for (const NodeCounts& c : counts) {
      all.rootTiles += c.rootTiles;
      all.uppers += c.uppers;
      all.lowers += c.lowers;
      all.leaves += c.leaves;
    }
    for (const NodeCounts& c : counts) {
      shares.push_back(layoutOf(kind, all, before, c));
      before.rootTiles += c.rootTiles;
      before.uppers += c.uppers;
      before.lowers += c.lowers;
      before.leaves += c.leaves;
    }
    whole = layoutOf(kind, all);
  }

  NodeCounts all;
  std::vector<BufferLayout> shares;
  BufferLayout whole;

private:
  NodeCounts before;
};

/// Writes a share's nodes and copies them, unless `grid` is null, to their places in the whole
/// grid's buffer in host memory.
template <typename Backend>
RootsOfShare writeShare(Backend& b, Pipeline<Backend>& pipeline, const BufferLayout& l, u8* grid) {
  u8* nodes = b.output(l.sizeHere);
  pipeline.write(nodes, l);
  RootsOfShare roots;
  if (grid == nullptr)
    return roots;
  b.stage("download");
  b.download(grid + l.upper, nodes + l.upperHere, l.lowerHere - l.upperHere);
  b.download(grid + l.lower, nodes + l.lowerHere, l.leafHere - l.lowerHere);
  b.download(grid + l.leaf, nodes + l.leafHere, l.sizeHere - l.leafHere);
  const RootParts parts = pipeline.writer().roots();
  const auto take = [&](auto& to, const auto* from, u64 count) {
    to.resize(count);
    b.download(to.data(), from, count);
  };
  take(roots.entries, parts.entries, parts.count);
  take(roots.voxels, parts.voxels, l.uppers);
  if (pipeline.writer().valuesDiffer())
    take(roots.moments, parts.moments, l.uppers);
  b.download(roots.totals, parts.totals, 4);
  return roots;
}

/// Writes the head of the grid whose nodes are in `grid`: on the host, in HostTwin.cpp, since
/// kernels in a file that nvcc compiles run only on the device.
void writeSharedHead(const KeySpace& space, Kind kind, const GridValues& values,
                     const nanovdb::GridData& header, const SharedLayout& layout,
                     const std::vector<RootsOfShare>& shares, u8* grid);

} // namespace tetvdb::nano
