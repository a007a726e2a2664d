// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/TriangleDrawable.h"

#include "tetvdb/core/DiscardPages.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/Embree.h"
#include "tetvdb/visualize/CornerNormals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

// In the scene's own units, where the mesh's box reaches from -1 to 1: more than rounding to floats
// moves a point.
constexpr double kRounding = 4e-7;
// How far off the surface secondary rays start, in the same units.
constexpr double kSkin = 4e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Faces from which the search tree is a compact one: 60 bytes a face less, and rays take half as
// long again (docs/benchmarks.md).
constexpr std::size_t kCompactFrom = 500000;
// Points that are turned to floats before their doubles are given back.
constexpr std::size_t kPointsAtOnce = 1 << 17;
// The share of the surface's light that a line on it has.
constexpr float kWireShade = 0.08F;

using Float3 = std::array<float, 3>;

Vec3d toDouble(const float* v) {
  return {v[0], v[1], v[2]};
}

// All faces that a ray meets.
struct Crossings {
  RayContext context; // first, since Embree hands back a pointer to it
  int faces = 0, balance = 0;

  // Refuses every hit, so that the ray goes on.
  static void count(const RTCFilterFunctionNArguments* arguments) {
    auto* crossings = reinterpret_cast<Crossings*>(arguments->context);
    RTCRayN* ray = arguments->ray;
    RTCHitN* hit = arguments->hit;
    for (unsigned i = 0; i < arguments->N; ++i) {
      if (arguments->valid[i] == 0)
        continue;
      arguments->valid[i] = 0;
      const unsigned n = arguments->N;
      const float slope = RTCHitN_Ng_x(hit, n, i) * RTCRayN_dir_x(ray, n, i) +
                          RTCHitN_Ng_y(hit, n, i) * RTCRayN_dir_y(ray, n, i) +
                          RTCHitN_Ng_z(hit, n, i) * RTCRayN_dir_z(ray, n, i);
      ++crossings->faces;
      crossings->balance += slope > 0 ? 1 : -1;
    }
  }
};

} // namespace

struct TriangleDrawable::Impl {
  TriangleLook look;
  Box box;
  Vec3d centre{0, 0, 0};
  double scale = 1; ///< scene units a world unit
  std::vector<std::uint32_t> triangles;
  std::vector<PackedNormal> normals; ///< by corner; empty: flat
  std::size_t pointCount = 0;
  const float* points = nullptr; ///< Embree's
  RTCScene scene = nullptr;

  Impl() = default;
  ~Impl() { rtcReleaseScene(scene); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void fitBox(const TriangleMesh& mesh);
  void build(TriangleMesh& mesh);
  /// Shortens the ray to what the cut leaves of it; false where that is nothing. `entered`: it now
  /// begins on the plane.
  bool cut(Ray& ray, bool& entered) const {
    entered = false;
    return !look.cut || look.cut->clip(ray, entered);
  }
  bool isInside(const Ray& ray) const;
  bool clip(const Ray& ray, double& t0, double& t1) const;
  bool toScene(const Ray& ray, RTCRay& local, double& t0) const;
  Rgb colorAt(std::uint32_t face, float u, float v) const;
  bool isOnWire(std::uint32_t face, const Ray& ray, double t) const;
  Vec3d smoothNormal(std::uint32_t face, float u, float v) const;
};

// --- Building.

void TriangleDrawable::Impl::fitBox(const TriangleMesh& mesh) {
  box = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), 1 << 16), Box(),
      [&](const tbb::blocked_range<std::size_t>& range, Box part) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          part.add(mesh.points[mesh.triangles[i]]);
        return part;
      },
      [](Box a, const Box& b) {
        a.add(b);
        return a;
      });
  if (mesh.triangles.empty())
    return;
  double half = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    centre[axis] = box.low[axis] / 2 + box.high[axis] / 2;
    half = std::max({half, box.high[axis] - centre[axis], centre[axis] - box.low[axis]});
  }
  if (half > 0 && std::isfinite(1 / half))
    scale = 1 / half;
}

