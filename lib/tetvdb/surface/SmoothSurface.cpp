// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SmoothSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FeatureEdges.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/HalfEdgeMesh.h"
#include "tetvdb/surface/SelfIntersections.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kRounds = 20;        ///< of a step inward and a step outward
constexpr double kStepIn = 0.5;    ///< fraction of the distance to the neighbours' mean
constexpr double kStepOut = -0.53; ///< Taubin: 1 / kStepIn + 1 / kStepOut is the pass band, above 0
constexpr double kMinCosine = 0.2; ///< of the angle by which a normal may change
constexpr int kHalvings = 4;       ///< of a vertex's displacement, before it is reset to 0
constexpr int kBisections = 40;
constexpr int kVolumeHalvings = 8;

class Smoothing {
public:
  Smoothing(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress)
      : mesh_(mesh), options_(options), progress_(progress), first_(mesh.points),
        target_(mesh.points), share_(mesh.points.size(), 1.0), isHeld_(mesh.points.size(), 0) {
    if (!addClosedManifold(halfEdges_, mesh.points.size(), mesh.triangles))
      throw Error(Status::Invalid, "", "the surface is not a closed manifold");
    if (options.featureDegrees < 180)
      for (const VertexPair& edge : featureEdges(mesh, options.featureDegrees))
        isHeld_[edge[0]] = isHeld_[edge[1]] = 1;
  }

  SmoothCounts run() {
    for (int round = 0; round < kRounds; ++round) {
      step(kStepIn);
      step(kStepOut);
      progress_.update(0.5 * round / kRounds);
    }
    // Not at every step: the outward step would move away from what the inward step could not
    // reach.
    for (std::size_t v = 0; v < first_.size(); ++v)
      mesh_.points[v] = bounded(v, mesh_.points[v]);
    wanted_ = volumeOf(first_);
    keepVolume();
    backOff();
    // Moving vertices back may change the volume: then reduces all displacements, down to 0.
    for (int halving = 1; !hasVolume(); ++halving) {
      for (double& share : share_)
        share = halving < kVolumeHalvings ? share / 2 : 0;
      place(1);
      backOff();
    }
    return counts();
  }

private:
  Vec3d neighboursMean(std::size_t v) const {
    Vec3d sum{0, 0, 0};
    int count = 0;
    const HalfEdgeMesh::VertexHandle centre(static_cast<int>(v));
    for (auto n = halfEdges_.cvv_begin(centre); n.is_valid(); ++n, ++count)
      sum = plus(sum, mesh_.points[static_cast<std::size_t>(n->idx())]);
    return count > 0 ? times(sum, 1.0 / count) : mesh_.points[v];
  }

  // Limits the displacement of a vertex.
  Vec3d bounded(std::size_t v, const Vec3d& p) const {
    const Vec3d way = minus(p, first_[v]);
    const double far = length(way);
    return far > options_.distance ? plus(first_[v], times(way, options_.distance / far)) : p;
  }

  // Along the normal only: tangential displacement would use up the distance without effect.
  void step(double share) {
    const std::vector<Vec3d> normals = areaNormals();
    std::vector<Vec3d> next = mesh_.points;
    for (std::size_t v = 0; v < next.size(); ++v) {
      const double square = dot(normals[v], normals[v]);
      if (isHeld_[v] != 0 || !(square > 0))
        continue;
      const double along = dot(minus(neighboursMean(v), mesh_.points[v]), normals[v]) / square;
      next[v] = plus(mesh_.points[v], times(normals[v], share * along));
    }
    mesh_.points = std::move(next);
  }

  // For each vertex: a third of the area of its faces, times their normals.
  std::vector<Vec3d> areaNormals() const {
    std::vector<Vec3d> normals(first_.size(), Vec3d{0, 0, 0});
    for (std::size_t face = 0; face < mesh_.triangleCount(); ++face) {
      const Vec3d n = times(normalOf(mesh_.points, face), 1.0 / 6);
      for (std::size_t k = 0; k < 3; ++k) {
        Vec3d& sum = normals[mesh_.triangles[3 * face + k]];
        sum = plus(sum, n);
      }
    }
    return normals;
  }

  double volumeOf(const std::vector<Vec3d>& points) const {
    double sum = 0;
    const Vec3d& origin = first_[mesh_.triangles[0]];
    for (std::size_t i = 0; i < mesh_.triangles.size(); i += 3)
      sum += dot(minus(points[mesh_.triangles[i]], origin),
                 cross(minus(points[mesh_.triangles[i + 1]], origin),
                       minus(points[mesh_.triangles[i + 2]], origin)));
    return sum / 6;
  }

  bool hasVolume() const {
    return !(std::abs(volumeOf(mesh_.points) - wanted_) > options_.volumeShare * std::abs(wanted_));
  }

  void place(double share) {
    for (std::size_t v = 0; v < first_.size(); ++v)
      mesh_.points[v] = plus(first_[v], times(minus(target_[v], first_[v]), share * share_[v]));
  }

