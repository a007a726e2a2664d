// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/DistanceBand.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/FaceFrame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

// Vectors are passed only to inlined functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

typedef float Floats __attribute__((vector_size(kLeafSize * sizeof(float))));

typedef std::int32_t Ints __attribute__((vector_size(kLeafSize * sizeof(std::int32_t))));

// A leaf is looked at in blocks of 2^3 voxels, a vector each, in order [x][y][z], eight blocks at a
// time: two along y, four along z.
constexpr int kBlock = 2, kBlocksAlong = kLeafSize / kBlock, kBlocksAtOnce = 8;
constexpr int kBlocks = kBlocksAlong * kBlocksAlong * kBlocksAlong;
// A block's voxels relative to its centre, and the centres of eight blocks relative to theirs.
constexpr Floats kVoxelX = {-0.5f, -0.5f, -0.5f, -0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
constexpr Floats kVoxelY = {-0.5f, -0.5f, 0.5f, 0.5f, -0.5f, -0.5f, 0.5f, 0.5f};
constexpr Floats kVoxelZ = {-0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0.5f};
constexpr Floats kBlockY = {-1, -1, -1, -1, 1, 1, 1, 1}, kBlockZ = {-3, -1, 1, 3, -3, -1, 1, 3};

TETVDB_INLINE float largestOf(Floats v) {
  v = largerOf(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  v = largerOf(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
  return largerOf(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6))[0];
}

// Bit i is set where v[i], 0 or -1, is not 0.
TETVDB_INLINE unsigned bitsOf(Ints v) {
  v &= Ints{1, 2, 4, 8, 16, 32, 64, 128};
  v |= __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
  v |= __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5);
  return static_cast<unsigned>(v[0] | v[1]);
}

/// Squared distances of a leaf's voxels. The voxels of a block lie closer together than those of a
/// row, so that fewer faces are near enough to lower the distance of one of them.
class BlockDistances {
public:
  explicit BlockDistances(float reach) : slack_(2e-5f + 2e-6f * reach) {
    std::fill(squared_, squared_ + kVoxelsInLeaf, std::numeric_limits<float>::max());
    std::fill(largest_, largest_ + kBlocks, reach * reach);
  }

  /// Sets the squared distances to their minimum with those to `face`; only in blocks where a lower
  /// bound permits a distance that is smaller than one there and within reach.
  TETVDB_INLINE void add(const LeafFace& face) {
    constexpr int kAtOnceAlong = kBlocksAlong * kBlocksAlong / kBlocksAtOnce;
    for (int i = face.x0 / kBlock * kAtOnceAlong; i < (face.x1 / kBlock + 1) * kAtOnceAlong; ++i) {
      const int first = i / kAtOnceAlong * kBlock;
      const Floats x = Floats{} + (static_cast<float>(first) - 3);
      const Floats y = kBlockY + static_cast<float>(i % kAtOnceAlong * 4 - 2);
      const unsigned lower = bitsOf(lowerBound(face, x, y) <= *vectorAt(largest_, i));
      changed_ |= static_cast<std::uint64_t>(lower) << i * kBlocksAtOnce;
      for (int half = 0; half < kBlocksAtOnce; half += kBlocksAlong) {
        unsigned blocks = lower >> half & ((1u << kBlocksAlong) - 1);
        if (blocks == 0)
          continue;
        const FaceRow<Floats> row = rowAt(face, x + kVoxelX, y[half] + kVoxelY);
        for (; blocks != 0; blocks &= blocks - 1) {
          const int block = half + __builtin_ctz(blocks);
          Floats* min = vectorAt(squared_, i * kBlocksAtOnce + block);
          *min = smallerOf(*min, squaredDistance(face, row, kBlockZ[block] + kVoxelZ));
        }
      }
    }
  }

  /// Makes lower bounds exclude what the distances so far do.
  TETVDB_INLINE void tighten() {
    for (; changed_ != 0; changed_ &= changed_ - 1) {
      const int block = __builtin_ctzll(changed_);
      largest_[block] = smallerOf(largest_[block], largestOf(*vectorAt(squared_, block)));
    }
  }

  /// In the order of a leaf's voxels.
  void copyTo(float* leaf) const {
    for (int x = 0; x < kLeafSize; ++x)
      for (int y = 0; y < kLeafSize; ++y)
        for (int z = 0; z < kLeafSize; ++z) {
          const int block = (x / kBlock * kBlocksAlong + y / kBlock) * kBlocksAlong + z / kBlock;
          const int voxel = (x % kBlock * kBlock + y % kBlock) * kBlock + z % kBlock;
          *leaf++ = squared_[block * kLeafSize + voxel];
        }
  }

private:
  static Floats* vectorAt(float* values, int i) { return reinterpret_cast<Floats*>(values) + i; }

  // Of the squared distances in eight blocks with these centres.
  TETVDB_INLINE Floats lowerBound(const LeafFace& face, Floats x, Floats y) const {
    const auto at = [&](const LeafForm& form) { return form.row(x, y) + form.z * kBlockZ; };
    // From the centre of a block to its outermost voxel centres, and the errors of both sides.
    const auto swing = [&](const LeafForm& form) {
      return 0.5f * (std::abs(form.x) + std::abs(form.y) + std::abs(form.z)) + slack_;
    };
    Floats outside{};
    for (const LeafForm& beyond : face.beyond)
      outside = largerOf(outside, at(beyond) - swing(beyond));
    const Floats height = at(face.height);
    const Floats above = largerOf(largerOf(height, -height) - swing(face.height), Floats{});
    return above * above + outside * outside;
  }

  alignas(64) float squared_[kVoxelsInLeaf]; // by block
  alignas(64) float largest_[kBlocks];       // of each block, at most the square of the reach
  std::uint64_t changed_ = 0;                // blocks that largest_ does not know yet
  float slack_; // above the errors of a few roundings of lengths up to the reach and a leaf's size
};

TETVDB_MULTIVERSION
void addFaces(const LeafFace* faces, std::size_t count, BlockDistances& leaf) {
  constexpr std::size_t kFacesAtOnce = 16; // for less, tightening costs more than it excludes
  for (std::size_t i = 0; i < count; ++i) {
    leaf.add(faces[i]);
    if (i % kFacesAtOnce == kFacesAtOnce - 1)
      leaf.tighten();
  }
}

// The faces of a node, leaf by leaf.
struct LeafLists {
  std::array<std::uint32_t, kLeavesInNode + 1> starts{};
  std::vector<std::uint32_t> faces;
  std::vector<int> used; // leaves with faces
};

// Finds the leaves within reach of each face.
LeafLists listFaces(const std::vector<FaceFrame>& faces, double radius) {
  std::vector<std::pair<std::uint16_t, std::uint32_t>> found;
  for (std::uint32_t i = 0; i < faces.size(); ++i)
    forLeavesNear(faces[i], radius,
                  [&](int leaf) { found.emplace_back(static_cast<std::uint16_t>(leaf), i); });
  LeafLists lists;
  for (const auto& [leaf, face] : found)
    ++lists.starts[leaf + 1u];
  for (int leaf = 0; leaf < kLeavesInNode; ++leaf) {
    const auto l = static_cast<std::size_t>(leaf);
    if (lists.starts[l + 1] != 0)
      lists.used.push_back(leaf);
    lists.starts[l + 1] += lists.starts[l];
  }
  lists.faces.resize(found.size());
  auto next = lists.starts;
  for (const auto& [leaf, face] : found)
    lists.faces[next[leaf]++] = face;
  return lists;
}

} // namespace

