// SPDX-License-Identifier: Apache-2.0
//
// Computes distances to faces in a narrow band around them: (face, node) pairs from the host ->
// (face, leaf) pairs by count, scan and fill -> a team for every 64 faces of a leaf. A distance is
// the minimum of numbers that are not negative, so that order does not matter.
#pragma once

#include "DistanceJob.h"
#include "Team.h"

#include <algorithm>
#include <vector>

namespace tetvdb::nano {

/// A device's share of a DistanceJob, in the backend's memory.
struct PlacedBand {
  const LatticePoint* points = nullptr;
  const u32* faces = nullptr;
  const NodeFace* nodeFaces = nullptr; ///< of the share's nodes
  const u64* starts = nullptr;         ///< likewise, from 0
  double radius = 0;

  TETVDB_HD FaceFrame frame(u64 pair) const {
    const NodeFace& at = nodeFaces[pair];
    const u32* const corners = faces + 4 * u64(at.face);
    return faceFrame(points[corners[0]], points[corners[1]], points[corners[2]],
                     firstVoxelOf(at.node));
  }
};

/// The nodes that one of several devices computes.
struct NodeShare {
  u64 begin = 0, end = 0;
};

/// Divides the job into shares of about the same numbers of faces and leaves.
inline NodeShare shareOfNodes(const DistanceJob& job, int number, int of) {
  constexpr u64 kFacesOfNode = 256; // the cost of a node in addition to its faces
  const auto cut = [&](int k) {
    const u64 all = job.starts[job.nodeCount] + kFacesOfNode * job.nodeCount;
    const u64 part = all / static_cast<u64>(of) * static_cast<u64>(k);
    u64 node = 0;
    while (node < job.nodeCount && job.starts[node] + kFacesOfNode * node < part)
      ++node;
    return node;
  };
  return {cut(number), number + 1 == of ? job.nodeCount : cut(number + 1)};
}

/// Copies a share to the backend: place(host, bytes) returns the address of a copy there.
template <typename Place>
PlacedBand placeBand(const DistanceJob& job, const NodeShare& share, std::vector<u64>& starts,
                     const Place& place) {
  const u64 first = job.starts[share.begin], pairs = job.starts[share.end] - first;
  starts.clear();
  for (u64 node = share.begin; node <= share.end; ++node)
    starts.push_back(job.starts[node] - first);
  PlacedBand band;
  const FacesView& faces = job.faces;
  band.points = static_cast<const LatticePoint*>(
      place(faces.points, faces.pointCount * sizeof(LatticePoint)));
  band.faces = static_cast<const u32*>(place(faces.faces, faces.faceCount * 4 * sizeof(u32)));
  band.nodeFaces =
      static_cast<const NodeFace*>(place(job.nodeFaces + first, pairs * sizeof(NodeFace)));
  band.starts = static_cast<const u64*>(place(starts.data(), starts.size() * sizeof(u64)));
  band.radius = job.radius;
  return band;
}

struct BandShared {
  static constexpr int kThreads = 64, kOccupancy = 24;
  static constexpr int kFaces = 64;
  LeafFace faces[kFaces];
};

template <typename Backend>
class BandLeaves {
public:
  // 16 MB, and at least one node: larger batches are not copied faster, and pinning their memory
  // takes longer.
  static constexpr u64 kBatchLeaves = u64(1) << 13;
  static constexpr u64 kBatchFaces = u64(1) << 28; // of leaves; but for a node's
  static constexpr u64 kChunkNodes = 1024;

  /// `starts`: the host's copy of band.starts.
  BandLeaves(Backend& backend, const PlacedBand& band, const std::vector<u64>& starts)
      : b_(backend), band_(band), starts_(starts) {}

