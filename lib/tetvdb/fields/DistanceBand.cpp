// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/DistanceBand.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/FaceFrame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

// Vectors are passed only to inlined functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

typedef float Floats __attribute__((vector_size(kLeafSize * sizeof(float))));

// Sets the squared distances to their minimum with those to `face`.
TETVDB_INLINE void addFace(const LeafFace& face, float reach, float* squared) {
  const Floats z = {-3.5f, -2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f, 3.5f};
  FaceRow row;
  for (int x = face.x0; x <= face.x1; ++x)
    for (int y = face.y0; y <= face.y1; ++y)
      if (rowOf(face, x, y, reach, row)) {
        Floats* min = reinterpret_cast<Floats*>(squared + (x * kLeafSize + y) * kLeafSize);
        *min = smallerOf(*min, squaredDistance(face, row, z));
      }
}

TETVDB_MULTIVERSION
void addFaces(const LeafFace* faces, std::size_t count, float reach, float* squared) {
  for (std::size_t i = 0; i < count; ++i)
    addFace(faces[i], reach, squared);
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
  tbb::enumerable_thread_specific<std::vector<NodeFace>> locals;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, faces.faces.size(), 4096), [&](const auto& range) {
        progress.check();
        std::vector<NodeFace>& out = locals.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
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
            continue;
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
        }
      });
  pairs_ = joinedVectors<NodeFace>(locals);
  tbb::parallel_sort(pairs_.begin(), pairs_.end());
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (i == 0 || pairs_[i].node != pairs_[i - 1].node) {
      nodes_.push_back(pairs_[i].node);
      starts_.push_back(i);
    }
  starts_.push_back(pairs_.size());
}

void DistanceBand::rasterize(std::size_t node, const LeafSink& sink) const {
  const Vec3d origin = firstVoxelOf(nodes_[node]);
  std::vector<FaceFrame> frames;
  frames.reserve(starts_[node + 1] - starts_[node]);
  for (std::size_t i = starts_[node]; i != starts_[node + 1]; ++i) {
    const BoundaryFace& f = faces_.faces[pairs_[i].face];
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
      std::fill(squared, squared + kVoxelsInLeaf, std::numeric_limits<float>::max());
      std::size_t count = 0;
      for (std::uint32_t k = lists.starts[leaf]; k != lists.starts[leaf + 1]; ++k) {
        seen[count++] = seenFrom(frames[lists.faces[k]], lists.used[i], radius_);
        if (count == kAtOnce || k + 1 == lists.starts[leaf + 1]) {
          addFaces(seen, count, reach, squared);
          count = 0;
        }
      }
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
  const std::vector<NodeFace>& pairs = band.nodeFaces();
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
  double leaves = 64;
  for (const BoundaryFace& f : faces.faces)
    leaves += leavesOf(mesh, f, radius);
  double box = 1;
  for (const double extent : {mesh.boxMax.x - mesh.boxMin.x, mesh.boxMax.y - mesh.boxMin.y,
                              mesh.boxMax.z - mesh.boxMin.z})
    box *= (extent * kVoxelsPerUnit + 2 * radius) / kLeafSize + 2;
  return std::min(leaves, box);
}

} // namespace tetvdb