DistanceBand::DistanceBand(const SnappedMesh& mesh, const Boundary& faces, double radius,
                           Progress& progress)
    : mesh_(mesh), faces_(faces), radius_(radius) {
  const auto addNodes = [&](std::size_t i, std::vector<NodeFace>& out) {
    const BoundaryFace& f = faces.faces[i];
    const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
    NodeIndex low, high;
    const auto span = [&](std::size_t k, double LatticePoint::*axis) {
      low[k] = nodeOf(static_cast<std::int64_t>(
          std::ceil(std::min({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit - radius)));
      high[k] = nodeOf(static_cast<std::int64_t>(
          std::floor(std::max({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit + radius)));
    };
    span(0, &LatticePoint::x);
    span(1, &LatticePoint::y);
    span(2, &LatticePoint::z);
    const auto face = static_cast<std::uint32_t>(i);
    if (low == high) {
      out.push_back({low, face});
      return;
    }
    const FaceFrame frame = faceFrame(a, b, c, firstVoxelOf(low));
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
      for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t z = low[2]; z <= high[2]; ++z) {
          const auto midpoint = [&](std::int32_t node, std::int32_t first) {
            return (static_cast<double>(node) - first) * kNodeSize + kHalfNode;
          };
          if (mayReach(frame, {midpoint(x, low[0]), midpoint(y, low[1]), midpoint(z, low[2])},
                       kHalfNode, radius))
            out.push_back({{x, y, z}, face});
        }
  };
  pairs_ = groupItems<NodeFace>(faces.faces.size(), 4096, addNodes, progress);
  for (std::size_t i = 0; i < pairs_.groupCount(); ++i)
    nodes_.push_back(pairs_.firstOf(i).node);
}

void DistanceBand::rasterize(std::size_t node, const LeafSink& sink) const {
  const Vec3d origin = firstVoxelOf(nodes_[node]);
  std::vector<FaceFrame> frames;
  frames.reserve(starts()[node + 1] - starts()[node]);
  for (std::size_t i = starts()[node]; i != starts()[node + 1]; ++i) {
    const BoundaryFace& f = faces_.faces[nodeFaces()[i].face];
    frames.push_back(faceFrame(mesh_.points[f.a], mesh_.points[f.b], mesh_.points[f.c], origin));
  }
  const LeafLists lists = listFaces(frames, radius_);
  const auto reach = static_cast<float>(radius_ + kReachSlack);
  const auto leaves = [&](const tbb::blocked_range<std::size_t>& range) {
    alignas(64) float squared[kVoxelsInLeaf];
    constexpr std::size_t kAtOnce = 64;
    LeafFace seen[kAtOnce];
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto leaf = static_cast<std::size_t>(lists.used[i]);
      BlockDistances blocks(reach);
      std::size_t count = 0;
      for (std::uint32_t k = lists.starts[leaf]; k != lists.starts[leaf + 1]; ++k) {
        seen[count++] = seenFrom(frames[lists.faces[k]], lists.used[i], radius_);
        if (count == kAtOnce || k + 1 == lists.starts[leaf + 1]) {
          addFaces(seen, count, blocks);
          count = 0;
        }
      }
      blocks.copyTo(squared);
      sink(lists.used[i], squared);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lists.used.size(), 64), leaves);
}

namespace {

// A body of volume V and projections ax, ay, az onto the coordinate planes meets on average (V + 8
// (ax + ay + az) + 64 (...)) / 512 cubes of side 8; for a shell the first two terms are relevant.
double leavesOf(const SnappedMesh& mesh, const BoundaryFace& f, double radius) {
  const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
  const auto side = [](const LatticePoint& p, const LatticePoint& q) {
    return Vec3d{(q.x - p.x) * kVoxelsPerUnit, (q.y - p.y) * kVoxelsPerUnit,
                 (q.z - p.z) * kVoxelsPerUnit};
  };
  const Vec3d normal = cross(side(a, b), side(a, c));
  const double projections = std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2]);
  return (radius * length(normal) + kLeafSize * projections / 2) / kVoxelsInLeaf;
}

} // namespace

