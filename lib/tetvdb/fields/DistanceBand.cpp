// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/DistanceBand.h"

#include "tetvdb/core/JoinedVectors.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/fields/FaceFrame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

// Vectors never cross a function that is not inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

constexpr int kLeavesAlong = kNodeSize / kLeafSize;
constexpr int kLeavesInNode = kLeavesAlong * kLeavesAlong * kLeavesAlong;
constexpr int kVoxelsInLeaf = kLeafSize * kLeafSize * kLeafSize;
constexpr double kHalfLeaf = 0.5 * (kLeafSize - 1); // from the middle to the outermost centres
constexpr double kHalfNode = 0.5 * (kNodeSize - 1);
constexpr double kSlack = 1e-6; // more than bounds in doubles can be wrong by

struct VoxelBox {
  std::int64_t low[3], high[3]; // inclusive
};

// Whether the middle of a cube, half a side away from its outermost centres, leaves some of them
// within the radius.
bool mayReach(const FaceFrame& face, const Vec3d& middle, double half, double radius) {
  if (std::abs(face.height(middle)) > radius + face.height.swing(half) + kSlack)
    return false;
  for (const LinearForm& form : face.beyond)
    if (form(middle) > radius + form.swing(half) + kSlack)
      return false;
  return true;
}

typedef float Floats __attribute__((vector_size(kLeafSize * sizeof(float))));

TETVDB_INLINE Floats larger(Floats a, Floats b) {
  return a > b ? a : b;
}
TETVDB_INLINE Floats smaller(Floats a, Floats b) {
  return a < b ? a : b;
}

// A form in single precision, from the middle of a leaf.
struct LeafForm {
  float x, y, z, middle;

  LeafForm() = default;
  LeafForm(const LinearForm& form, const Vec3d& at)
      : x(static_cast<float>(form.slope[0])), y(static_cast<float>(form.slope[1])),
        z(static_cast<float>(form.slope[2])), middle(static_cast<float>(form(at))) {}
  TETVDB_INLINE float row(float dx, float dy) const { return middle + (x * dx + y * dy); }
  TETVDB_INLINE float swingZ() const { return static_cast<float>(kHalfLeaf) * (z < 0 ? -z : z); }
};

// A face as a leaf sees it: everything that matters is within a few voxels of the leaf's middle, so
// single precision is wrong by less than 3e-6 voxels.
struct LeafFace {
  LeafForm height, beyond[3], along[3];
  float past[3];      // along at the edge's end, seen from the middle
  int x0, x1, y0, y1; // rows that the radius reaches, inclusive
};

LeafFace seenFrom(const FaceFrame& face, const int leaf[3], double radius) {
  const Vec3d middle{leaf[0] * kLeafSize + kHalfLeaf, leaf[1] * kLeafSize + kHalfLeaf,
                     leaf[2] * kLeafSize + kHalfLeaf};
  LeafFace seen;
  seen.height = LeafForm(face.height, middle);
  for (std::size_t k = 0; k < 3; ++k) {
    seen.beyond[k] = LeafForm(face.beyond[k], middle);
    seen.along[k] = LeafForm(face.along[k], middle);
    seen.past[k] = static_cast<float>(face.along[k](middle) - face.length[k]);
  }
  const auto first = [&](std::size_t axis) {
    return static_cast<int>(
        std::max(std::ceil(face.low[axis] - radius - leaf[axis] * kLeafSize), 0.0));
  };
  const auto last = [&](std::size_t axis) {
    return static_cast<int>(
        std::min(std::floor(face.high[axis] + radius - leaf[axis] * kLeafSize), kLeafSize - 1.0));
  };
  seen.x0 = first(0);
  seen.x1 = last(0);
  seen.y0 = first(1);
  seen.y1 = last(1);
  return seen;
}