  // Restores the volume by an offset of free vertices along the normals, else by smaller
  // displacements.
  void keepVolume() {
    for (int round = 0; round < 3; ++round)
      offset(wanted_ - volumeOf(mesh_.points));
    target_ = mesh_.points;
    if (hasVolume())
      return;
    double low = 0, high = 1;
    for (int i = 0; i < kBisections; ++i) {
      const double midpoint = (low + high) / 2;
      place(midpoint);
      (hasVolume() ? low : high) = midpoint;
    }
    place(low);
    target_ = mesh_.points;
  }

  void offset(double volumeToAdd) {
    const std::vector<Vec3d> normals = areaNormals();
    double area = 0;
    for (std::size_t v = 0; v < normals.size(); ++v)
      if (isHeld_[v] == 0)
        area += length(normals[v]);
    if (!(area > 0))
      return;
    for (std::size_t v = 0; v < normals.size(); ++v)
      if (const double l = length(normals[v]); isHeld_[v] == 0 && l > 0)
        mesh_.points[v] =
            bounded(v, plus(mesh_.points[v], times(normals[v], volumeToAdd / area / l)));
  }

  Vec3d normalOf(const std::vector<Vec3d>& points, std::size_t face) const {
    const std::uint32_t* v = &mesh_.triangles[3 * face];
    return cross(minus(points[v[1]], points[v[0]]), minus(points[v[2]], points[v[0]]));
  }

  // Faces in positions that are not allowed.
  std::vector<std::uint32_t> badFaces() {
    std::vector<std::uint32_t> bad;
    for (std::uint32_t face = 0; face < mesh_.triangleCount(); ++face) {
      const Vec3d before = normalOf(first_, face), now = normalOf(mesh_.points, face);
      if (!(dot(before, now) > kMinCosine * length(before) * length(now)))
        bad.push_back(face);
    }
    if (!bad.empty()) // e.g. collinear faces
      return bad;
    bad = facesThatMeetOthers(mesh_.points, mesh_.triangles, {}, progress_);
    if (!bad.empty() && !knowsFirst_) {
      knowsFirst_ = true;
      metFirst_ = facesThatMeetOthers(first_, mesh_.triangles, {}, progress_);
    }
    std::vector<std::uint32_t> added;
    std::set_difference(bad.begin(), bad.end(), metFirst_.begin(), metFirst_.end(),
                        std::back_inserter(added));
    return added;
  }

  // Halves, then resets the displacement of vertices at bad faces; then also of their neighbours.
  void backOff() {
    for (std::size_t round = 0;; ++round) {
      progress_.update(0.6);
      std::vector<char> touched(first_.size(), 0);
      for (const std::uint32_t face : badFaces())
        for (std::size_t k = 0; k < 3; ++k)
          touched[mesh_.triangles[3 * std::size_t(face) + k]] = 1;
      for (const std::uint32_t v : equalAsFloats(mesh_.points))
        touched[v] = 1;
      for (std::size_t ring = 0; ring < round / kHalvings; ++ring) {
        const std::vector<char> inner = touched;
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
          if (inner[mesh_.triangles[i]] != 0)
            for (std::size_t k = 0; k < 3; ++k)
              touched[mesh_.triangles[i / 3 * 3 + k]] = 1;
      }
      bool isMoving = false;
      for (std::size_t v = 0; v < touched.size(); ++v)
        if (touched[v] != 0 && share_[v] > 0) {
          share_[v] = share_[v] > std::exp2(-kHalvings) ? share_[v] / 2 : 0;
          isMoving = true;
        }
      if (!isMoving)
        return;
      place(1);
    }
  }

  SmoothCounts counts() const {
    SmoothCounts result;
    for (std::size_t v = 0; v < first_.size(); ++v) {
      const double far = length(minus(mesh_.points[v], first_[v]));
      result.moved += far > 0;
      result.held += isHeld_[v] != 0;
      result.backed += share_[v] < 1;
      result.largest = std::max(result.largest, far);
    }
    return result;
  }

  TriangleMesh& mesh_;
  const SmoothOptions& options_;
  Progress& progress_;
  const std::vector<Vec3d> first_; ///< initial positions of the vertices
  std::vector<Vec3d> target_;      ///< their target positions
  std::vector<double> share_;      ///< fraction of the displacement
  std::vector<char> isHeld_;
  double wanted_ = 0;                   ///< volume
  bool knowsFirst_ = false;             ///< metFirst_ is set
  std::vector<std::uint32_t> metFirst_; ///< faces that met others in the input
  HalfEdgeMesh halfEdges_;              ///< topology only
};

} // namespace

SmoothCounts smoothSurface(TriangleMesh& mesh, const SmoothOptions& options, Progress& progress) {
  if (!(options.distance > 0) || !std::isfinite(options.distance))
    throw Error(Status::Usage, "smooth", "needs a distance above zero");
  if (mesh.triangles.empty())
    return {};
  return Smoothing(mesh, options, progress).run();
}

} // namespace tetvdb