std::vector<float> estimateNodeLeaves(const DistanceBand& band) {
  const LargeVector<NodeFace>& pairs = band.nodeFaces();
  std::vector<std::uint32_t> nodesOf(band.faces().faces.size());
  for (const NodeFace& pair : pairs)
    ++nodesOf[pair.face];
  std::vector<float> leaves(band.nodes().size());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    double sum = 1;
    for (std::uint64_t p = band.starts()[i]; p != band.starts()[i + 1]; ++p)
      sum += leavesOf(band.mesh(), band.faces().faces[pairs[p].face], band.radius()) /
             nodesOf[pairs[p].face];
    leaves[i] = static_cast<float>(std::min(sum, static_cast<double>(kLeavesInNode)));
  });
  return leaves;
}

double estimateBandLeaves(const SnappedMesh& mesh, const Boundary& faces, double radius) {
  const double leaves = 64 + sumOver(faces.faces.size(), [&](std::size_t i) {
                          return leavesOf(mesh, faces.faces[i], radius);
                        });
  double box = 1;
  for (const double extent : {mesh.boxMax.x - mesh.boxMin.x, mesh.boxMax.y - mesh.boxMin.y,
                              mesh.boxMax.z - mesh.boxMin.z})
    box *= (extent * kVoxelsPerUnit + 2 * radius) / kLeafSize + 2;
  return std::min(leaves, box);
}

} // namespace tetvdb
