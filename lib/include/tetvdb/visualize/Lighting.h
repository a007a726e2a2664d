// SPDX-License-Identifier: Apache-2.0
//
// The light in a picture: one distant lamp near the eye's direction, and a sky that is brighter
// above than below, with ambient occlusion.
#pragma once

#include "tetvdb/visualize/Camera.h"
#include "tetvdb/visualize/Drawable.h"
#include "tetvdb/visualize/Scene.h"

#include <cstdint>

namespace tetvdb {

struct Lighting {
  /// To the lamp, in the view's axes: right, up, towards the eye. Of any length.
  Vec3d lamp{-0.45, 0.65, 1};
  float lampLight = 0.62F;   ///< that a white surface square to the lamp reflects
  float skyLight = 0.46F;    ///< that a white surface below an open sky reflects
  float groundLight = 0.18F; ///< that a white surface that looks down reflects
  bool shadows = true;       ///< of the lamp
  bool occlusion = true;
  /// The distance up to which surfaces occlude the sky, as a share of the diagonal of the scene's
  /// box.
  double occlusionRange = 0.2;
};

/// What one ray through a pixel sees. The sky's light is separate, since its visible share is
/// a random estimate.
struct Sample {
  Rgb fixed{0, 0, 0}; ///< all other light, with that of media
  Rgb sky{0, 0, 0};   ///< the sky's light if nothing hid it
  float alpha = 0;    ///< how much of the background is hidden
  float visible = 1;  ///< the share of the sky that was found open
  bool hit = false;
  Vec3d normal{0, 0, 0}; ///< where `hit`
  double depth = 0;      ///< along the ray, where `hit`
};

/// Colours what rays hit. Const member functions are thread-safe.
class Lights {
public:
  Lights(const Scene& scene, const View& view, const Lighting& lighting);

  /// Follows a ray; `rays` of them are traced to the sky, at places number first .. first + rays -
  /// 1 of a (0,2)-sequence that `scramble` moves: the samples of one pixel are then stratified, and
  /// pixels with different scrambles have different patterns. `jitter` is that of
  /// Medium::gather().
  Sample sample(const Ray& ray, std::uint64_t scramble, std::uint32_t first, std::uint32_t rays,
                double jitter) const;

private:
  bool firstHit(Ray ray, RayHit& hit) const;
  bool isBlocked(const Ray& ray) const;
  float openSky(const Vec3d& from, const Vec3d& normal, std::uint64_t scramble, std::uint32_t first,
                std::uint32_t rays) const;
  void light(const RayHit& hit, const Vec3d& at, Sample& sample, std::uint64_t scramble,
             std::uint32_t first, std::uint32_t rays) const;
  void addMedia(const Ray& ray, double jitter, Sample& sample) const;

  const Scene& scene_;
  Lighting lighting_;
  Vec3d toLamp_, up_;
  double range_, skin_;
};

} // namespace tetvdb
