// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/SolidQuery.h"

#include "tetvdb/core/AtomicBounds.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kBoxBits = 38;            // lattice units along the box's longest side, at most
constexpr double kMostLattice = 0x1p39; // coordinates stay below this
constexpr std::size_t kPointsAtOnce = std::size_t(1) << 20, kPointsPerTask = 256;

// World to lattice, centred on the box: the same number for a corner and a point at its position.
struct QueryLattice {
  Vec3d centre{0, 0, 0};
  double scale = 1; ///< units per world unit: a power of two

  explicit QueryLattice(const Box& box) {
    double longest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      centre[axis] = box.low[axis] / 2 + box.high[axis] / 2;
      longest = std::max(longest, box.high[axis] - box.low[axis]);
    }
    if (!std::isfinite(longest))
      throw Error(Status::Limit, "", "the mesh's box is too large for point queries");
    int exponent = 0;
    std::frexp(longest, &exponent); // longest <= 2^exponent
    if (longest > 0)
      scale = std::ldexp(1.0, std::min(kBoxBits - exponent, 1000));
  }

  Vec3d at(const Vec3d& p) const {
    return {std::nearbyint((p[0] - centre[0]) * scale), std::nearbyint((p[1] - centre[1]) * scale),
            std::nearbyint((p[2] - centre[2]) * scale)};
  }
};

LatticePoint pointOf(const Vec3d& p) {
  return {p[0], p[1], p[2]};
}

// The number of the first point that is not finite, or `count`.
std::size_t firstNotFinite(const Vec3d* points, std::size_t count) {
  std::atomic<std::size_t> first{count};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1 << 14), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end() && i < first; ++i) {
      if (std::isfinite(points[i][0]) && std::isfinite(points[i][1]) && std::isfinite(points[i][2]))
        continue;
      lowerTo(first, i);
      return;
    }
  });
  return first;
}

} // namespace

struct SolidQuery::Impl {
  Impl(TriangleMesh given, Progress& progress)
      : mesh(checked(std::move(given))), lattice(boxOf(mesh.points, mesh.triangles)),
        open(soupBoundary(mesh, progress)), winding(faces(), boundary()), scene(mesh) {}

  static TriangleMesh checked(TriangleMesh given) {
    if (given.triangles.empty())
      throw Error(Status::Invalid, "", "the mesh has no faces: nothing is inside");
    checkMesh(given);
    return given;
  }

  LatticePoint corner(std::uint32_t point) const { return pointOf(lattice.at(mesh.points[point])); }

  std::vector<ChainWinding::Face> faces() const {
    std::vector<ChainWinding::Face> all(mesh.triangleCount());
    for (std::size_t t = 0; t < all.size(); ++t)
      all[t] = {corner(mesh.triangles[3 * t]), corner(mesh.triangles[3 * t + 1]),
                corner(mesh.triangles[3 * t + 2]), 1};
    return all;
  }

  std::vector<BoundaryEdge> boundary() const {
    std::vector<BoundaryEdge> edges;
    edges.reserve(open.edges.size());
    for (const IndexedBoundaryEdge& edge : open.edges)
      edges.push_back({corner(edge.a), corner(edge.b), edge.weight});
    return edges;
  }

  // For several consecutive points.
  void insideOf(const Vec3d* points, std::size_t count, std::uint8_t* inside,
                Progress& progress) const {
    std::vector<LatticePoint> near;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d p = lattice.at(points[i]);
      const double far = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
      inside[i] = 0;
      if (!(far < kMostLattice - 1))
        continue;
      near.push_back(pointOf(p));
      which.push_back(i);
    }
    if (near.empty())
      return;
    const std::vector<double> numbers = winding.at(near, progress);
    for (std::size_t i = 0; i < which.size(); ++i)
      inside[which[i]] = numbers[i] > 0.5 ? 1 : 0;
  }

  const TriangleMesh mesh;
  const QueryLattice lattice;
  const SoupBoundary open;
  const ChainWinding winding;
  const TriangleScene scene;
};

SolidQuery::SolidQuery(TriangleMesh mesh, Progress& progress)
    : impl_(std::make_unique<Impl>(std::move(mesh), progress)) {}

SolidQuery::~SolidQuery() = default;

std::size_t SolidQuery::openEdges() const {
  return impl_->open.edges.size();
}

const TriangleMesh& SolidQuery::mesh() const {
  return impl_->mesh;
}

void SolidQuery::at(const Vec3d* points, std::size_t count, std::uint8_t* inside, double* distance,
                    Progress& progress) const {
  if (const std::size_t bad = firstNotFinite(points, count); bad < count)
    throw Error(Status::Invalid, "", "point " + std::to_string(bad) + " is not finite");
  std::vector<std::uint8_t> signs;
  for (std::size_t begin = 0; begin < count; begin += kPointsAtOnce) {
    const std::size_t some = std::min(kPointsAtOnce, count - begin);
    std::uint8_t* side = nullptr;
    if (inside != nullptr) {
      side = inside + begin;
    } else {
      signs.resize(some);
      side = signs.data();
    }
    impl_->insideOf(points + begin, some, side, progress);
    if (distance == nullptr)
      continue;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, some, kPointsPerTask),
                      [&](const auto& range) {
                        progress.check();
                        for (std::size_t i = range.begin(); i != range.end(); ++i) {
                          const double d = impl_->scene.closest(points[begin + i]).distance;
                          distance[begin + i] = side[i] != 0 ? -d : d;
                        }
                      });
  }
}

} // namespace tetvdb
