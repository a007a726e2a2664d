// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/Camera.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tetvdb {
namespace {

constexpr double kFrameMargin = 0.04; // of the shorter side, all round
constexpr double kCentred = 1e-6;     // share of the picture by which the subject may be off centre
constexpr double kVertical = 1e-6; // sine of the angle to up below which a view counts as vertical
// Distance of the eye from the subject's nearest point, as a share of the larger of the subject's
// width and height: the eye would otherwise be at the tip of a pointed subject.
constexpr double kClearance = 0.25;

Vec3d unit(const Vec3d& v) {
  const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  const Vec3d scaled = times(v, 1 / largest); // squares of huge numbers would overflow
  return times(scaled, 1 / length(scaled));
}

// Where the eye of the front view is.
Vec3d frontOf(const Vec3d& worldUp) {
  return worldUp[2] > 0.5 ? Vec3d{0, -1, 0} : Vec3d{0, 0, 1};
}

// "X,Y,Z"
bool parseDirection(const std::string& text, Vec3d& direction) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0 && (at == end || *at++ != ','))
      return false;
    if (at != end && *at == '+')
      ++at;
    const auto [next, error] = std::from_chars(at, end, direction[axis]);
    if (error != std::errc() || !std::isfinite(direction[axis]))
      return false;
    at = next;
  }
  return at == end;
}

Vec3d turnedAbout(const Vec3d& axis, const Vec3d& v, double angle) {
  const double cosine = std::cos(angle), sine = std::sin(angle);
  return plus(plus(times(v, cosine), times(cross(axis, v), sine)),
              times(axis, dot(axis, v) * (1 - cosine)));
}

// Half the picture's sides, in world units at distance 1 or for a span of 1.
void halves(const Lens& lens, int width, int height, double& across, double& down) {
  const double half = lens.perspective ? std::tan(lens.degrees / 2 * kRadiansPerDegree) : 0.5;
  const double shorter = std::min(width, height);
  across = half * width / shorter;
  down = half * height / shorter;
}

/// The place of the eye along `side`, at depth z, from which the subject is centred: the planes
/// through the eye that lean by a slope t to either side both touch the subject where reach(side,
/// t) + reach(-side, t) = 2 t z. At slope 0 that is its width; at slope `maxSlope` both planes lie
/// beyond it. Regula falsi with Illinois' halving.
template <class Reach>
double centredEye(const Reach& reach, const Vec3d& side, double maxSlope, double z) {
  double x = 0;
  const auto excess = [&](double t) {
    const double there = reach(side, t), back = reach(times(side, -1), t);
    x = there / 2 - back / 2;
    return there + back - 2 * t * z;
  };
  double low = 0, high = maxSlope;
  double above = excess(low), below = above > 0 ? excess(high) : 0;
  int moved = 0;
  for (int round = 0; round < 40 && above > 0 && below < 0; ++round) {
    const double t = low + (high - low) * above / (above - below);
    const double value = excess(t);
    if (std::abs(value) <= kCentred * maxSlope * z)
      break;
    if (value > 0) {
      low = t;
      above = value;
      below *= moved > 0 ? 0.5 : 1;
      moved = 1;
    } else {
      high = t;
      below = value;
      above *= moved < 0 ? 0.5 : 1;
      moved = -1;
    }
  }
  return x;
}

} // namespace

View viewFrom(const Vec3d& toEye, const Vec3d& worldUp) {
  if (!(dot(toEye, toEye) > 0 || std::abs(toEye[0]) + std::abs(toEye[1]) + std::abs(toEye[2]) > 0))
    throw Error(Status::Usage, "", "a view needs a direction that is not zero");
  View view;
  view.worldUp = worldUp;
  view.toEye = unit(toEye);
  const double height = dot(view.toEye, worldUp);
  Vec3d up = minus(worldUp, times(view.toEye, height));
  if (length(up) < kVertical)
    up = times(frontOf(worldUp), height > 0 ? -1 : 1); // as in the limit of views from the front
  up = minus(up, times(view.toEye, dot(up, view.toEye)));
  view.up = unit(up);
  view.right = cross(view.up, view.toEye);
  return view;
}

View viewNamed(const std::string& name, const Vec3d& worldUp) {
  const Vec3d front = frontOf(worldUp), right{1, 0, 0};
  if (name == "iso")
    return viewFrom(plus(plus(front, right), worldUp), worldUp);
  if (name == "front")
    return viewFrom(front, worldUp);
  if (name == "back")
    return viewFrom(times(front, -1), worldUp);
  if (name == "right")
    return viewFrom(right, worldUp);
  if (name == "left")
    return viewFrom(times(right, -1), worldUp);
  if (name == "top")
    return viewFrom(worldUp, worldUp);
  if (name == "bottom")
    return viewFrom(times(worldUp, -1), worldUp);
  Vec3d direction;
  if (!parseDirection(name, direction) || direction == Vec3d{0, 0, 0})
    throw Error(Status::Usage, "view", "'" + name + "' is no view",
                "give iso, front, back, left, right, top, bottom or a direction X,Y,Z");
  return viewFrom(direction, worldUp);
}

View turned(const View& view, double angle) {
  View result = view;
  for (Vec3d View::*axis : {&View::right, &View::up, &View::toEye})
    result.*axis = turnedAbout(view.worldUp, view.*axis, -angle);
  return result;
}

Support supportOf(const Box& box) {
  return [box](const Vec3d& direction) { return supportOf(box, direction); };
}

