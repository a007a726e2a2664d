// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/DistanceBlocks.h"

#include "tetvdb/core/AtomicBounds.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/FaceFrame.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

// Vectors are passed only to inlined functions.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

constexpr std::int32_t kSmallest = 4;  ///< voxels along a block that is evaluated
constexpr std::int32_t kFramed = 32;   ///< along a block for which frames of its faces are made
constexpr std::int32_t kParallel = 16; ///< blocks of more voxels are halved in parallel

// Squared voxels: above the rounding error of a difference of squares up to 1e6, so that all faces
// at equal distance are evaluated, and the minimum does not depend on their order.
constexpr double kSlack = 1e-7;

typedef double Doubles __attribute__((vector_size(kSmallest * sizeof(double))));

constexpr int kBlockVoxels = kSmallest * kSmallest * kSmallest;

TETVDB_INLINE Doubles larger(Doubles a, Doubles b) {
  return a > b ? a : b;
}
TETVDB_INLINE Doubles smaller(Doubles a, Doubles b) {
  return a < b ? a : b;
}

// Values of a form at a block's row of voxels; `start` is that of the first.
TETVDB_INLINE Doubles rowOf(const LinearForm& form, double start) {
  const Doubles steps = {0, 1, 2, 3};
  return start + form.slope[2] * steps;
}
TETVDB_INLINE double startOf(const LinearForm& form, double x, double y, double z) {
  return form.slope[0] * x + form.slope[1] * y + (form.slope[2] * z + form.constant);
}
// Squared distance to an edge: q outside of it, and `along` beyond its end points.
TETVDB_INLINE Doubles edgeSquares(Doubles q, Doubles along, double length) {
  const Doubles zero = {0, 0, 0, 0};
  const Doubles e = larger(larger(along - length, -along), zero);
  return q * q + e * e;
}

// The minimum of the squared distances of a block's voxels, [(x * 4 + y) * 4 + z], to the faces.
// `first`: the block's first voxel relative to the frames.
TETVDB_MULTIVERSION
void leastSquares(const FaceFrame* frames, const std::uint32_t* list, std::size_t count,
                  const double* first, double* min) {
  const Doubles zero = {0, 0, 0, 0};
  Doubles* out = reinterpret_cast<Doubles*>(min);
  for (int i = 0; i < kBlockVoxels / kSmallest; ++i)
    out[i] = zero + std::numeric_limits<double>::max();
  for (std::size_t n = 0; n < count; ++n) {
    const FaceFrame& face = frames[list[n]];
    for (int x = 0; x < kSmallest; ++x)
      for (int y = 0; y < kSmallest; ++y) {
        const double px = first[0] + x, py = first[1] + y, pz = first[2];
        Doubles q[3], squares[3];
        for (std::size_t k = 0; k < 3; ++k) {
          q[k] = rowOf(face.beyond[k], startOf(face.beyond[k], px, py, pz));
          const Doubles along = rowOf(face.along[k], startOf(face.along[k], px, py, pz));
          squares[k] = edgeSquares(q[k], along, face.length[k]);
        }
        const Doubles nearest = smaller(smaller(squares[0], squares[1]), squares[2]);
        const Doubles outside = larger(larger(q[0], q[1]), q[2]);
        const Doubles s = rowOf(face.height, startOf(face.height, px, py, pz));
        const Doubles squared = s * s + (outside < zero ? zero : nearest);
        Doubles& best = out[x * kSmallest + y];
        best = smaller(best, squared);
      }
  }
}

double boxSquare(const Vec3d& p, const Vec3d& low, const Vec3d& high) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double beyond = std::max({low[k] - p[k], p[k] - high[k], 0.0});
    sum += beyond * beyond;
  }
  return sum;
}

} // namespace

struct DistanceBlocks::Block {
  Vec3i first{};
  std::int32_t size = 0;
};

class DistanceBlocks::Run {
public:
  /// `largestAlone`: leaves that cannot have the largest distance are left out, and squares of
  /// their blocks of 4^3 are 0.
  Run(const DistanceBlocks& all, const VoxelBox& box, const LeafSink& sink, bool largestAlone,
      Progress& progress)
      : all_(all), box_(box), sink_(sink), largestAlone_(largestAlone), progress_(progress) {
    for (std::size_t k = 0; k < 3; ++k) {
      nodesLow_[k] = nodeOf(box.low[k]);
      nodes_[k] = static_cast<std::size_t>(nodeOf(box.high[k]) - nodesLow_[k]) + 1;
    }
  }

