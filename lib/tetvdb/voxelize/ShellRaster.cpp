// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/ShellRaster.h"

#include "tetvdb/core/GroupItems.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

// Heights along a column; empty where low > high.
struct Heights {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void join(const Heights& h) {
    if (h.low > h.high)
      return;
    low = std::min(low, h.low);
    high = std::max(high, h.high);
  }
  // Keeps the heights z with c + s z >= 0.
  void clip(double c, double s) {
    if (s > 0)
      low = std::max(low, -c / s);
    else if (s < 0)
      high = std::min(high, -c / s);
    else if (c < 0)
      low = std::numeric_limits<double>::infinity();
  }
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// All points within `radius` of a triangle: a prism on either side of it, a cylinder around every
// edge, a ball around every corner. That body is convex, so that a column meets it in one interval,
// from the lowest to the highest point that the column shares with any of these bodies.
class GrownTriangle {
public:
  // World units, relative to a.
  GrownTriangle(const Vec3d& ab, const Vec3d& ac, double radius)
      : corners_{{{0, 0, 0}, ab, ac}}, radius_(radius) {
    normal_ = cross(ab, ac);
    const double area = std::sqrt(dot(normal_, normal_));
    flat_ = !(area > 0);
    for (double& c : normal_)
      c /= flat_ ? 1 : area;
  }

  Heights column(double x, double y) const {
    Heights all;
    for (std::size_t i = 0; i < 3; ++i) {
      all.join(ball(corners_[i], x, y));
      all.join(cylinder(corners_[i], corners_[(i + 1) % 3], x, y));
    }
    if (!flat_)
      all.join(prism(x, y));
    return all;
  }

private:
  Heights ball(const Vec3d& c, double x, double y) const {
    const double square = radius_ * radius_ - (x - c[0]) * (x - c[0]) - (y - c[1]) * (y - c[1]);
    if (square < 0)
      return {};
    const double half = std::sqrt(square);
    return {c[2] - half, c[2] + half};
  }

  Heights cylinder(const Vec3d& a, const Vec3d& b, double x, double y) const {
    Vec3d u = minus(b, a);
    const double length = std::sqrt(dot(u, u));
    if (!(length > 0))
      return {};
    for (double& c : u)
      c /= length;
    // Along the column, w = w0 + z (0, 0, 1) from a; |w|^2 - (w . u)^2 <= radius^2.
    const Vec3d w0{x - a[0], y - a[1], -a[2]};
    const double along = dot(w0, u);
    const double qa = 1 - u[2] * u[2];
    const double qb = w0[2] - along * u[2];
    const double qc = dot(w0, w0) - along * along - radius_ * radius_;
    Heights heights{-kInfinity, kInfinity};
    if (qa > 1e-12) {
      const double root = qb * qb - qa * qc;
      if (root < 0)
        return {};
      const double half = std::sqrt(root);
      heights = {(-qb - half) / qa, (-qb + half) / qa};
    } else if (qc > 0) {
      return {};
    }
    heights.clip(along, u[2]);
    heights.clip(length - along, -u[2]);
    return heights;
  }

  Heights prism(double x, double y) const {
    const Vec3d w{x, y, 0};
    const double height = dot(normal_, w);
    Heights heights{-kInfinity, kInfinity};
    heights.clip(radius_ - height, -normal_[2]);
    heights.clip(radius_ + height, normal_[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3d inward = cross(normal_, minus(corners_[(i + 1) % 3], corners_[i]));
      heights.clip(dot(inward, minus(w, corners_[i])), inward[2]);
    }
    return heights;
  }

  std::array<Vec3d, 3> corners_;
  Vec3d normal_{0, 0, 0};
  double radius_;
  bool flat_ = false;
};

struct VoxelRange {
  std::int64_t min[3], max[3];
};

// Places a face's grown triangle among the voxels.
class Shell {
public:
  Shell(const SnappedMesh& mesh, const Boundary& faces, const Vec3d& voxelSize, double radius)
      : mesh_(mesh), faces_(faces), voxelSize_(voxelSize), radius_(radius) {}

  VoxelRange range(std::size_t face) const {
    const BoundaryFace& f = faces_.faces[face];
    const LatticePoint &a = mesh_.points[f.a], &b = mesh_.points[f.b], &c = mesh_.points[f.c];
    VoxelRange range{};
    const auto along = [&](int k, double LatticePoint::*axis) {
      const double grow = radius_ / voxelSize_[static_cast<std::size_t>(k)];
      range.min[k] = static_cast<std::int64_t>(
          std::ceil(std::min({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit - grow));
      range.max[k] = static_cast<std::int64_t>(
          std::floor(std::max({a.*axis, b.*axis, c.*axis}) * kVoxelsPerUnit + grow));
    };
    along(0, &LatticePoint::x);
    along(1, &LatticePoint::y);
    along(2, &LatticePoint::z);
    return range;
  }

  GrownTriangle grown(std::size_t face) const {
    const BoundaryFace& f = faces_.faces[face];
    const LatticePoint& a = mesh_.points[f.a];
    return {world(a, mesh_.points[f.b]), world(a, mesh_.points[f.c]), radius_};
  }

  // Whether the plane of the face passes near the node's voxels; true for faces without a plane.
  bool nearNode(std::size_t face, const NodeIndex& node) const {
    const BoundaryFace& f = faces_.faces[face];
    const LatticePoint& a = mesh_.points[f.a];
    const Vec3d n = cross(world(a, mesh_.points[f.b]), world(a, mesh_.points[f.c]));
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0))
      return true;
    const double half = 0.5 * (kNodeSize - 1) * static_cast<double>(kUnitsPerVoxel);
    const auto midpoint = [&](std::size_t k) {
      return static_cast<double>(node[k]) * kNodeSize * static_cast<double>(kUnitsPerVoxel) + half;
    };
    const Vec3d centre = world(a, {midpoint(0), midpoint(1), midpoint(2)});
    double reach = radius_ * length * (1 + 1e-9);
    for (std::size_t k = 0; k < 3; ++k)
      reach += std::abs(n[k]) * half * kVoxelsPerUnit * voxelSize_[k];
    return std::abs(dot(n, centre)) <= reach;
  }

