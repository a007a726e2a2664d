// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TriangleScene.h"

#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/Embree.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tuple>

namespace tetvdb {
namespace {

// In the scene's units, in which the mesh's box is -1 to 1: above the error of rounding vertices
// and points in the box to floats.
constexpr double kRounding = 4e-7;
// Above the rounding error of a disc's radius and of squared distances.
constexpr double kDiscRoom = 1 + 1e-5;
constexpr float kSquareRoom = 1 - 4e-6f;
constexpr double kThin = 1e-3; // twice the area over the squared radius

// A disc around a triangle, in its plane, in scene units: excludes most distant triangles with one
// memory access.
struct TriangleDisc {
  float x = 0, y = 0, z = 0, radius = 0;
  float nx = 0, ny = 0, nz = 0;
  float sign = 0; ///< 0: no plane, never beyond

  // Uses the height above the disc's plane and the distance of the foot point beyond its border.
  bool isBeyond(const RTCPointQuery& query) const {
    const float dx = query.x - x, dy = query.y - y, dz = query.z - z;
    const float square = dx * dx + dy * dy + dz * dz;
    const float height = nx * dx + ny * dy + nz * dz;
    const float foot = std::sqrt(std::max(square - height * height, 0.0f));
    return sign > 0 && foot > radius &&
           square * kSquareRoom - 2 * foot * radius + radius * radius > query.radius * query.radius;
  }
};

struct ClosestQuery {
  const TriangleMesh& mesh;
  const TriangleDisc* discs;
  Vec3d point;
  double scale, slack; ///< scene units per world unit; error of the scene
  double bound;        ///< squared, world units: limit of the distance
  std::uint32_t triangle = 0xFFFFFFFFu;
  Vec3d offset{0, 0, 0};
  bool any = false; ///< any triangle within the bound suffices

  NearestOffset offsetTo(std::uint32_t other) const {
    const std::uint32_t* v = mesh.triangles.data() + std::size_t(3) * other;
    return nearestOnTriangle(minus(mesh.points[v[0]], point), minus(mesh.points[v[1]], point),
                             minus(mesh.points[v[2]], point));
  }

  float radius() const {
    const double r = (std::sqrt(bound) * scale + slack) * (1 + 4e-6);
    return std::isfinite(r) && r < 1e30 ? static_cast<float>(r)
                                        : std::numeric_limits<float>::infinity();
  }
};

bool visitClosest(RTCPointQueryFunctionArguments* arguments) {
  auto& query = *static_cast<ClosestQuery*>(arguments->userPtr);
  if (query.discs[arguments->primID].isBeyond(*arguments->query))
    return false;
  const NearestOffset nearest = query.offsetTo(arguments->primID);
  const bool tie = nearest.squared == query.bound && arguments->primID < query.triangle &&
                   query.triangle != 0xFFFFFFFFu;
  if (!(nearest.squared < query.bound) && !tie)
    return false;
  query.bound = nearest.squared;
  query.offset = nearest.offset;
  query.triangle = arguments->primID;
  if (tie)
    return false;
  arguments->query->radius = query.any ? 0 : query.radius();
  return true;
}

struct CrossingQuery {
  RayContext context; // first: Embree returns a pointer to it
  std::vector<std::uint32_t>* triangles;
};

// Records every triangle and continues the ray.
void recordCrossing(const RTCFilterFunctionNArguments* arguments) {
  auto* query = reinterpret_cast<CrossingQuery*>(arguments->context);
  query->triangles->push_back(RTCHitN_primID(arguments->hit, arguments->N, 0));
  arguments->valid[0] = 0;
}

} // namespace

struct TriangleScene::Impl {
  const TriangleMesh& mesh;
  Vec3d low{0, 0, 0}, high{0, 0, 0}, centre{0, 0, 0};
  double scale = 1; ///< scene units per world unit
  std::vector<TriangleDisc> discs;
  RTCScene scene = nullptr;