  /// Passes the nodes to `receiver`, batch by batch, numbered from firstNode; the next batch is
  /// computed while the receiver works. Returns the number of leaves.
  u64 run(u64 firstNode, DistanceReceiver& receiver) {
    const u64 nodes = starts_.size() - 1;
    u64 leaves = 0;
    std::size_t number = 0;
    for (u64 begin = 0; begin < nodes; begin += kChunkNodes) {
      list(begin, std::min(begin + kChunkNodes, nodes));
      for (const Cut& cut : cuts_) {
        launch(cut, number % 2);
        if (number > 0)
          hand(firstNode, (number - 1) % 2, receiver);
        ++number;
      }
      leaves += used_.size();
    }
    if (number > 0)
      hand(firstNode, (number - 1) % 2, receiver);
    b_.stage("");
    return leaves;
  }

  /// The leaves of a batch, in the backend's memory.
  struct Batch {
    u64 firstNode, leaves;
    const u32* entries;   ///< by leaf: its node from firstNode on * kLeavesInNode + its position
    const float* squared; ///< by leaf: as DistanceBatch has it
  };

  /// In place of run(): calls take(Batch) for the nodes, batch by batch in their order. What `take`
  /// launches comes before the next batch; it may use temporary memory and not give it back.
  template <typename Take>
  void runHere(const Take& take) {
    const u64 nodes = starts_.size() - 1;
    float* squared = b_.template alloc<float>(kBatchLeaves * kVoxelsInLeaf);
    for (u64 begin = 0; begin < nodes; begin += kChunkNodes) {
      list(begin, std::min(begin + kChunkNodes, nodes));
      for (const Cut& cut : cuts_) {
        const u64 first = bounds_[cut.begin].leaf, leaves = bounds_[cut.end].leaf - first;
        if (leaves == 0)
          continue;
        compute(cut, squared);
        take(Batch{begin, leaves, usedThere_ + first, squared});
      }
    }
  }

  // Public only because of nvcc, as in LevelBuilder.

  // The leaves of nodes begin .. end - 1, a chunk: how many faces each has, and the batches.
  void list(u64 begin, u64 end) {
    b_.stage("faces of leaves");
    b_.dropTemporaries();
    chunk_ = begin;
    const u64 nodes = end - begin, entries = nodes * kLeavesInNode;
    const u64 firstPair = starts_[begin], pairs = starts_[end] - firstPair;
    const PlacedBand band = band_;
    const u64* starts = band.starts + begin;
    count_ = b_.template temp<u32>(entries + 1);
    offset_ = b_.template temp<u64>(entries + 1);
    u32* count = count_;
    u64* offset = offset_;
    b_.zero(count, (entries + 1) * sizeof(u32));
    b_.forEach(
        pairs, TETVDB_KERNEL(u64 i) {
          u32* const node = count + ownerOf(starts, nodes, firstPair + i) * kLeavesInNode;
          forLeavesNear(band.frame(firstPair + i), band.radius,
                        [&](int leaf) { addTo(node + leaf, 1u); });
        });
    b_.scan(count, offset, entries);

    u32* head = b_.template temp<u32>(entries + 1);
    u64* rank = b_.template temp<u64>(entries + 1);
    b_.forEach(
        entries + 1, TETVDB_KERNEL(u64 i) { head[i] = i < entries && count[i] != 0; });
    b_.scan(head, rank, entries);
    const u64 used = b_.read(rank + entries);
    usedThere_ = b_.template temp<u32>(used);
    jobOffset_ = b_.template temp<u64>(used + 1);
    u32* list = usedThere_;
    u32* jobs = b_.template temp<u32>(used + 1);
    b_.forEach(
        entries + 1, TETVDB_KERNEL(u64 i) {
          if (i == entries)
            jobs[used] = 0;
          else if (count[i] != 0) {
            list[rank[i]] = static_cast<u32>(i);
            jobs[rank[i]] = (count[i] + (BandShared::kFaces - 1)) / BandShared::kFaces;
          }
        });
    b_.scan(jobs, jobOffset_, used);
    const u64* jobOffset = jobOffset_;
    Bound* bounds = b_.template temp<Bound>(nodes + 1);
    b_.forEach(
        nodes + 1, TETVDB_KERNEL(u64 n) {
          const u64 leaf = rank[n * kLeavesInNode];
          bounds[n] = {leaf, offset[n * kLeavesInNode], jobOffset[leaf]};
        });
    bounds_.resize(nodes + 1);
    b_.download(bounds_.data(), bounds, nodes + 1);
    used_.resize(used);
    b_.download(used_.data(), usedThere_, used);
    cut(nodes);
  }

