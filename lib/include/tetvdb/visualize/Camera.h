// SPDX-License-Identifier: Apache-2.0
//
// The camera of a picture: view, framing, rays through pixels.
//
//   const tetvdb::View view = tetvdb::viewNamed("iso", tetvdb::UpAxis::Z);
//   tetvdb::Framing framing = tetvdb::frame(view, {}, width, height, scene.supports());
//   const tetvdb::Camera camera(view, {}, framing, width, height);
//   const tetvdb::Ray ray = camera.ray(x + 0.5, y + 0.5);
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/visualize/Drawable.h"

#include <functional>
#include <string>

namespace tetvdb {

/// An orientation: unit vectors at right angles, right x up = towards the eye.
struct View {
  Vec3d right{1, 0, 0};
  Vec3d up{0, 0, 1};
  Vec3d toEye{0, -1, 0};
  Vec3d worldUp{0, 0, 1}; ///< for light from the sky; `up` leans towards it
};

/// The view from a direction (of any length; from what is looked at to the eye). Where it is
/// vertical, up in the picture is the horizontal axis that comes first: y for z up, -z for y up.
/// Throws Error(Usage) for a direction without length.
View viewFrom(const Vec3d& toEye, const Vec3d& worldUp = {0, 0, 1});

/// Named views, as Blender has them for z up: front looks along +y, right along -x, top down;
/// iso is from the front, right and above in equal parts. With y up, front looks along -z.
/// Or a direction "X,Y,Z". Throws Error(Usage) for another name.
View viewNamed(const std::string& name, const Vec3d& worldUp = {0, 0, 1});

/// The view after the subject has turned by an angle (radians) about the world's up axis.
View turned(const View& view, double angle);

struct Lens {
  bool perspective = false; ///< false: parallel rays
  double degrees = 30;      ///< the angle that the picture's shorter side spans
};

/// Which part of the world is in the picture.
struct Framing {
  Vec3d target{0, 0, 0}; ///< in the centre of the picture
  double span = 1;       ///< world units along the picture's shorter side, at the target's distance
  /// World units from the target towards the eye, beyond which there is nothing: where parallel
  /// rays start.
  double reach = 1;
};

/// How far a subject reaches in a direction: the maximum of the dot product with the subject's
/// points; -infinity where there is nothing.
using Support = std::function<double(const Vec3d& direction)>;
Support supportOf(const Box& box);

/// The closest framing that shows all of what `support` describes, with a margin of 4 % of each
/// side, centred along both sides; in perspective the eye keeps a distance of a quarter of the
/// subject's width or height, whichever is larger. Nothing, or a point: a span of 1. Asks
/// `support` ten times, in perspective some twenty times more.
Framing frame(const View& view, const Lens& lens, int columns, int rows, const Support& support);

/// Maps between pixels and rays. Pixel (x, y) covers [x, x + 1) x [y, y + 1), y downward from the
/// picture's upper edge.
class Camera {
public:
  Camera(const View& view, const Lens& lens, const Framing& framing, int width, int height);

  /// The ray through a point of the picture, with its pixel's width.
  Ray ray(double x, double y) const;

  struct Projected {
    double x, y;  ///< in pixels
    double depth; ///< along the view's axis, from the eye or from where parallel rays start
  };
  Projected project(const Vec3d& point) const;

  /// The pixels that a box may cover, inclusive, within the picture (right < left: none), and a t
  /// that it lies behind on all of their rays, 0 or more.
  struct Footprint {
    int left, right, top, bottom;
    double depth;
  };
  /// Of a box given by its centre and how far it reaches from there along the view's axes (right,
  /// up, towards the eye).
  Footprint footprint(const Vec3d& centre, const Vec3d& reach) const;

  /// A pixel's side in world units at that depth.
  double pixelAt(double depth) const { return lens_.perspective ? pixel_ * depth : pixel_; }
  const View& view() const { return view_; }
  int width() const { return width_; }
  int height() const { return height_; }

private:
  View view_;
  Lens lens_;
  int width_, height_;
  Vec3d origin_; ///< the eye, or where the central one of parallel rays starts
  double pixel_; ///< a pixel's side, at depth 1 or everywhere
};

} // namespace tetvdb