  void run() {
    const std::size_t count = nodes_[0] * nodes_[1] * nodes_[2];
    std::vector<std::uint32_t> everything(all_.boxes_.size());
    for (std::size_t i = 0; i < everything.size(); ++i)
      everything[i] = static_cast<std::uint32_t>(i);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            Block block;
            const std::size_t at[3] = {i / (nodes_[1] * nodes_[2]), i / nodes_[2] % nodes_[1],
                                       i % nodes_[2]};
            for (std::size_t k = 0; k < 3; ++k)
              block.first[k] = (nodesLow_[k] + static_cast<std::int32_t>(at[k])) * kNodeSize;
            block.size = kNodeSize;
            descend(block, everything, 0);
            progress_.update(static_cast<double>(++done_) / static_cast<double>(count));
          }
        },
        tbb::simple_partitioner());
  }

private:
  // Data shared by the parts of a framed block.
  struct Framed {
    Vec3d origin;
    std::vector<FaceFrame> frames;
    std::vector<std::uint32_t> faces; ///< of the frames
  };

  VoxelBox voxelsOf(const Block& block) const {
    VoxelBox voxels;
    for (std::size_t k = 0; k < 3; ++k) {
      voxels.low[k] = std::max(block.first[k], box_.low[k]);
      voxels.high[k] = std::min(block.first[k] + block.size - 1, box_.high[k]);
    }
    return voxels;
  }

  // The point of a face nearest to p.
  NearestOffset nearest(std::uint32_t face, const Vec3d& p) const {
    const BoundaryFace& f = all_.faces_.faces[face];
    const auto seen = [&](std::uint32_t i) {
      const LatticePoint& q = all_.mesh_.points[i];
      return Vec3d{q.x * kVoxelsPerUnit - p[0], q.y * kVoxelsPerUnit - p[1],
                   q.z * kVoxelsPerUnit - p[2]};
    };
    return nearestOnTriangle(seen(f.a), seen(f.b), seen(f.c));
  }

  // Whether voxels between `low` and `high`, with this distance at their middle, may have the
  // largest of all. The voxel next to the middle is within half of a voxel's diagonal.
  bool allowsLargest(const Vec3d& low, const Vec3d& high, double distance) const {
    constexpr double kHalfDiagonal = 0.8660255, kRounding = 1e-6;
    raiseTo(atLeast_, distance - kHalfDiagonal);
    const double way = length(minus(high, low)) / 2;
    return (distance + way) * (1 + kRounding) >= atLeast_;
  }

  // Selects from `list` the faces that can be nearest to a voxel of the block. `best` is a face
  // close to the block's parent, and is set to the face nearest to its centre. `face(i)`: that of
  // list entry i. None where largestAlone_ and the block cannot have the largest distance.
  template <typename FaceOf>
  std::vector<std::uint32_t> narrowed(const VoxelBox& voxels,
                                      const std::vector<std::uint32_t>& list, const FaceOf& face,
                                      std::uint32_t& best) const {
    Vec3d low, high, midpoint;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = voxels.low[k];
      high[k] = voxels.high[k];
      midpoint[k] = (low[k] + high[k]) / 2;
    }
    NearestOffset min = nearest(best, midpoint);
    for (const std::uint32_t i : list) {
      const std::uint32_t f = face(i);
      const FaceBox& box = all_.boxes_[f];
      if (boxSquare(midpoint, box.low, box.high) >= min.squared)
        continue;
      const NearestOffset other = nearest(f, midpoint);
      if (other.squared < min.squared) {
        min = other;
        best = f;
      }
    }
    if (largestAlone_ && !allowsLargest(low, high, std::sqrt(min.squared)))
      return {};
    const Vec3d p = plus(midpoint, min.offset);
    // The largest difference of squares along one axis, over the box and at one end of the voxels.
    const auto max = [](double v, double at, double boxLow, double boxHigh) {
      const double to = std::max({boxLow - v, v - boxHigh, 0.0});
      return (v - at) * (v - at) - to * to;
    };
    std::vector<std::uint32_t> kept;
    for (const std::uint32_t i : list) {
      const FaceBox& box = all_.boxes_[face(i)];
      double sum = 0;
      for (std::size_t k = 0; k < 3; ++k)
        sum += std::max(max(low[k], p[k], box.low[k], box.high[k]),
                        max(high[k], p[k], box.low[k], box.high[k]));
      if (sum > -kSlack || face(i) == best)
        kept.push_back(i);
    }
    return kept;
  }

  // Calls visit(child, its voxels) for the eighths of a block that meet the box.
  template <typename Visit>
  void forEighths(const Block& block, bool parallel, const Visit& visit) const {
    const auto one = [&](int i) {
      Block child;
      child.size = block.size / 2;
      for (std::size_t k = 0; k < 3; ++k)
        child.first[k] = block.first[k] + (i >> (2 - k) & 1) * child.size;
      if (!voxelsOf(child).empty())
        visit(child);
    };
    if (parallel) {
      tbb::parallel_for(0, 8, one);
      return;
    }
    for (int i = 0; i < 8; ++i)
      one(i);
  }

  void descend(const Block& block, const std::vector<std::uint32_t>& list,
               std::uint32_t best) const {
    progress_.check();
    const auto self = [](std::uint32_t face) { return face; };
    const std::vector<std::uint32_t> kept = narrowed(voxelsOf(block), list, self, best);
    if (kept.empty())
      return;
    if (block.size > kFramed) {
      forEighths(block, true, [&](const Block& child) { descend(child, kept, best); });
      return;
    }
    Framed framed;
    framed.faces = kept;
    framed.origin = {static_cast<double>(block.first[0]), static_cast<double>(block.first[1]),
                     static_cast<double>(block.first[2])};
    framed.frames.reserve(kept.size());
    std::vector<std::uint32_t> places(kept.size());
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const BoundaryFace& f = all_.faces_.faces[kept[i]];
      const auto& points = all_.mesh_.points;
      framed.frames.push_back(faceFrame(points[f.a], points[f.b], points[f.c], framed.origin));
      places[i] = static_cast<std::uint32_t>(i);
    }
    forEighths(block, true,
               [&](const Block& child) { descendFramed(child, framed, places, best); });
  }

  // `list`: indices in framed.faces.
  void descendFramed(const Block& block, const Framed& framed,
                     const std::vector<std::uint32_t>& list, std::uint32_t best) const {
    const auto face = [&](std::uint32_t place) { return framed.faces[place]; };
    const std::vector<std::uint32_t> kept = narrowed(voxelsOf(block), list, face, best);
    if (kept.empty())
      return;
    if (block.size > kLeafSize) {
      forEighths(block, block.size > kParallel,
                 [&](const Block& child) { descendFramed(child, framed, kept, best); });
      return;
    }
    alignas(64) float squared[kVoxelsInLeaf] = {};
    forEighths(block, false, [&](const Block& child) {
      std::uint32_t near = best;
      const auto own = narrowed(voxelsOf(child), kept, face, near);
      if (!own.empty())
        evaluate(block, child, framed, own, squared);
    });
    sink_(block.first, squared);
  }

  void evaluate(const Block& leaf, const Block& block, const Framed& framed,
                const std::vector<std::uint32_t>& list, float* squared) const {
    alignas(64) double min[kBlockVoxels];
    double first[3];
    std::int32_t at[3];
    for (std::size_t k = 0; k < 3; ++k) {
      first[k] = block.first[k] - framed.origin[k];
      at[k] = block.first[k] - leaf.first[k];
    }
    leastSquares(framed.frames.data(), list.data(), list.size(), first, min);
    for (std::int32_t x = 0; x < kSmallest; ++x)
      for (std::int32_t y = 0; y < kSmallest; ++y)
        for (std::int32_t z = 0; z < kSmallest; ++z)
          squared[((at[0] + x) * kLeafSize + at[1] + y) * kLeafSize + at[2] + z] =
              static_cast<float>(min[(x * kSmallest + y) * kSmallest + z]);
  }

  const DistanceBlocks& all_;
  const VoxelBox& box_;
  const LeafSink& sink_;
  bool largestAlone_;
  mutable std::atomic<double> atLeast_{0}; ///< the largest distance is
  Progress& progress_;
  Vec3i nodesLow_{};
  std::size_t nodes_[3] = {};
  std::atomic<std::size_t> done_{0};
};