  explicit Impl(const TriangleMesh& m) : mesh(m) {}
  ~Impl() { rtcReleaseScene(scene); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void fitBox();
  void build();
  void makeDiscs();
  Vec3d toScene(const Vec3d& p) const { return times(minus(p, centre), scale); }
  bool clip(const Vec3d& origin, const Vec3d& direction, double& t0, double& t1) const;
  ClosestQuery queryAt(const Vec3d& p, double maxDistance) const;
  void search(ClosestQuery& query) const;
};

void TriangleScene::Impl::fitBox() {
  if (mesh.triangles.empty())
    return;
  low = high = mesh.points[mesh.triangles[0]];
  for (const std::uint32_t v : mesh.triangles)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], mesh.points[v][axis]);
      high[axis] = std::max(high[axis], mesh.points[v][axis]);
    }
  double half = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    centre[axis] = low[axis] / 2 + high[axis] / 2;
    half = std::max({half, high[axis] - centre[axis], centre[axis] - low[axis]});
  }
  if (half > 0 && std::isfinite(1 / half))
    scale = 1 / half;
}

void TriangleScene::Impl::build() {
  const RTCDevice device = embreeDevice();
  scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | kFilteredRays);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), std::max(mesh.points.size(), std::size_t(1))));
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
      std::max(mesh.triangleCount(), std::size_t(1))));
  if (points != nullptr && indices != nullptr) {
    points[0] = points[1] = points[2] = 0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      const Vec3d p = toScene(mesh.points[i]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        points[3 * i + axis] = static_cast<float>(p[axis]);
    }
    indices[0] = indices[1] = indices[2] = 0;
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
    rtcCommitGeometry(geometry);
    if (!mesh.triangles.empty())
      rtcAttachGeometry(scene, geometry);
  }
  rtcReleaseGeometry(geometry);
  commit(scene);
}

void TriangleScene::Impl::makeDiscs() {
  discs.resize(mesh.triangleCount());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, discs.size()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      const std::uint32_t* v = mesh.triangles.data() + 3 * i;
      const Vec3d a = toScene(mesh.points[v[0]]), b = toScene(mesh.points[v[1]]),
                  c = toScene(mesh.points[v[2]]);
      const Vec3d mean = times(plus(plus(a, b), c), 1.0 / 3);
      const double radius =
          std::max({length(minus(a, mean)), length(minus(b, mean)), length(minus(c, mean))});
      const Vec3d normal = cross(minus(b, a), minus(c, a));
      const double size = length(normal);
      TriangleDisc& disc = discs[i];
      disc.x = static_cast<float>(mean[0]);
      disc.y = static_cast<float>(mean[1]);
      disc.z = static_cast<float>(mean[2]);
      disc.radius = static_cast<float>(radius * kDiscRoom + 2 * kRounding);
      if (!(size > kThin * radius * radius))
        continue; // its plane is not known well
      disc.nx = static_cast<float>(normal[0] / size);
      disc.ny = static_cast<float>(normal[1] / size);
      disc.nz = static_cast<float>(normal[2] / size);
      disc.sign = 1;
    }
  });
}

// Clips the ray to the mesh's box with a margin. With a distant origin, floats would lose
// precision.
bool TriangleScene::Impl::clip(const Vec3d& origin, const Vec3d& direction, double& t0,
                               double& t1) const {
  const double margin = kRounding / scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = low[axis] - margin - origin[axis];
    const double above = high[axis] + margin - origin[axis];
    if (direction[axis] == 0) {
      if (below > 0 || above < 0)
        return false;
      continue;
    }
    const double a = below / direction[axis], b = above / direction[axis];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  return t0 <= t1;
}

TriangleScene::TriangleScene(const TriangleMesh& mesh) : impl_(std::make_unique<Impl>(mesh)) {
  impl_->fitBox();
  impl_->build();
  impl_->makeDiscs();
}

TriangleScene::~TriangleScene() = default;

