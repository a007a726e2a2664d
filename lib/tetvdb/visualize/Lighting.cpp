// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Lighting.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr double kTwoToMinus32 = 1.0 / 4294967296.0;

// The second dimension of Sobol's sequence (its first is the radical inverse in base 2): together a
// (0,2)-sequence, of which every aligned run of 2^k points has one in each of the elementary
// intervals of that size, also after an exclusive or with fixed bits. I. M. Sobol', "On the
// distribution of points in a cube and the approximate evaluation of integrals" (1967).
std::uint32_t sobolSecond(std::uint32_t i) {
  std::uint32_t result = 0;
  for (std::uint32_t v = 1U << 31; i != 0; i >>= 1, v ^= v >> 1)
    if ((i & 1) != 0)
      result ^= v;
  return result;
}

std::uint32_t reversedBits(std::uint32_t i) {
  i = i << 16 | i >> 16;
  i = (i & 0x00FF00FFU) << 8 | (i & 0xFF00FF00U) >> 8;
  i = (i & 0x0F0F0F0FU) << 4 | (i & 0xF0F0F0F0U) >> 4;
  i = (i & 0x33333333U) << 2 | (i & 0xCCCCCCCCU) >> 2;
  return (i & 0x55555555U) << 1 | (i & 0xAAAAAAAAU) >> 1;
}

// Two vectors of length 1 at right angles to n and to each other.
void complete(const Vec3d& n, Vec3d& u, Vec3d& v) {
  u = std::abs(n[0]) < 0.6 ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0});
  u = times(u, 1 / length(u));
  v = cross(n, u);
}

void add(Rgb& sum, const Rgb& color, float share) {
  for (std::size_t c = 0; c < 3; ++c)
    sum[c] += color[c] * share;
}

} // namespace

Lights::Lights(const Scene& scene, const View& view, const Lighting& lighting)
    : scene_(scene), lighting_(lighting), up_(view.worldUp), skin_(0) {
  toLamp_ = plus(plus(times(view.right, lighting.lamp[0]), times(view.up, lighting.lamp[1])),
                 times(view.toEye, lighting.lamp[2]));
  toLamp_ = times(toLamp_, 1 / length(toLamp_));
  const Box box = scene.bounds();
  range_ =
      box.low[0] <= box.high[0] ? lighting.occlusionRange * length(minus(box.high, box.low)) : 0;
  for (const auto& drawable : scene.drawables)
    skin_ = std::max(skin_, drawable->skin());
}

bool Lights::firstHit(Ray ray, RayHit& hit) const {
  bool any = false;
  for (const auto& drawable : scene_.drawables) {
    RayHit here;
    if (!drawable->firstHit(ray, here) || !(here.t < hit.t))
      continue;
    hit = here;
    ray.tMax = here.t;
    any = true;
  }
  return any;
}

bool Lights::isBlocked(const Ray& ray) const {
  return std::any_of(scene_.drawables.begin(), scene_.drawables.end(),
                     [&](const auto& drawable) { return drawable->blocks(ray); });
}

// Directions in proportion to the cosine with the normal (Malley's method), so that every ray
// counts as much as any other.
float Lights::openSky(const Vec3d& start, const Vec3d& normal, std::uint64_t scramble,
                      std::uint32_t first, std::uint32_t rays) const {
  Vec3d u, v;
  complete(normal, u, v);
  const auto low = static_cast<std::uint32_t>(scramble);
  const auto high = static_cast<std::uint32_t>(scramble >> 32);
  Ray ray;
  ray.origin = start;
  ray.tMax = range_;
  std::uint32_t open = 0;
  for (std::uint32_t i = first; i < first + rays; ++i) {
    const double a = (reversedBits(i) ^ low) * kTwoToMinus32;
    const double b = ((sobolSecond(i) ^ high) + 0.5) * kTwoToMinus32;
    const double radius = std::sqrt(b), angle = 2 * kPi * a;
    ray.direction =
        plus(plus(times(u, radius * std::cos(angle)), times(v, radius * std::sin(angle))),
             times(normal, std::sqrt(1 - b)));
    open += !isBlocked(ray);
  }
  return static_cast<float>(open) / static_cast<float>(rays);
}

void Lights::light(const RayHit& hit, const Vec3d& at, Sample& sample, std::uint64_t scramble,
                   std::uint32_t first, std::uint32_t rays) const {
  const bool isSmoothed = dot(hit.faceNormal, hit.faceNormal) > 0;
  const Vec3d& side = isSmoothed ? hit.faceNormal : hit.normal;
  const Vec3d start = plus(at, times(side, skin_));

  double fromLamp = dot(hit.normal, toLamp_);
  // A face that is turned away from the lamp while its smoothed normal is not would lie in its own
  // shadow, and the line between light and dark would follow the faces' edges.
  if (fromLamp > 0 && lighting_.shadows && dot(side, toLamp_) > 0) {
    Ray ray;
    ray.origin = start;
    ray.direction = toLamp_;
    if (isBlocked(ray))
      fromLamp = 0;
  }
  if (fromLamp > 0)
    add(sample.fixed, hit.color, lighting_.lampLight * static_cast<float>(fromLamp));
  const auto above = static_cast<float>((1 + dot(hit.normal, up_)) / 2);
  add(sample.sky, hit.color,
      lighting_.groundLight + (lighting_.skyLight - lighting_.groundLight) * above);
  if (lighting_.occlusion && rays > 0 && range_ > 0)
    sample.visible = openSky(start, side, scramble, first, rays);
}

void Lights::addMedia(const Ray& ray, double jitter, Sample& sample) const {
  Rgb light{0, 0, 0};
  float through = 1;
  for (const auto& medium : scene_.media) {
    Rgb own{0, 0, 0};
    float ownThrough = 1;
    medium->gather(ray, jitter, own, ownThrough);
    // Media that overlap are composed in their order in the list.
    add(light, own, through);
    through *= ownThrough;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    sample.fixed[c] = light[c] + through * sample.fixed[c];
    sample.sky[c] *= through;
  }
  sample.alpha = 1 - through * (1 - sample.alpha);
}

Sample Lights::sample(const Ray& ray, std::uint64_t scramble, std::uint32_t first,
                      std::uint32_t rays, double jitter) const {
  Sample sample;
  RayHit hit;
  Ray clear = ray;
  if (firstHit(ray, hit)) {
    sample.hit = true;
    sample.alpha = 1;
    sample.normal = hit.normal;
    sample.depth = hit.t;
    clear.tMax = hit.t;
    if (hit.lit)
      light(hit, ray.at(hit.t), sample, scramble, first, rays);
    else
      sample.fixed = hit.color;
  }
  if (!scene_.media.empty())
    addMedia(clear, jitter, sample);
  return sample;
}

} // namespace tetvdb
