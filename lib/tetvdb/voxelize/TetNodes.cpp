// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TetNodes.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/Ownership.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tuple>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNoTet = 0xFFFFFFFFu;
// Slab numbers of a node are 0 to 15; this one marks a tet that fills the node.
constexpr int kWholeNode = kSlabsPerNode;
constexpr int kKeysPerNode = kSlabsPerNode + 1;

struct Key {
  std::int32_t x, y, z;
  std::int32_t slab;
  bool operator<(const Key& o) const {
    return std::tie(x, y, z, slab) < std::tie(o.x, o.y, o.z, o.slab);
  }
  bool operator==(const Key& o) const { return x == o.x && y == o.y && z == o.z && slab == o.slab; }
  bool sameNode(const Key& o) const { return x == o.x && y == o.y && z == o.z; }
};

// Tets of one slab, ascending.
struct Bin {
  Key key;
  std::size_t begin, end; // in Bins::tets
};

struct Bins {
  std::vector<Bin> bins; // ascending by key, none empty
  std::vector<std::uint32_t> tets;
  OrientationCounts counts; // of those tets that rasterizing does not count
};

// Calls visit(x, y, z, slab) for every slab that may hold voxels of the tet.
template <typename Visit>
void eachSlab(const SnappedMesh& mesh, std::size_t tet, const TetBox& box, const Visit& visit) {
  const auto node = [](std::int64_t v) { return v >> 7; };
  const bool large = box.spansNodes();
  for (std::int64_t x = node(box.min[0]); x <= node(box.max[0]); ++x)
    for (std::int64_t y = node(box.min[1]); y <= node(box.max[1]); ++y)
      for (std::int64_t z = node(box.min[2]); z <= node(box.max[2]); ++z) {
        if (large) {
          TetBox nodeBox;
          const std::int64_t first[3] = {x * kNodeSize, y * kNodeSize, z * kNodeSize};
          for (int k = 0; k < 3; ++k) {
            nodeBox.min[k] = first[k];
            nodeBox.max[k] = first[k] + kNodeSize - 1;
          }
          const Cover cover = classifyBox(mesh, tet, nodeBox);
          if (cover == Cover::Outside)
            continue;
          if (cover == Cover::Inside) {
            visit(x, y, z, kWholeNode);
            continue;
          }
        }
        const int first = static_cast<int>(std::max(box.min[0] - x * kNodeSize, std::int64_t(0)));
        const int last =
            static_cast<int>(std::min(box.max[0] - x * kNodeSize, std::int64_t(kNodeSize - 1)));
        for (int s = first / kLeafSize; s <= last / kLeafSize; ++s)
          visit(x, y, z, s);
      }
}

// Rasterizing counts a tet in the slab where its box begins. Tets without voxel centres are never
// rasterised, and large ones may not be.
void countHere(const SnappedMesh& mesh, std::size_t tet, OrientationCounts& counts) {
  const std::uint32_t* v = mesh.tets + 4 * tet;
  counts.count(
      tetOrientation(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]]));
}

void checkExtent(const SnappedMesh& mesh, std::size_t tet, const TetBox& box) {
  constexpr std::int64_t limit = std::int64_t(1) << 20;
  for (int k = 0; k < 3; ++k)
    if (box.max[k] - box.min[k] < limit - 1)
      continue;
    else {
      const std::uint32_t* v = mesh.tets + 4 * tet;
      if (boxOf(mesh.points[v[0]], mesh.points[v[1]], mesh.points[v[2]], mesh.points[v[3]])
              .extent() > kMaxTetExtent)
        throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
      return;
    }
}