  // Adds the face's voxels to the slab whose first voxel is (x0, y0, z0).
  void rasterize(std::size_t face, std::int64_t x0, std::int64_t y0, std::int64_t z0,
                 SlabBits& bits) const {
    const VoxelRange box = range(face);
    const GrownTriangle body = grown(face);
    const LatticePoint& a = mesh_.points[faces_.faces[face].a];
    const auto offset = [&](std::int64_t voxel, double corner, double size) {
      return (static_cast<double>(voxel) - corner * kVoxelsPerUnit) * size;
    };
    const double bottom = a.z * kVoxelsPerUnit;
    for (std::int64_t x = std::max(box.min[0], x0); x <= std::min(box.max[0], x0 + kLeafSize - 1);
         ++x)
      for (std::int64_t y = std::max(box.min[1], y0); y <= std::min(box.max[1], y0 + kNodeSize - 1);
           ++y) {
        const Heights h = body.column(offset(x, a.x, voxelSize_[0]), offset(y, a.y, voxelSize_[1]));
        if (h.low > h.high)
          continue;
        const double base = bottom - static_cast<double>(z0);
        const double low = std::clamp(std::ceil(h.low / voxelSize_[2] + base), 0.0, 128.0);
        const double high = std::clamp(std::floor(h.high / voxelSize_[2] + base), -1.0, 127.0);
        setRun(bits.rows[(x - x0) * kNodeSize + (y - y0)], static_cast<int>(low),
               static_cast<int>(high) + 1);
      }
  }

private:
  // From a to p, world units.
  Vec3d world(const LatticePoint& a, const LatticePoint& p) const {
    return {(p.x - a.x) * kVoxelsPerUnit * voxelSize_[0],
            (p.y - a.y) * kVoxelsPerUnit * voxelSize_[1],
            (p.z - a.z) * kVoxelsPerUnit * voxelSize_[2]};
  }

  const SnappedMesh& mesh_;
  const Boundary& faces_;
  const Vec3d voxelSize_;
  const double radius_;
};

GroupedItems<NodeFace> facesByNode(const Shell& shell, std::size_t count, Progress& progress) {
  const auto addNodes = [&](std::size_t i, std::vector<NodeFace>& out) {
    const VoxelRange box = shell.range(i);
    NodeIndex node;
    for (node[0] = nodeOf(box.min[0]); node[0] <= nodeOf(box.max[0]); ++node[0])
      for (node[1] = nodeOf(box.min[1]); node[1] <= nodeOf(box.max[1]); ++node[1])
        for (node[2] = nodeOf(box.min[2]); node[2] <= nodeOf(box.max[2]); ++node[2])
          if (shell.nearNode(i, node))
            out.push_back({node, static_cast<std::uint32_t>(i)});
  };
  return groupItems<NodeFace>(count, 1024, addNodes, progress);
}

bool anyBit(const SlabBits& bits) {
  std::uint64_t any = 0;
  for (const auto& row : bits.rows)
    any |= row[0] | row[1];
  return any != 0;
}

} // namespace

std::uint64_t estimateShellLeaves(const SnappedMesh& mesh, const Boundary& faces,
                                  const Vec3d& voxelSize, double radius) {
  const Shell shell(mesh, faces, voxelSize, radius);
  double leaves = 0;
  for (std::size_t i = 0; i < faces.faces.size(); ++i) {
    // The two sides of the grown triangle, and its edges.
    const VoxelRange box = shell.range(i);
    double side[3];
    for (int k = 0; k < 3; ++k)
      side[k] = static_cast<double>(box.max[k] - box.min[k] + 1);
    leaves += (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]) / 64;
  }
  return static_cast<std::uint64_t>(leaves) + 64;
}

void rasterizeShell(const SnappedMesh& mesh, const Boundary& faces, const Vec3d& voxelSize,
                    double radius, NodeSink& sink, Progress& progress) {
  const Shell shell(mesh, faces, voxelSize, radius);
  const GroupedItems<NodeFace> pairs = facesByNode(shell, faces.faces.size(), progress);
  const std::vector<std::size_t>& starts = pairs.starts;
  tbb::enumerable_thread_specific<SlabBits> scratch;
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, pairs.groupCount(), 1),
      [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const NodeIndex& index = pairs.firstOf(i).node;
          std::unique_ptr<NodeSink::Node> node = sink.begin(index);
          const std::int64_t x0 = std::int64_t(index[0]) * kNodeSize,
                             y0 = std::int64_t(index[1]) * kNodeSize,
                             z0 = std::int64_t(index[2]) * kNodeSize;
          SlabBits& bits = scratch.local();
          for (int s = 0; s < kSlabsPerNode; ++s) {
            std::memset(&bits, 0, sizeof bits);
            for (std::size_t p = starts[i]; p != starts[i + 1]; ++p)
              shell.rasterize(pairs.items[p].face, x0 + s * kLeafSize, y0, z0, bits);
            if (anyBit(bits))
              sink.slab(*node, s, bits, nullptr);
          }
          sink.end(std::move(node));
          progress.update(static_cast<double>(++done) / static_cast<double>(starts.size()));
        }
      },
      tbb::simple_partitioner());
}

} // namespace tetvdb