// Takes the least of the squared distances so far and those to `face`.
TETVDB_INLINE void addFace(const LeafFace& face, float radius, float* squared) {
  const Floats z = {-3.5f, -2.5f, -1.5f, -0.5f, 0.5f, 1.5f, 2.5f, 3.5f};
  const Floats zero = z - z;
  for (int x = face.x0; x <= face.x1; ++x)
    for (int y = face.y0; y <= face.y1; ++y) {
      const float dx = static_cast<float>(x) - 3.5f, dy = static_cast<float>(y) - 3.5f;
      const float height = face.height.row(dx, dy);
      if ((height < 0 ? -height : height) > radius + face.height.swingZ())
        continue;
      const float q0 = face.beyond[0].row(dx, dy), q1 = face.beyond[1].row(dx, dy),
                  q2 = face.beyond[2].row(dx, dy);
      if (q0 > radius + face.beyond[0].swingZ() || q1 > radius + face.beyond[1].swingZ() ||
          q2 > radius + face.beyond[2].swingZ())
        continue;
      const auto edge = [&](int k, Floats q) {
        const float u = face.along[k].x * dx + face.along[k].y * dy;
        const Floats uz = u + face.along[k].z * z;
        const Floats e = larger(larger(uz + face.past[k], -(uz + face.along[k].middle)), zero);
        return q * q + e * e;
      };
      const Floats b0 = q0 + face.beyond[0].z * z, b1 = q1 + face.beyond[1].z * z,
                   b2 = q2 + face.beyond[2].z * z;
      const Floats nearest = smaller(smaller(edge(0, b0), edge(1, b1)), edge(2, b2));
      const Floats outside = larger(larger(b0, b1), b2);
      const Floats s = height + face.height.z * z;
      const Floats found = s * s + (outside < zero ? zero : nearest);
      Floats* row = reinterpret_cast<Floats*>(squared + (x * kLeafSize + y) * kLeafSize);
      *row = smaller(*row, found);
    }
}

TETVDB_MULTIVERSION
void addFaces(const LeafFace* faces, std::size_t count, float radius, float* squared) {
  for (std::size_t i = 0; i < count; ++i)
    addFace(faces[i], radius, squared);
}

// The faces of a node, leaf by leaf.
struct LeafLists {
  std::array<std::uint32_t, kLeavesInNode + 1> starts{};
  std::vector<std::uint32_t> faces;
  std::vector<int> used; // leaves with faces
};

// The faces come near to which leaves.
LeafLists listFaces(const std::vector<FaceFrame>& faces, double radius) {
  std::vector<std::pair<std::uint16_t, std::uint32_t>> found;
  for (std::uint32_t i = 0; i < faces.size(); ++i) {
    const FaceFrame& face = faces[i];
    int low[3], high[3];
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = static_cast<int>(std::max(std::ceil(face.low[k] - radius), 0.0)) / kLeafSize;
      high[k] = static_cast<int>(std::min(std::floor(face.high[k] + radius), kNodeSize - 1.0));
      high[k] = high[k] < 0 ? -1 : high[k] / kLeafSize;
    }
    for (int x = low[0]; x <= high[0]; ++x)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int z = low[2]; z <= high[2]; ++z) {
          const Vec3d middle{x * kLeafSize + kHalfLeaf, y * kLeafSize + kHalfLeaf,
                             z * kLeafSize + kHalfLeaf};
          if (mayReach(face, middle, kHalfLeaf, radius))
            found.emplace_back(
                static_cast<std::uint16_t>((x * kLeavesAlong + y) * kLeavesAlong + z), i);
        }
  }
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

Vec3d firstVoxel(const NodeIndex& node) {
  return {static_cast<double>(node[0]) * kNodeSize, static_cast<double>(node[1]) * kNodeSize,
          static_cast<double>(node[2]) * kNodeSize};
}

} // namespace