// Bins by counting, for grids whose nodes can be numbered densely.
class CountedBins {
public:
  CountedBins(const SnappedMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {
    const double low[3] = {mesh.boxMin.x, mesh.boxMin.y, mesh.boxMin.z};
    const double high[3] = {mesh.boxMax.x, mesh.boxMax.y, mesh.boxMax.z};
    for (int k = 0; k < 3; ++k) {
      first_[k] = ceilVoxel(low[k]) >> 7;
      size_[k] = std::max<std::int64_t>((floorVoxel(high[k]) >> 7) - first_[k] + 1, 1);
    }
  }

  // Whether the table of counts stays small.
  bool fits() const {
    return static_cast<double>(size_[0]) * static_cast<double>(size_[1]) *
               static_cast<double>(size_[2]) * kKeysPerNode <=
           kMaxBins;
  }

  Bins make() {
    const auto binCount = static_cast<std::size_t>(size_[0] * size_[1] * size_[2] * kKeysPerNode);
    const std::size_t chunkSize = std::max(kMinChunk, mesh_.tetCount / kMaxChunks + 1);
    const std::size_t chunks = (mesh_.tetCount + chunkSize - 1) / chunkSize;
    struct Pair {
      std::uint32_t bin, tet;
    };
    std::vector<std::vector<Pair>> pairs(chunks);
    std::vector<std::uint32_t> table(binCount * chunks);
    std::vector<OrientationCounts> counts(chunks);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
      progress_.check();
      std::vector<std::uint32_t> own(binCount);
      pairs[c].reserve(chunkSize + chunkSize / 2);
      const std::size_t end = std::min((c + 1) * chunkSize, mesh_.tetCount);
      for (std::size_t t = c * chunkSize; t != end; ++t) {
        const TetBox box = voxelBox(mesh_, t);
        if (box.empty() || box.spansNodes())
          countHere(mesh_, t, counts[c]);
        if (box.empty())
          continue;
        checkExtent(mesh_, t, box);
        eachSlab(mesh_, t, box, [&](std::int64_t x, std::int64_t y, std::int64_t z, int slab) {
          const auto bin = static_cast<std::uint32_t>(
              (((x - first_[0]) * size_[1] + (y - first_[1])) * size_[2] + (z - first_[2])) *
                  kKeysPerNode +
              slab);
          ++own[bin];
          pairs[c].push_back({bin, static_cast<std::uint32_t>(t)});
        });
      }
      for (std::size_t i = 0; i < binCount; ++i)
        table[i * chunks + c] = own[i];
    });

    Bins bins;
    for (const OrientationCounts& c : counts)
      bins.counts.add(c);
    std::vector<std::size_t> starts(table.size());
    std::size_t sum = 0;
    for (std::size_t i = 0; i < binCount; ++i) {
      const std::size_t begin = sum;
      for (std::size_t c = 0; c < chunks; ++c) {
        starts[i * chunks + c] = sum;
        sum += table[i * chunks + c];
      }
      if (sum != begin)
        bins.bins.push_back({keyOf(i), begin, sum});
    }
    bins.tets.resize(sum);
    tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t c) {
      progress_.check();
      std::vector<std::size_t> next(binCount);
      for (std::size_t i = 0; i < binCount; ++i)
        next[i] = starts[i * chunks + c];
      for (const Pair& pair : pairs[c])
        bins.tets[next[pair.bin]++] = pair.tet;
      std::vector<Pair>().swap(pairs[c]);
    });
    return bins;
  }

private:
  static constexpr double kMaxBins = 1 << 18;
  static constexpr std::size_t kMinChunk = 65536;
  static constexpr std::size_t kMaxChunks = 64;

  Key keyOf(std::size_t bin) const {
    const auto slab = static_cast<std::int32_t>(bin % kKeysPerNode);
    const auto node = static_cast<std::int64_t>(bin / kKeysPerNode);
    return {static_cast<std::int32_t>(node / (size_[1] * size_[2]) + first_[0]),
            static_cast<std::int32_t>(node / size_[2] % size_[1] + first_[1]),
            static_cast<std::int32_t>(node % size_[2] + first_[2]), slab};
  }

  const SnappedMesh& mesh_;
  Progress& progress_;
  std::int64_t first_[3], size_[3];
};

