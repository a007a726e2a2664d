// SPDX-License-Identifier: Apache-2.0
//
// Pictures of scenes, by ray tracing.
//
//   tetvdb::Scene scene;
//   scene.drawables.push_back(std::make_shared<tetvdb::TriangleDrawable>(mesh, look, progress));
//   const tetvdb::View view = tetvdb::viewNamed("iso");
//   const tetvdb::Camera camera(view, {}, tetvdb::frame(view, {}, 640, 480, scene.support()), 640,
//                               480);
//   tetvdb::writePng("out.png", tetvdb::render(scene, camera, {}, progress));
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/visualize/Camera.h"
#include "tetvdb/visualize/Image.h"
#include "tetvdb/visualize/Lighting.h"
#include "tetvdb/visualize/Scene.h"

#include <cstdint>

namespace tetvdb {

struct RenderOptions {
  Lighting lighting;
  /// Rays a pixel, sixteen in place of the usual four, go to at most this share of the pixels: to
  /// those where the four, or neighbouring pixels, differ most.
  double refinedShare = 0.15;
  /// Rays to the sky from every pixel, distributed over its first four samples. Further samples of
  /// refined pixels get as many in proportion, where few neighbours show the same surface.
  std::uint32_t skyRays = 4;
  /// Smooths the sky's light, a random estimate, among pixels of one surface.
  bool smoothSky = true;
};

/// Every pixel's rays, and what is random about them, depend on the pixel's place alone, so that
/// the picture is the same for any number of threads. Memory: 60 bytes a pixel. Parallel; on two
/// cores about 0.5 s for 640 x 480 and 10^6 triangles. Throws Error(Limit) for a picture without
/// pixels, Error(Cancelled).
Image render(const Scene& scene, const Camera& camera, const RenderOptions& options,
             Progress& progress);

} // namespace tetvdb
