// SPDX-License-Identifier: Apache-2.0
//
// Things of which a picture can be worked out by hand.
#pragma once

#include "tetvdb/visualize/Renderer.h"

#include <cmath>
#include <memory>

namespace tetvdb::analytic {

inline double dotOf(const Vec3d& a, const Vec3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

class Ball : public Drawable {
public:
  Ball(const Vec3d& centre, double radius, const Rgb& color = {1, 1, 1})
      : centre_(centre), radius_(radius), color_(color) {}
  Box bounds() const override {
    Box box;
    for (const double sign : {-1.0, 1.0})
      box.add(Vec3d{centre_[0] + sign * radius_, centre_[1] + sign * radius_,
                    centre_[2] + sign * radius_});
    return box;
  }
  double support(const Vec3d& direction) const override {
    return dotOf(centre_, direction) + radius_ * std::sqrt(dotOf(direction, direction));
  }
  bool firstHit(const Ray& ray, RayHit& hit) const override {
    Vec3d away;
    for (std::size_t axis = 0; axis < 3; ++axis)
      away[axis] = ray.origin[axis] - centre_[axis];
    const double half = dotOf(away, ray.direction);
    const double under = half * half - dotOf(away, away) + radius_ * radius_;
    if (under < 0)
      return false;
    for (const double t : {-half - std::sqrt(under), -half + std::sqrt(under)}) {
      if (t < ray.tMin || t > ray.tMax)
        continue;
      hit.t = t;
      for (std::size_t axis = 0; axis < 3; ++axis)
        hit.normal[axis] = (away[axis] + t * ray.direction[axis]) / radius_;
      if (dotOf(hit.normal, ray.direction) > 0)
        for (double& c : hit.normal)
          c = -c;
      hit.color = color_;
      return true;
    }
    return false;
  }
  bool blocks(const Ray& ray) const override {
    RayHit hit;
    return firstHit(ray, hit);
  }
  double skin() const override { return 1e-9 * radius_; }

private:
  Vec3d centre_;
  double radius_;
  Rgb color_;
};

/// A rectangle at right angles to an axis.
class Plate : public Drawable {
public:
  Plate(std::size_t axis, const Vec3d& low, const Vec3d& high, const Rgb& color = {1, 1, 1},
        bool lit = true)
      : axis_(axis), box_{low, high}, color_(color), lit_(lit) {}
  Box bounds() const override { return box_; }
  bool firstHit(const Ray& ray, RayHit& hit) const override {
    const double t = (box_.low[axis_] - ray.origin[axis_]) / ray.direction[axis_];
    if (!(t >= ray.tMin && t <= ray.tMax))
      return false;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = ray.origin[a] + t * ray.direction[a];
      if (a != axis_ && (x < box_.low[a] || x > box_.high[a]))
        return false;
    }
    hit.t = t;
    hit.normal = {0, 0, 0};
    hit.normal[axis_] = ray.direction[axis_] > 0 ? -1 : 1;
    hit.color = color_;
    hit.lit = lit_;
    return true;
  }
  bool blocks(const Ray& ray) const override {
    RayHit hit;
    return firstHit(ray, hit);
  }
  double skin() const override { return 1e-9; }

private:
  std::size_t axis_;
  Box box_;
  Rgb color_;
  bool lit_;
};

/// Between two heights: shines and dims the same everywhere.
class Layer : public Medium {
public:
  Layer(double low, double high, const Rgb& light, float through)
      : low_(low), high_(high), light_(light), through_(through) {}
  Box bounds() const override { return {{-1, -1, low_}, {1, 1, high_}}; }
  void gather(const Ray& ray, double, Rgb& light, float& transmittance) const override {
    // Rays from above: all of the layer or, where they end above it, nothing.
    const double t = (high_ - ray.origin[2]) / ray.direction[2];
    const bool meets = t >= ray.tMin && t <= ray.tMax;
    light = meets ? light_ : Rgb{0, 0, 0};
    transmittance = meets ? through_ : 1;
  }

private:
  double low_, high_;
  Rgb light_;
  float through_;
};

} // namespace tetvdb::analytic