// Bins by sorting, for sparse meshes in large grids.
Bins sortedBins(const SnappedMesh& mesh, Progress& progress) {
  struct Pair {
    Key key;
    std::uint32_t tet;
    bool operator<(const Pair& o) const { return key == o.key ? tet < o.tet : key < o.key; }
  };
  struct Local {
    std::vector<Pair> pairs;
    OrientationCounts counts;
  };
  tbb::enumerable_thread_specific<Local> locals;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, mesh.tetCount, 4096), [&](const auto& range) {
        progress.check();
        Local& local = locals.local();
        for (std::size_t t = range.begin(); t != range.end(); ++t) {
          const TetBox box = voxelBox(mesh, t);
          if (box.empty() || box.spansNodes())
            countHere(mesh, t, local.counts);
          if (box.empty())
            continue;
          checkExtent(mesh, t, box);
          eachSlab(mesh, t, box, [&](std::int64_t x, std::int64_t y, std::int64_t z, int slab) {
            local.pairs.push_back({{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                                    static_cast<std::int32_t>(z), slab},
                                   static_cast<std::uint32_t>(t)});
          });
        }
      });
  Bins bins;
  std::vector<Pair> all;
  for (Local& local : locals) {
    all.insert(all.end(), local.pairs.begin(), local.pairs.end());
    std::vector<Pair>().swap(local.pairs);
    bins.counts.add(local.counts);
  }
  tbb::parallel_sort(all.begin(), all.end());
  bins.tets.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || !(all[i].key == all[i - 1].key))
      bins.bins.push_back({all[i].key, i, i});
    bins.bins.back().end = i + 1;
    bins.tets[i] = all[i].tet;
  }
  return bins;
}

struct Scratch {
  SlabBits bits;
  std::unique_ptr<std::uint32_t[]> owners;
};

// The slabs of one node.
class NodeTask {
public:
  NodeTask(const SnappedMesh& mesh, const Bins& bins, const Bin* begin, const Bin* end, bool owners)
      : mesh_(mesh), bins_(bins), begin_(begin), end_(end), owners_(owners) {
    if ((end - 1)->key.slab == kWholeNode)
      filling_ = bins.tets[(--end_)->begin];
  }

  NodeIndex index() const { return {begin_->key.x, begin_->key.y, begin_->key.z}; }

  // Whether one tet owns the whole node, or owners are not needed.
  bool full() const {
    return filling_ != kNoTet && (!owners_ || std::all_of(begin_, end_, [&](const Bin& bin) {
             return bins_.tets[bin.begin] > filling_;
           }));
  }
  std::uint32_t filling() const { return filling_; }

  // Rasterizes slab s into `scratch`; false if it is empty.
  bool slab(int s, Scratch& scratch, OrientationCounts& counts) const {
    const Bin* bin = std::find_if(begin_, end_, [&](const Bin& b) { return b.key.slab == s; });
    if (bin == end_ && filling_ == kNoTet)
      return false;
    std::memset(&scratch.bits, 0, sizeof scratch.bits);
    if (bin != end_) {
      const std::uint32_t* tets = bins_.tets.data() + bin->begin;
      const std::size_t count = bin->end - bin->begin;
      if (filling_ == kNoTet) {
        rasterizeRun(s, tets, count, scratch, counts);
      } else {
        // A tet that fills the node leaves no voxels to the tets after it.
        const auto before =
            static_cast<std::size_t>(std::lower_bound(tets, tets + count, filling_) - tets);
        rasterizeRun(s, tets + before, count - before, scratch, counts);
        std::memset(&scratch.bits, 0, sizeof scratch.bits);
        rasterizeRun(s, tets, before, scratch, counts);
      }
    }
    if (filling_ != kNoTet)
      fillRest(scratch);
    std::uint64_t set = 0;
    for (const auto& row : scratch.bits.rows)
      set |= row[0] | row[1];
    return set != 0;
  }

private:
  void rasterizeRun(int s, const std::uint32_t* tets, std::size_t count, Scratch& scratch,
                    OrientationCounts& counts) const {
    const Key& key = begin_->key;
    const SlabOrigin origin{std::int64_t(key.x) * kNodeSize + s * kLeafSize,
                            std::int64_t(key.y) * kNodeSize, std::int64_t(key.z) * kNodeSize};
    if (owners_)
      rasterizeOwners(mesh_, tets, count, origin, scratch.bits, scratch.owners.get(), counts);
    else
      rasterizeTets(mesh_, tets, count, origin, scratch.bits, counts);
  }

