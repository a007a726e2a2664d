// SPDX-License-Identifier: Apache-2.0
//
// A triangle mesh as a drawable.
//
//   tetvdb::TriangleLook look;
//   look.smooth = true;
//   scene.drawables.push_back(
//       std::make_shared<tetvdb::TriangleDrawable>(std::move(mesh), look, progress));
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/visualize/Closure.h"
#include "tetvdb/visualize/ColorMap.h"
#include "tetvdb/visualize/CutPlane.h"
#include "tetvdb/visualize/Drawable.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace tetvdb {

/// Numbers that give a surface its colours.
struct SurfaceValues {
  enum class On : std::uint8_t { Nothing, Faces, Points };
  On on = On::Nothing;
  std::vector<float> values; ///< one a face or point of the mesh; between points linear
  ColorScale scale;
};

struct TriangleLook {
  Rgb color{0.60F, 0.62F, 0.65F}; ///< where there are no values
  SurfaceValues values;
  /// Normals are averaged over the faces around a point that lie within creaseDegrees of each
  /// other.
  bool smooth = false;
  double creaseDegrees = 40;
  bool wire = false;
  double wirePixels = 1.2; ///< width of a line, half of it on either face
  /// Faces drawn in markColor, by face; empty: none.
  std::vector<std::uint8_t> marked;
  Rgb markColor{0.03F, 0.12F, 0.85F};
  /// The part beyond it is not drawn.
  std::optional<CutPlane> cut;
  /// How the cut tells inside from outside, where it is filled in capColor; Open: it is not
  /// filled.
  Closure closure = Closure::Open;
  Rgb capColor{0.80F, 0.36F, 0.16F};
};

/// Both sides of faces are drawn. The mesh is stored in floats relative to its box: rounding
/// is 1e-7 of its size.
class TriangleDrawable : public Drawable {
public:
  /// Memory: up to 130 bytes a face while the search tree is built, 90 afterwards, for a soup
  /// without shared points, of half a million faces and more 110 and 90; smooth shading adds 12
  /// bytes a face. About 0.3 us a face on two cores.
  /// Throws Error(Limit) where memory does not suffice.
  TriangleDrawable(TriangleMesh mesh, TriangleLook look, Progress& progress);
  ~TriangleDrawable() override;
  TriangleDrawable(const TriangleDrawable&) = delete;
  TriangleDrawable& operator=(const TriangleDrawable&) = delete;

  Box bounds() const override;
  double support(const Vec3d& direction) const override;
  bool firstHit(const Ray& ray, RayHit& hit) const override;
  bool blocks(const Ray& ray) const override;
  double skin() const override;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