Framing frame(const View& view, const Lens& lens, int columns, int rows, const Support& support) {
  Framing framing;
  const double near = support(view.toEye), far = -support(times(view.toEye, -1));
  if (!std::isfinite(near) || !std::isfinite(far))
    return framing;
  const double centreDepth = near / 2 + far / 2;
  double across = 0, down = 0;
  halves(lens, columns, rows, across, down);
  const double inside = 1 - 2 * kFrameMargin;
  // In coordinates (right, up, towards the eye) the planes at the picture's edges are x + t z = c
  // with z towards the eye, t = 0 with parallel rays.
  const double tx = lens.perspective ? across * inside : 0;
  const double ty = lens.perspective ? down * inside : 0;
  const auto reach = [&](const Vec3d& side, double t) {
    return support(plus(side, times(view.toEye, t)));
  };
  const double right = reach(view.right, tx), left = reach(times(view.right, -1), tx);
  const double top = reach(view.up, ty), bottom = reach(times(view.up, -1), ty);
  double x = right / 2 - left / 2, y = top / 2 - bottom / 2;
  if (lens.perspective) {
    // The eye (x, y, z): x - right edge = t (z - ...) on either side, so that right + left = 2 t z.
    // The axis that needs the greater z is filled; along the other the subject is centred.
    const double width = reach(view.right, 0) + reach(times(view.right, -1), 0);
    const double height = reach(view.up, 0) + reach(times(view.up, -1), 0);
    const double z = std::max({(right + left) / (2 * tx), (top + bottom) / (2 * ty),
                               near + kClearance * std::max(width, height)});
    framing.span = 2 * (z - centreDepth) * std::min(across, down);
    const auto centre = [&](const Vec3d& side, double maxSlope) {
      return centredEye(reach, side, maxSlope, z);
    };
    if ((right + left) / (2 * tx) < z)
      x = centre(view.right, tx);
    if ((top + bottom) / (2 * ty) < z)
      y = centre(view.up, ty);
  } else {
    framing.span = std::max((right + left) / (2 * across), (top + bottom) / (2 * down)) / inside;
  }
  if (!(framing.span > 0) || !std::isfinite(framing.span))
    framing.span = 1;
  framing.target =
      plus(plus(times(view.right, x), times(view.up, y)), times(view.toEye, centreDepth));
  const double depth = near / 2 - far / 2;
  framing.reach = depth + std::max(framing.span, depth) / 100;
  return framing;
}

Camera::Camera(const View& view, const Lens& lens, const Framing& framing, int width, int height)
    : view_(view), lens_(lens), width_(width), height_(height) {
  const double shorter = std::min(width, height);
  double distance = framing.reach;
  pixel_ = framing.span / shorter;
  if (lens.perspective) {
    const double tangent = std::tan(lens.degrees / 2 * kRadiansPerDegree);
    distance = framing.span / (2 * tangent);
    pixel_ = 2 * tangent / shorter;
  }
  origin_ = plus(framing.target, times(view.toEye, distance));
}

Ray Camera::ray(double x, double y) const {
  const Vec3d aside = plus(times(view_.right, (x - width_ / 2.0) * pixel_),
                           times(view_.up, (height_ / 2.0 - y) * pixel_));
  Ray ray;
  if (lens_.perspective) {
    const Vec3d way = minus(aside, view_.toEye);
    const double slant = length(way);
    ray.origin = origin_;
    ray.direction = times(way, 1 / slant);
    ray.spread = pixel_ / slant;
  } else {
    ray.origin = plus(origin_, aside);
    ray.direction = times(view_.toEye, -1);
    ray.pixel = pixel_;
  }
  return ray;
}

Camera::Projected Camera::project(const Vec3d& point) const {
  const Vec3d v = minus(point, origin_);
  const double depth = -dot(v, view_.toEye);
  const double pixel = pixelAt(depth);
  return {width_ / 2.0 + dot(v, view_.right) / pixel, height_ / 2.0 - dot(v, view_.up) / pixel,
          depth};
}

Camera::Footprint Camera::footprint(const Vec3d& centre, const Vec3d& reach) const {
  const Vec3d v = minus(centre, origin_);
  const double depth = -dot(v, view_.toEye);
  const double near = depth - reach[2], far = depth + reach[2];
  Footprint print{0, width_ - 1, 0, height_ - 1, std::max(near, 0.0)};
  if (lens_.perspective && near <= 0) // the eye is inside: anywhere
    return print;
  // Pixels a unit at the near and at the far side of the box. In the picture the near side is
  // farther from the centre.
  const double atNear = 1 / pixelAt(near);
  const double atFar = lens_.perspective ? 1 / pixelAt(far) : atNear;
  const auto pixel = [](double p, int count) { // rounded down, and -1 or `count` outside
    return static_cast<int>(std::min(std::max(p + 1, 0.0), count + 1.0)) - 1;
  };
  const auto range = [&](double low, double high, int count, int& first, int& last) {
    const double half = count / 2.0;
    first = std::max(pixel(half + low * (low < 0 ? atNear : atFar), count), 0);
    last = std::min(pixel(half + high * (high < 0 ? atFar : atNear), count), count - 1);
  };
  const double x = dot(v, view_.right), y = -dot(v, view_.up);
  range(x - reach[0], x + reach[0], width_, print.left, print.right);
  range(y - reach[1], y + reach[1], height_, print.top, print.bottom);
  return print;
}

} // namespace tetvdb