// Points become floats before the tree is built, and the doubles are freed as they are read: both
// together would be the peak of memory.
void TriangleDrawable::Impl::build(TriangleMesh& mesh) {
  const RTCDevice device = embreeDevice();
  scene = rtcNewScene(device);
  // Watertight, so that no ray passes between faces. The three build qualities could not be told
  // apart, neither in building nor by rays.
  unsigned flags = RTC_SCENE_FLAG_ROBUST;
  if (mesh.triangleCount() >= kCompactFrom)
    flags |= RTC_SCENE_FLAG_COMPACT;
  if (look.cut && look.closure != Closure::Open)
    flags |= kFilteredRays; // Crossings counts by one
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  pointCount = mesh.points.size();
  auto* floats = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                             std::max(pointCount, std::size_t(1))));
  if (floats != nullptr) {
    points = floats;
    floats[0] = floats[1] = floats[2] = 0;
    for (std::size_t first = 0; first < pointCount; first += kPointsAtOnce) {
      const std::size_t count = std::min(kPointsAtOnce, pointCount - first);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(first, first + count, 1 << 12),
                        [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i != range.end(); ++i) {
                            const Vec3d p = times(minus(mesh.points[i], centre), scale);
                            for (std::size_t axis = 0; axis < 3; ++axis)
                              // A point that no face uses may lie anywhere.
                              floats[3 * i + axis] =
                                  static_cast<float>(std::clamp(p[axis], -2.0, 2.0));
                          }
                        });
      discardPages(&mesh.points[first], count * sizeof(Vec3d));
    }
    std::vector<Vec3d>().swap(mesh.points);
    triangles = std::move(mesh.triangles);
    if (!triangles.empty()) {
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 triangles.data(), 0, 3 * sizeof(std::uint32_t),
                                 triangles.size() / 3);
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
    }
  }
  rtcReleaseGeometry(geometry);
  commit(scene);
}

TriangleDrawable::TriangleDrawable(TriangleMesh mesh, TriangleLook look, Progress& progress)
    : impl_(std::make_unique<Impl>()) {
  impl_->look = std::move(look);
  impl_->fitBox(mesh);
  if (impl_->look.smooth)
    impl_->normals = cornerNormals(mesh, impl_->look.creaseDegrees, progress);
  progress.check();
  impl_->build(mesh);
}

TriangleDrawable::~TriangleDrawable() = default;

// --- Rays.

// The part of the ray that is in the mesh's box, with a margin: a distant origin would lose the
// floats' digits.
bool TriangleDrawable::Impl::clip(const Ray& ray, double& t0, double& t1) const {
  const double margin = kRounding / scale;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double below = box.low[axis] - margin - ray.origin[axis];
    const double above = box.high[axis] + margin - ray.origin[axis];
    if (ray.direction[axis] == 0) {
      if (below > 0 || above < 0)
        return false;
      continue;
    }
    const double inverse = 1 / ray.direction[axis];
    const double a = below * inverse, b = above * inverse;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  return t0 <= t1;
}

bool TriangleDrawable::Impl::toScene(const Ray& ray, RTCRay& local, double& t0) const {
  t0 = ray.tMin;
  double t1 = ray.tMax;
  if (triangles.empty() || !clip(ray, t0, t1))
    return false;
  local.org_x = static_cast<float>((ray.origin[0] + t0 * ray.direction[0] - centre[0]) * scale);
  local.org_y = static_cast<float>((ray.origin[1] + t0 * ray.direction[1] - centre[1]) * scale);
  local.org_z = static_cast<float>((ray.origin[2] + t0 * ray.direction[2] - centre[2]) * scale);
  local.dir_x = static_cast<float>(ray.direction[0]);
  local.dir_y = static_cast<float>(ray.direction[1]);
  local.dir_z = static_cast<float>(ray.direction[2]);
  local.tnear = 0;
  local.tfar = static_cast<float>((t1 - t0) * scale);
  local.mask = 0xFFFFFFFFU;
  local.time = 0;
  local.flags = 0;
  local.id = 0;
  return true;
}

Rgb TriangleDrawable::Impl::colorAt(std::uint32_t face, float u, float v) const {
  if (!look.marked.empty() && look.marked[face] != 0)
    return look.markColor;
  const SurfaceValues& values = look.values;
  if (values.on == SurfaceValues::On::Nothing)
    return look.color;
  if (values.on == SurfaceValues::On::Faces)
    return values.scale(values.values[face]);
  const std::uint32_t* corner = &triangles[3 * std::size_t(face)];
  return values.scale((1 - u - v) * values.values[corner[0]] + u * values.values[corner[1]] +
                      v * values.values[corner[2]]);
}

// Whether an edge of the face is so near to the ray, across it, that its line covers the ray.
bool TriangleDrawable::Impl::isOnWire(std::uint32_t face, const Ray& ray, double t) const {
  const double reach = look.wirePixels / 2 * ray.pixelAt(t) * scale;
  const Vec3d at = times(minus(ray.at(t), centre), scale);
  std::array<Vec3d, 3> across;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t point = triangles[3 * std::size_t(face) + k];
    const Vec3d away = minus(toDouble(points + 3 * point), at);
    across[k] = minus(away, times(ray.direction, dot(away, ray.direction)));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d& a = across[k];
    const Vec3d along = minus(across[(k + 1) % 3], a);
    const double squared = dot(along, along);
    const double s = squared > 0 ? std::clamp(-dot(a, along) / squared, 0.0, 1.0) : 0;
    const Vec3d nearest = plus(a, times(along, s));
    if (dot(nearest, nearest) <= reach * reach)
      return true;
  }
  return false;
}

