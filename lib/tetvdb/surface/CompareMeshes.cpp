// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CompareMeshes.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// Points that one task measures. Sums are formed per chunk, then over chunks.
constexpr std::size_t kChunk = 512;

// The first terms of the R2 sequence: powers of the inverse of the root of x^3 = x + 1 (Roberts,
// The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
constexpr double kStepX = 0.7548776662466927, kStepY = 0.5698402909980532;

double fraction(double x) {
  return x - std::floor(x);
}

// The measured points of a mesh: samples of its area, followed by its vertices.
class Sampling {
public:
  Sampling(const TriangleMesh& mesh, std::size_t samples) : mesh_(mesh) {
    double sum = 0;
    areas_.reserve(mesh.triangleCount());
    std::vector<bool> used(mesh.points.size(), false);
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
      const Vec3d& a = mesh.points[mesh.triangles[i]];
      const double twice = length(cross(minus(mesh.points[mesh.triangles[i + 1]], a),
                                        minus(mesh.points[mesh.triangles[i + 2]], a)));
      sum += std::isfinite(twice) ? twice : 0;
      areas_.push_back(sum);
      for (std::size_t k = 0; k < 3; ++k)
        used[mesh.triangles[i + k]] = true;
    }
    for (std::size_t v = 0; v < used.size(); ++v)
      if (used[v])
        vertices_.push_back(static_cast<std::uint32_t>(v));
    samples_ = sum > 0 ? samples : 0;
  }

  std::size_t size() const { return samples_ + vertices_.size(); }
  /// The number of leading points that are averaged.
  std::size_t averaged() const { return samples_ > 0 ? samples_ : vertices_.size(); }

  Vec3d operator[](std::size_t i) const {
    return i < samples_ ? onArea(i) : mesh_.points[vertices_[i - samples_]];
  }

private:
  // Point i lies in the i-th of equal shares of the cumulative area of the faces.
  Vec3d onArea(std::size_t i) const {
    const double at =
        (static_cast<double>(i) + 0.5) / static_cast<double>(samples_) * areas_.back();
    const auto face = static_cast<std::size_t>(
        std::upper_bound(areas_.begin(), areas_.end() - 1, at) - areas_.begin());
    double s = fraction(static_cast<double>(i + 1) * kStepX);
    double t = fraction(static_cast<double>(i + 1) * kStepY);
    if (s + t > 1) {
      s = 1 - s;
      t = 1 - t;
    }
    const Vec3d& a = mesh_.points[mesh_.triangles[3 * face]];
    const Vec3d ab = minus(mesh_.points[mesh_.triangles[3 * face + 1]], a);
    const Vec3d ac = minus(mesh_.points[mesh_.triangles[3 * face + 2]], a);
    return plus(a, plus(times(ab, s), times(ac, t)));
  }

  const TriangleMesh& mesh_;
  std::vector<double> areas_; ///< cumulative, twice the area
  std::vector<std::uint32_t> vertices_;
  std::size_t samples_ = 0;
};

struct Part {
  double sum = 0, squares = 0, largest = -1;
  std::size_t farthest = 0;
};

class Measurement {
public:
  Measurement(const Sampling& points, const TriangleScene& target)
      : points_(points), target_(target), parts_((points.size() + kChunk - 1) / kChunk) {}

  std::size_t chunks() const { return parts_.size(); }

  void measure(std::size_t chunk) {
    Part part;
    Vec3d last{0, 0, 0};
    double reach = std::numeric_limits<double>::infinity();
    for (std::size_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, points_.size()); ++i) {
      const Vec3d p = points_[i];
      // The distance exceeds that of the previous point by no more than the step between them. The
      // limit shortens the search and does not change the result.
      const double limit = (reach + length(minus(p, last))) * (1 + 1e-9);
      TriangleScene::Closest closest =
          target_.closest(p, std::max(limit, std::numeric_limits<double>::min()));
      if (!std::isfinite(closest.distance))
        closest = target_.closest(p);
      reach = closest.distance;
      last = p;
      if (i < points_.averaged()) {
        part.sum += reach;
        part.squares += reach * reach;
      }
      if (reach > part.largest) {
        part.largest = reach;
        part.farthest = i;
      }
    }
    parts_[chunk] = part;
  }

  OneSidedDistance result() const {
    Part all;
    for (const Part& part : parts_) {
      all.sum += part.sum;
      all.squares += part.squares;
      if (part.largest > all.largest) {
        all.largest = part.largest;
        all.farthest = part.farthest;
      }
    }
    const auto count = static_cast<double>(points_.averaged());
    OneSidedDistance distance;
    distance.mean = all.sum / count;
    distance.rms = std::sqrt(all.squares / count);
    distance.largest = all.largest;
    distance.where = points_[all.farthest];
    distance.points = points_.size();
    return distance;
  }

private:
  const Sampling& points_;
  const TriangleScene& target_;
  std::vector<Part> parts_;
};

double diagonalOf(const TriangleMesh& a, const TriangleMesh& b) {
  Vec3d low = a.points[a.triangles[0]], high = low;
  for (const TriangleMesh* mesh : {&a, &b})
    for (const std::uint32_t v : mesh->triangles)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], mesh->points[v][axis]);
        high[axis] = std::max(high[axis], mesh->points[v][axis]);
      }
  return length(minus(high, low));
}

} // namespace

MeshDistance compareMeshes(const TriangleMesh& a, const TriangleMesh& b,
                           const MeshDistanceOptions& options, Progress& progress) {
  for (const TriangleMesh* mesh : {&a, &b})
    if (mesh->triangles.empty())
      throw Error(Status::Invalid, mesh == &a ? "first mesh" : "second mesh",
                  "has no faces to measure from");
  checkMesh(a);
  checkMesh(b);
  const TriangleScene sceneA(a);
  progress.check();
  const TriangleScene sceneB(b);
  const Sampling pointsA(a, options.samples), pointsB(b, options.samples);
  Measurement fromA(pointsA, sceneB), fromB(pointsB, sceneA);
  const std::size_t chunks = fromA.chunks() + fromB.chunks();
  std::atomic<std::size_t> done{0};
  tbb::parallel_for(std::size_t(0), chunks, [&](std::size_t chunk) {
    if (chunk < fromA.chunks())
      fromA.measure(chunk);
    else
      fromB.measure(chunk - fromA.chunks());
    progress.update(static_cast<double>(++done) / static_cast<double>(chunks));
  });
  MeshDistance distance;
  distance.aToB = fromA.result();
  distance.bToA = fromB.result();
  distance.hausdorff = std::max(distance.aToB.largest, distance.bToA.largest);
  distance.diagonal = diagonalOf(a, b);
  return distance;
}

} // namespace tetvdb