  // A batch: computes its leaves' distances and sends them to the host.
  struct Cut {
    u64 begin, end; // nodes of the chunk
  };
  void launch(const Cut& cut, std::size_t half) {
    const Bound from = bounds_[cut.begin], to = bounds_[cut.end];
    const u64 leaves = to.leaf - from.leaf;
    Landing& landing = landings_[half];
    landing.firstNode = chunk_ + cut.begin;
    landing.starts.clear();
    for (u64 n = cut.begin; n <= cut.end; ++n)
      landing.starts.push_back(bounds_[n].leaf - from.leaf);
    landing.leaves.clear();
    for (u64 i = from.leaf; i < to.leaf; ++i)
      landing.leaves.push_back(static_cast<u16>(used_[i] % kLeavesInNode));
    if (leaves == 0)
      return;
    if (landing.out == nullptr)
      landing.out = b_.template alloc<float>(kBatchLeaves * kVoxelsInLeaf);
    compute(cut, landing.out);
    b_.land(static_cast<int>(half), reinterpret_cast<const u8*>(landing.out),
            leaves * kVoxelsInLeaf * sizeof(float));
  }

  void compute(const Cut& cut, float* squared) {
    const Bound from = bounds_[cut.begin], to = bounds_[cut.end];
    b_.stage("distances");
    fillLists(cut);
    // A number above all squares, for leaves that several teams share.
    b_.fill(squared, 0x7F, (to.leaf - from.leaf) * kVoxelsInLeaf * sizeof(float));
    rasterize(from, to, squared);
  }

  // (node, face) pairs of every leaf; their order is not determined and has no influence.
  void fillLists(const Cut& cut) {
    const u64 firstPair = starts_[chunk_ + cut.begin];
    const u64 pairs = starts_[chunk_ + cut.end] - firstPair;
    const u64 nodes = cut.end - cut.begin, firstEntry = cut.begin * kLeavesInNode;
    const u64 before = bounds_[cut.begin].face;
    const PlacedBand band = band_;
    const u64* starts = band.starts + chunk_ + cut.begin;
    u32* count = count_ + firstEntry;
    const u64* offset = offset_ + firstEntry;
    u32* list = list_;
    b_.forEach(
        pairs, TETVDB_KERNEL(u64 i) {
          const u64 node = ownerOf(starts, nodes, firstPair + i) * kLeavesInNode;
          forLeavesNear(band.frame(firstPair + i), band.radius, [&](int leaf) {
            const u64 entry = node + static_cast<u64>(leaf);
            const u32 left = addTo(&count[entry], ~0u); // counts down
            list[offset[entry] - before + left - 1] = static_cast<u32>(i);
          });
        });
    listFrom_ = firstPair;
  }