Vec3d TriangleDrawable::Impl::smoothNormal(std::uint32_t face, float u, float v) const {
  const PackedNormal* packed = &normals[3 * std::size_t(face)];
  const Float3 a = unpackNormal(packed[0]), b = unpackNormal(packed[1]),
               c = unpackNormal(packed[2]);
  Vec3d n;
  for (std::size_t axis = 0; axis < 3; ++axis)
    n[axis] = (1 - u - v) * a[axis] + u * b[axis] + v * c[axis];
  const double size = length(n);
  return size > 0 ? times(n, 1 / size) : n;
}

/// Whether the surface encloses the point where the ray begins.
bool TriangleDrawable::Impl::isInside(const Ray& ray) const {
  RTCRayHit local;
  double t0 = 0;
  Ray endless = ray;
  endless.tMax = kInfinity;
  if (!toScene(endless, local.ray, t0) || t0 > ray.tMin)
    return false; // it begins outside of the box
  local.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  local.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  Crossings crossings;
  intersect(scene, local, crossings.context, Crossings::count);
  return look.closure == Closure::Winding ? crossings.balance != 0 : crossings.faces % 2 != 0;
}

bool TriangleDrawable::firstHit(const Ray& whole, RayHit& hit) const {
  RTCRayHit local;
  double t0 = 0;
  Ray ray = whole;
  bool onCut = false;
  if (!impl_->cut(ray, onCut) || !impl_->toScene(ray, local.ray, t0))
    return false;
  if (onCut && impl_->look.closure != Closure::Open && impl_->isInside(ray)) {
    hit.t = ray.tMin;
    hit.normal = impl_->look.cut->normal;
    hit.color = impl_->look.capColor;
    hit.lit = true;
    return true;
  }
  local.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  local.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect(impl_->scene, local);
  if (local.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return false;
  hit.t = t0 + static_cast<double>(local.ray.tfar) / impl_->scale;
  const std::uint32_t face = local.hit.primID;
  Vec3d n = {local.hit.Ng_x, local.hit.Ng_y, local.hit.Ng_z};
  const double size = length(n);
  n = size > 0 ? times(n, 1 / size) : times(ray.direction, -1);
  const bool fromBehind = dot(n, ray.direction) > 0;
  if (fromBehind)
    n = times(n, -1);
  hit.normal = n;
  if (!impl_->normals.empty()) {
    Vec3d smooth = impl_->smoothNormal(face, local.hit.u, local.hit.v);
    if (fromBehind)
      smooth = times(smooth, -1);
    // At a silhouette a smoothed normal may point away from the eye.
    if (dot(smooth, ray.direction) < 0) {
      hit.normal = smooth;
      hit.faceNormal = n;
    }
  }
  hit.color = impl_->colorAt(face, local.hit.u, local.hit.v);
  hit.lit = true;
  if (impl_->look.wire && impl_->isOnWire(face, ray, hit.t))
    for (float& channel : hit.color)
      channel *= kWireShade;
  return true;
}

bool TriangleDrawable::blocks(const Ray& whole) const {
  RTCRay local;
  double t0 = 0;
  Ray ray = whole;
  bool onCut = false;
  if (!impl_->cut(ray, onCut) || !impl_->toScene(ray, local, t0))
    return false;
  if (onCut && impl_->look.closure != Closure::Open && impl_->isInside(ray))
    return true;
  return isOccluded(impl_->scene, local);
}

Box TriangleDrawable::bounds() const {
  return impl_->box;
}

double TriangleDrawable::skin() const {
  return kSkin / impl_->scale;
}

double TriangleDrawable::support(const Vec3d& direction) const {
  if (impl_->triangles.empty())
    return -kInfinity;
  const Float3 d = {static_cast<float>(direction[0]), static_cast<float>(direction[1]),
                    static_cast<float>(direction[2])};
  const auto reach = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, impl_->triangles.size(), 1 << 15), -INFINITY,
      [&](const tbb::blocked_range<std::size_t>& range, float farthest) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          const float* p = impl_->points + 3 * std::size_t(impl_->triangles[i]);
          farthest = std::max(farthest, p[0] * d[0] + p[1] * d[1] + p[2] * d[2]);
        }
        return farthest;
      },
      [](float a, float b) { return std::max(a, b); });
  return static_cast<double>(reach) / impl_->scale + dot(impl_->centre, direction);
}

} // namespace tetvdb