  void fillRest(Scratch& scratch) const {
    for (int row = 0; row < kSlabRows; ++row) {
      std::uint64_t* bits = scratch.bits.rows[row];
      if (owners_)
        for (int z = 0; z < kNodeSize; ++z)
          if ((bits[z >> 6] >> (z & 63) & 1) == 0)
            scratch.owners[std::size_t(row) * std::size_t(kNodeSize) + std::size_t(z)] = filling_;
      bits[0] = bits[1] = ~std::uint64_t(0);
    }
  }

  const SnappedMesh& mesh_;
  const Bins& bins_;
  const Bin* begin_;
  const Bin* end_;
  bool owners_;
  std::uint32_t filling_ = kNoTet;
};

} // namespace

struct TetNodes::Parts {
  /// A node, as a range of bins.
  struct Node {
    NodeIndex index;
    std::size_t begin, end, tets;
  };

  Parts(const SnappedMesh& snapped, Progress& progress) : mesh(snapped) {
    CountedBins counted(mesh, progress);
    bins = counted.fits() ? counted.make() : sortedBins(mesh, progress);
    for (std::size_t i = 0; i < bins.bins.size(); ++i) {
      const Bin& bin = bins.bins[i];
      if (i == 0 || !bin.key.sameNode(bins.bins[i - 1].key))
        nodes.push_back({{bin.key.x, bin.key.y, bin.key.z}, i, i, 0});
      nodes.back().end = i + 1;
      nodes.back().tets += bin.end - bin.begin;
    }
  }

  OrientationCounts rasterize(std::vector<const Node*> wanted, bool owners, NodeSink& sink,
                              Progress& progress) const;

  const SnappedMesh& mesh;
  Bins bins;
  std::vector<Node> nodes;
};

TetNodes::TetNodes(const SnappedMesh& mesh, Progress& progress)
    : parts_(std::make_unique<Parts>(mesh, progress)) {}
TetNodes::~TetNodes() = default;

std::size_t TetNodes::size() const {
  return parts_->nodes.size();
}

const NodeIndex& TetNodes::node(std::size_t i) const {
  return parts_->nodes[i].index;
}

std::size_t TetNodes::mostLeaves(std::size_t i) const {
  const Parts::Node& node = parts_->nodes[i];
  std::uint32_t slabs = 0;
  for (std::size_t bin = node.begin; bin != node.end; ++bin)
    slabs |= std::uint32_t(1) << parts_->bins.bins[bin].key.slab;
  return mostLeavesOf(slabs);
}

std::size_t mostLeavesOf(std::uint32_t slabs) {
  constexpr auto inSlab = static_cast<std::size_t>(kSlabsPerNode * kSlabsPerNode);
  return inSlab * static_cast<std::size_t>(
                      (slabs & kWholeNodeBit) != 0 ? kSlabsPerNode : __builtin_popcount(slabs));
}

void eachNodeOf(const SnappedMesh& mesh, std::size_t tet,
                const std::function<void(const NodeIndex&, std::uint32_t)>& visit) {
  const TetBox box = voxelBox(mesh, tet);
  if (box.empty())
    return;
  checkExtent(mesh, tet, box);
  NodeIndex node{};
  std::uint32_t slabs = 0;
  eachSlab(mesh, tet, box, [&](std::int64_t x, std::int64_t y, std::int64_t z, int slab) {
    const NodeIndex next{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                         static_cast<std::int32_t>(z)};
    if (slabs != 0 && next != node) {
      visit(node, slabs);
      slabs = 0;
    }
    node = next;
    slabs |= std::uint32_t(1) << slab;
  });
  if (slabs != 0)
    visit(node, slabs);
}