DistanceBlocks::DistanceBlocks(const SnappedMesh& mesh, const Boundary& faces)
    : mesh_(mesh), faces_(faces), boxes_(faces.faces.size()) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes_.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const BoundaryFace& f = faces.faces[i];
      const LatticePoint &a = mesh.points[f.a], &b = mesh.points[f.b], &c = mesh.points[f.c];
      const auto span = [&](std::size_t k, double LatticePoint::*axis) {
        boxes_[i].low[k] = std::min({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit;
        boxes_[i].high[k] = std::max({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit;
      };
      span(0, &LatticePoint::x);
      span(1, &LatticePoint::y);
      span(2, &LatticePoint::z);
    }
  });
}

void DistanceBlocks::rasterize(const VoxelBox& box, const LeafSink& sink,
                               Progress& progress) const {
  if (!box.empty() && !boxes_.empty())
    Run(*this, box, sink, false, progress).run();
}

float DistanceBlocks::largest(const VoxelBox& box, Progress& progress) const {
  std::atomic<float> largest{0};
  const LeafSink sink = [&](const Vec3i& first, const float* squared) {
    float own = 0;
    for (std::int32_t i = 0; i < kVoxelsInLeaf; ++i) {
      const Vec3i voxel{first[0] + i / (kLeafSize * kLeafSize),
                        first[1] + i / kLeafSize % kLeafSize, first[2] + i % kLeafSize};
      bool isIn = true;
      for (std::size_t k = 0; k < 3; ++k)
        isIn = isIn && voxel[k] >= box.low[k] && voxel[k] <= box.high[k];
      if (isIn)
        own = std::max(own, squared[i]);
    }
    raiseTo(largest, own);
  };
  if (!box.empty() && !boxes_.empty())
    Run(*this, box, sink, true, progress).run();
  return largest;
}

} // namespace tetvdb