  struct Bound {
    u64 leaf, face, job; // before a node: of the chunk's used leaves, of their faces, of teams
  };
  void rasterize(const Bound& from, const Bound& to, float* out) {
    const PlacedBand band = band_;
    const u64 leaves = to.leaf - from.leaf, firstPair = listFrom_, before = from.face;
    const u32 *used = usedThere_ + from.leaf, *list = list_;
    const u64 *jobOffset = jobOffset_ + from.leaf, *offset = offset_;
    const u64 firstJob = from.job;
    const auto reach = static_cast<float>(band.radius + kReachSlack);
    b_.template forTeams<BandShared>(
        to.job - from.job, BandShared::kThreads,
        TETVDB_KERNEL(const Team& team, u64 job, BandShared& s) {
          const u64 leaf = ownerOf(jobOffset, leaves, firstJob + job);
          const u32 entry = used[leaf];
          const u64 first = offset[entry] + (firstJob + job - jobOffset[leaf]) * BandShared::kFaces;
          const u64 left = offset[entry + 1] - first;
          const int faces = static_cast<int>(left < BandShared::kFaces ? left : BandShared::kFaces);
          for (int k = team.rank(); k < faces; k += team.size()) {
            const u64 pair = firstPair + list[first - before + static_cast<u64>(k)];
            s.faces[k] =
                seenFrom(band.frame(pair), static_cast<int>(entry % kLeavesInNode), band.radius);
          }
          team.sync();
          const bool alone = jobOffset[leaf + 1] - jobOffset[leaf] == 1;
          for (int r = team.rank(); r < kRowsInLeaf; r += team.size()) {
            const int x = r / kLeafSize, y = r % kLeafSize;
            float min[kLeafSize];
            for (int z = 0; z < kLeafSize; ++z)
              min[z] = 0x1p127f;
            for (int k = 0; k < faces; ++k) {
              const LeafFace& face = s.faces[k];
              FaceRow<float> row;
              if (x < face.x0 || x > face.x1 || y < face.y0 || y > face.y1 ||
                  !rowOf(face, x, y, reach, row))
                continue;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
              for (int z = 0; z < kLeafSize; ++z)
                min[z] =
                    smallerOf(min[z], squaredDistance(face, row, static_cast<float>(z) - 3.5f));
            }
            float* const place = out + (leaf * kRowsInLeaf + static_cast<u64>(r)) * kLeafSize;
            for (int z = 0; z < kLeafSize; ++z) {
              if (alone)
                place[z] = min[z];
              else
                minInto(reinterpret_cast<u32*>(place + z), bitsOf(min[z]));
            }
          }
          team.sync();
        });
  }

  /// The bits of numbers that are not negative have the order of the numbers.

private:
  // A batch that is being copied to the host.
  struct Landing {
    float* out = nullptr;
    u64 firstNode = 0;
    std::vector<u64> starts;
    std::vector<u16> leaves;
  };

  // Into batches of whole nodes that fit; and room for the longest list of faces.
  void cut(u64 nodes) {
    cuts_.clear();
    u64 begin = 0, max = 0;
    const auto close = [&](u64 end) {
      cuts_.push_back({begin, end});
      max = std::max(max, bounds_[end].face - bounds_[begin].face);
      begin = end;
    };
    for (u64 node = 0; node < nodes; ++node)
      if (node > begin && (bounds_[node + 1].leaf - bounds_[begin].leaf > kBatchLeaves ||
                           bounds_[node + 1].face - bounds_[begin].face > kBatchFaces))
        close(node);
    if (nodes > begin)
      close(nodes);
    b_.require(max * sizeof(u32));
    list_ = b_.template temp<u32>(max);
  }

  void hand(u64 firstNode, std::size_t half, DistanceReceiver& receiver) {
    const Landing& landing = landings_[half];
    DistanceBatch batch;
    batch.firstNode = firstNode + landing.firstNode;
    batch.nodeCount = landing.starts.size() - 1;
    batch.starts = landing.starts.data();
    batch.leaves = landing.leaves.data();
    if (!landing.leaves.empty())
      batch.squared = reinterpret_cast<const float*>(b_.landed(static_cast<int>(half)));
    receiver.take(batch);
  }

  Backend& b_;
  PlacedBand band_;
  const std::vector<u64>& starts_;
  // Of the chunk. By entry, a leaf of a node: its faces, and those of all before it.
  u64 chunk_ = 0;
  u32* count_ = nullptr;
  u64* offset_ = nullptr;
  u32* usedThere_ = nullptr; // entries that have faces
  u64* jobOffset_ = nullptr; // teams before each of these
  std::vector<Bound> bounds_;
  std::vector<u32> used_;
  std::vector<Cut> cuts_;
  // Of the batch: its leaves' faces, as pairs from listFrom_ on.
  u32* list_ = nullptr;
  u64 listFrom_ = 0;
  Landing landings_[2];
};

} // namespace tetvdb::nano