void TetNodes::rasterize(const NodeBox& box, bool owners, NodeSink& sink,
                         Progress& progress) const {
  std::vector<const Parts::Node*> wanted;
  eachRangeIn(
      box, size(), [&](std::size_t i) { return node(i); },
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          wanted.push_back(&parts_->nodes[i]);
      });
  parts_->rasterize(std::move(wanted), owners, sink, progress);
}

OrientationCounts TetNodes::rasterize(bool owners, NodeSink& sink, Progress& progress) const {
  std::vector<const Parts::Node*> all;
  for (const Parts::Node& node : parts_->nodes)
    all.push_back(&node);
  OrientationCounts counts = parts_->rasterize(std::move(all), owners, sink, progress);
  counts.add(parts_->bins.counts);
  return counts;
}

OrientationCounts TetNodes::Parts::rasterize(std::vector<const Node*> wanted, bool owners,
                                             NodeSink& sink, Progress& progress) const {
  // Those with most tets first.
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const Node* a, const Node* b) { return a->tets > b->tets; });

  std::atomic<std::uint64_t> flipped{0}, dropped{0};
  std::atomic<std::size_t> done{0};
  tbb::enumerable_thread_specific<Scratch> scratches([owners] {
    Scratch scratch;
    if (owners)
      scratch.owners.reset(new std::uint32_t[std::size_t(kSlabRows) * std::size_t(kNodeSize)]);
    return scratch;
  });
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const int grain = wanted.size() < 8 * threads ? 1 : kSlabsPerNode;

  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, wanted.size(), 1),
      [&](const auto& range) {
        for (std::size_t n = range.begin(); n != range.end(); ++n) {
          const NodeTask task(mesh, bins, bins.bins.data() + wanted[n]->begin,
                              bins.bins.data() + wanted[n]->end, owners);
          const bool full = task.full();
          if (full)
            sink.fullNode(task.index(), task.filling());
          // The slabs of a full node are gone through for the counts alone.
          std::unique_ptr<NodeSink::Node> node;
          if (!full)
            node = sink.begin(task.index());
          tbb::parallel_for(
              tbb::blocked_range<int>(0, kSlabsPerNode, static_cast<std::size_t>(grain)),
              [&](const tbb::blocked_range<int>& slabs) {
                Scratch& scratch = scratches.local();
                OrientationCounts counts;
                for (int s = slabs.begin(); s != slabs.end(); ++s)
                  if (task.slab(s, scratch, counts) && !full)
                    sink.slab(*node, s, scratch.bits, scratch.owners.get());
                flipped += counts.flipped;
                dropped += counts.dropped;
              },
              tbb::simple_partitioner());
          if (!full)
            sink.end(std::move(node));
          progress.update(static_cast<double>(++done) / static_cast<double>(wanted.size()));
        }
      },
      tbb::simple_partitioner());
  return {flipped, dropped};
}

OrientationCounts countOrientations(const SnappedMesh& mesh) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.tetCount, 16384), OrientationCounts{},
      [&](const tbb::blocked_range<std::size_t>& range, OrientationCounts counts) {
        for (std::size_t t = range.begin(); t != range.end(); ++t)
          countHere(mesh, t, counts);
        return counts;
      },
      [](OrientationCounts a, const OrientationCounts& b) {
        a.add(b);
        return a;
      });
}

OrientationCounts rasterizeNodes(const SnappedMesh& mesh, bool owners, NodeSink& sink,
                                 Progress& progress) {
  return TetNodes(mesh, progress).rasterize(owners, sink, progress);
}

} // namespace tetvdb