DistanceBand::DistanceBand(const SnappedMesh& mesh, const Boundary& faces, double radius,
                           Progress& progress)
    : mesh_(mesh), faces_(faces), radius_(radius) {
  tbb::enumerable_thread_specific<std::vector<Pair>> locals;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, faces.faces.size(), 4096), [&](const auto& range) {
        progress.check();
        std::vector<Pair>& out = locals.local();
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
          const FaceFrame frame = faceFrame(a, b, c, firstVoxel(low));
          for (std::int32_t x = low[0]; x <= high[0]; ++x)
            for (std::int32_t y = low[1]; y <= high[1]; ++y)
              for (std::int32_t z = low[2]; z <= high[2]; ++z) {
                const auto middle = [&](std::int32_t node, std::int32_t first) {
                  return (static_cast<double>(node) - first) * kNodeSize + kHalfNode;
                };
                if (mayReach(frame, {middle(x, low[0]), middle(y, low[1]), middle(z, low[2])},
                             kHalfNode, radius))
                  out.push_back({{x, y, z}, face});
              }
        }
      });
  pairs_ = joinedVectors<Pair>(locals);
  tbb::parallel_sort(pairs_.begin(), pairs_.end());
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (i == 0 || pairs_[i].node != pairs_[i - 1].node) {
      nodes_.push_back(pairs_[i].node);
      starts_.push_back(i);
    }
  starts_.push_back(pairs_.size());
}

void DistanceBand::rasterize(std::size_t node, const LeafSink& sink) const {
  const Vec3d origin = firstVoxel(nodes_[node]);
  std::vector<FaceFrame> frames;
  frames.reserve(starts_[node + 1] - starts_[node]);
  for (std::size_t i = starts_[node]; i != starts_[node + 1]; ++i) {
    const BoundaryFace& f = faces_.faces[pairs_[i].face];
    frames.push_back(faceFrame(mesh_.points[f.a], mesh_.points[f.b], mesh_.points[f.c], origin));
  }
  const LeafLists lists = listFaces(frames, radius_);
  const auto reach = static_cast<float>(radius_ + 1e-5);
  const auto leaves = [&](const tbb::blocked_range<std::size_t>& range) {
    alignas(64) float squared[kVoxelsInLeaf];
    constexpr std::size_t kAtOnce = 64;
    LeafFace seen[kAtOnce];
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const auto leaf = static_cast<std::size_t>(lists.used[i]);
      const int position[3] = {lists.used[i] / (kLeavesAlong * kLeavesAlong),
                               lists.used[i] / kLeavesAlong % kLeavesAlong,
                               lists.used[i] % kLeavesAlong};
      std::fill(squared, squared + kVoxelsInLeaf, std::numeric_limits<float>::max());
      std::size_t count = 0;
      for (std::uint32_t k = lists.starts[leaf]; k != lists.starts[leaf + 1]; ++k) {
        seen[count++] = seenFrom(frames[lists.faces[k]], position, radius_);
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

// A body of volume V and projections ax, ay, az onto the coordinate planes meets on average
// (V + 8 (ax + ay + az) + 64 (...)) / 512 cubes of side 8; for a shell the first two terms matter.
double estimateBandLeaves(const SnappedMesh& mesh, const Boundary& faces, double radius) {
  double volume = 0, projections = 0;
  for (const BoundaryFace& f : faces.faces) {
    const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
    const auto side = [](const LatticePoint& p, const LatticePoint& q) {
      return Vec3d{(q.x - p.x) * kVoxelsPerUnit, (q.y - p.y) * kVoxelsPerUnit,
                   (q.z - p.z) * kVoxelsPerUnit};
    };
    const Vec3d normal = cross(side(a, b), side(a, c));
    volume += radius * length(normal);
    projections += (std::abs(normal[0]) + std::abs(normal[1]) + std::abs(normal[2])) / 2;
  }
  double box = 1;
  for (const double extent : {mesh.boxMax.x - mesh.boxMin.x, mesh.boxMax.y - mesh.boxMin.y,
                              mesh.boxMax.z - mesh.boxMin.z})
    box *= (extent * kVoxelsPerUnit + 2 * radius) / kLeafSize + 2;
  return std::min((volume + kLeafSize * projections) / kVoxelsInLeaf + 64, box);
}

} // namespace tetvdb