void TriangleScene::crossings(const Vec3d& origin, const Vec3d& direction, double tMax,
                              std::vector<Hit>& hits) const {
  hits.clear();
  const double speed = length(direction) * impl_->scale; // scene units per unit of t
  double t0 = 0, t1 = tMax;
  if (impl_->mesh.triangles.empty() || !(speed > 0) || !impl_->clip(origin, direction, t0, t1))
    return;
  // Both ends are extended; doubles decide which hits count.
  t0 -= kRounding / speed;
  t1 += kRounding / speed;
  const Vec3d start = impl_->toScene(plus(origin, times(direction, t0)));
  thread_local std::vector<std::uint32_t> found;
  found.clear();
  CrossingQuery query;
  query.triangles = &found;
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(start[0]);
  ray.ray.org_y = static_cast<float>(start[1]);
  ray.ray.org_z = static_cast<float>(start[2]);
  ray.ray.dir_x = static_cast<float>(direction[0] * impl_->scale / speed);
  ray.ray.dir_y = static_cast<float>(direction[1] * impl_->scale / speed);
  ray.ray.dir_z = static_cast<float>(direction[2] * impl_->scale / speed);
  ray.ray.tfar = static_cast<float>((t1 - t0) * speed);
  ray.ray.mask = 0xFFFFFFFFu;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  intersect(impl_->scene, ray, query.context, recordCrossing);

  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  for (const std::uint32_t triangle : found) {
    const std::uint32_t* v = impl_->mesh.triangles.data() + std::size_t(3) * triangle;
    const Vec3d& a = impl_->mesh.points[v[0]];
    const Vec3d normal =
        cross(minus(impl_->mesh.points[v[1]], a), minus(impl_->mesh.points[v[2]], a));
    const double along = dot(normal, direction);
    const double t = dot(normal, minus(a, origin)) / along;
    if (t >= 0 && t <= tMax) // also false if the ray lies in the triangle's plane
      hits.push_back({t, triangle, along > 0});
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    return std::tie(a.t, a.triangle) < std::tie(b.t, b.triangle);
  });
}

void TriangleScene::Impl::search(ClosestQuery& closest) const {
  const Vec3d at = toScene(closest.point);
  RTCPointQuery query{};
  query.x = static_cast<float>(at[0]);
  query.y = static_cast<float>(at[1]);
  query.z = static_cast<float>(at[2]);
  query.radius = closest.radius();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene, &query, &context, visitClosest, &closest);
}

ClosestQuery TriangleScene::Impl::queryAt(const Vec3d& p, double maxDistance) const {
  const Vec3d at = toScene(p);
  const double far = std::max({std::abs(at[0]), std::abs(at[1]), std::abs(at[2]), 1.0});
  return {mesh, discs.data(), p, scale, kRounding * far, maxDistance * maxDistance};
}

TriangleScene::Closest TriangleScene::closest(const Vec3d& p, double maxDistance) const {
  Closest result;
  if (impl_->mesh.triangles.empty() || !(maxDistance > 0))
    return result;
  ClosestQuery query = impl_->queryAt(p, maxDistance);
  impl_->search(query);
  if (query.triangle == 0xFFFFFFFFu)
    return result;
  result.distance = std::sqrt(query.bound);
  result.triangle = query.triangle;
  result.point = plus(p, query.offset);
  return result;
}

bool TriangleScene::isWithin(const Vec3d& p, double distance, std::uint32_t* first) const {
  if (impl_->mesh.triangles.empty() || !(distance > 0))
    return false;
  ClosestQuery query = impl_->queryAt(p, distance);
  if (first != nullptr && query.offsetTo(*first).squared < query.bound)
    return true;
  query.any = true;
  impl_->search(query);
  if (query.triangle == 0xFFFFFFFFu)
    return false;
  if (first != nullptr)
    *first = query.triangle;
  return true;
}

Vec3d TriangleScene::normal(std::uint32_t triangle) const {
  const std::vector<Vec3d>& points = impl_->mesh.points;
  const std::uint32_t* v = &impl_->mesh.triangles[3 * std::size_t(triangle)];
  const Vec3d n = cross(minus(points[v[1]], points[v[0]]), minus(points[v[2]], points[v[0]]));
  const double l = length(n);
  return times(n, l > 0 ? 1 / l : 0);
}

} // namespace tetvdb
