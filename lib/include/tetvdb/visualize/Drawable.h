// SPDX-License-Identifier: Apache-2.0
//
// The contents of a picture: surfaces that rays hit, and media that they pass through. The renderer
// knows meshes and volumes by these interfaces alone.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/BoxTree.h"

#include <array>
#include <limits>

namespace tetvdb {

using Rgb = std::array<float, 3>; ///< linear light, sRGB's primaries; 1 is white

struct Ray {
  Vec3d origin{0, 0, 0};    ///< world units
  Vec3d direction{0, 0, 1}; ///< of length 1
  double tMin = 0;          ///< world units along the direction
  double tMax = std::numeric_limits<double>::infinity();
  /// The side of the ray's pixel, in world units: pixel + spread t; 0 for rays without a pixel.
  /// Used for widths in pixels (lines) and levels of detail.
  double pixel = 0, spread = 0;

  double pixelAt(double t) const { return pixel + spread * t; }
  Vec3d at(double t) const {
    return {origin[0] + t * direction[0], origin[1] + t * direction[1],
            origin[2] + t * direction[2]};
  }
};

struct RayHit {
  double t = std::numeric_limits<double>::infinity();
  Vec3d normal{0, 0, 1}; ///< of length 1, towards the ray's origin
  Rgb color{1, 1, 1};    ///< of the surface: its reflectance
  bool lit = true;       ///< false: shown in its colour as it is (lines, legends)
  /// The surface's own normal where `normal` is a smoothed one, of length 1, towards the ray's
  /// origin; zero: `normal` is it.
  Vec3d faceNormal{0, 0, 0};
};

/// The maximum of the dot product of `direction` with the points of a box; -infinity for an empty
/// one.
inline double supportOf(const Box& box, const Vec3d& direction) {
  if (!(box.low[0] <= box.high[0]))
    return -std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    sum += direction[axis] * (direction[axis] > 0 ? box.high : box.low)[axis];
  return sum;
}

class EntryMap;

/// An opaque subject. Const member functions are thread-safe.
class Drawable {
public:
  virtual ~Drawable() = default;
  /// World units; empty where there is nothing to draw.
  virtual Box bounds() const = 0;
  /// How far it reaches in a direction: the maximum of the dot product with its points, or more.
  /// Cameras find the closest framing by it; the box's is often twice as large as needed.
  virtual double support(const Vec3d& direction) const { return supportOf(bounds(), direction); }
  /// The first point within [tMin, tMax], if there is one.
  virtual bool firstHit(const Ray& ray, RayHit& hit) const = 0;
  /// Adds boxes that cover it to the map. False where it has none, or where they would save no
  /// time: every ray is then tested.
  virtual bool mark(EntryMap& /*map*/) const { return false; }
  /// Whether there is a point within [tMin, tMax]: for shadows and ambient occlusion.
  virtual bool blocks(const Ray& ray) const = 0;
  /// How far off the surface a ray must begin, in world units, so as not to hit its own origin.
  virtual double skin() const = 0;
};

/// A medium that light passes through. Const member functions are thread-safe.
class Medium {
public:
  virtual ~Medium() = default;
  virtual Box bounds() const = 0;
  /// As Drawable::support().
  virtual double support(const Vec3d& direction) const { return supportOf(bounds(), direction); }
  /// As Drawable::mark().
  virtual bool mark(EntryMap& /*map*/) const { return false; }
  /// Light that reaches the ray's origin from within [tMin, tMax], and the share of light from
  /// behind that passes. `jitter` in [0, 1) moves the samples by that share of a step.
  virtual void gather(const Ray& ray, double jitter, Rgb& light, float& transmittance) const = 0;
};

} // namespace tetvdb
