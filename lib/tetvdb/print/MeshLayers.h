// SPDX-License-Identifier: Apache-2.0
//
// Layers of what closed faces bound.
//
//   tetvdb::MeshLayers layers(tetvdb::placedFaces(...), frame, tetvdb::LayerShare::Volume, {});
//   tetvdb::forEachLayer(layers, ...);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/print/GreyLevels.h"
#include "tetvdb/print/LayerSource.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// What a pixel's grey level is.
enum class LayerShare : std::uint8_t {
  Area,    ///< the share of the pixel that the layer's middle plane cuts out of the solid
  Volume,  ///< the share of the pixel times the layer's height that is solid
  Contours ///< no pixels: the lines in which the middle plane cuts the faces
};

/// Triangles in the coordinates of a frame: x and y in pixels of the image, for
/// LayerShare::Contours in millimetres on the plate; z in millimetres above the plate.
struct FrameFaces {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles; ///< three point indices each
  bool mirrored = false; ///< whether outward faces, seen from outside, turn clockwise
};

/// Millimetres by which layers are grown, or where below 0 shrunk, within their planes
/// (print/OffsetRows.h).
struct LayerOffset {
  double all = 0;              ///< every layer
  double foot = 0;             ///< the first layer is shrunk by this more
  std::int32_t footLayers = 1; ///< over which that fades evenly

  double of(std::int32_t k) const {
    return k >= footLayers ? all : all - foot * (footLayers - k) / footLayers;
  }
};

/// Cuts closed faces exactly. With N(p) the winding number of the faces around p, a share is the
/// integral of N over the pixel (of the middle plane, or of the whole layer), clamped to 0 to 1:
/// exact but for sums of doubles, within 2^-32. Where solids overlap within a pixel that the
/// boundaries of both pass through, what they share counts twice, up to 1; Layer::overlap says what
/// was cut off. A vertex on the middle plane counts as above it.
/// Layers with an offset are looked at along lines: 32 a row of pixels in the middle plane (Area),
/// or 8 in each of 4 planes (Volume). LayerShare::Contours takes no offset.
/// Faces must lie within the frame. Layers depend on the faces as a set, and on no number of
/// threads. Cost: about 60 ns for each pixel and face that meet in a layer (Volume), 20 ns (Area).
class MeshLayers : public LayerSource {
public:
  /// Throws Error(Limit) for 2^32 faces or more. `levels` is copied.
  MeshLayers(FrameFaces faces, const LayerFrame& frame, LayerShare share, const GreyLevels& levels,
             const LayerOffset& offset = {});
  ~MeshLayers() override;

  const LayerFrame& frame() const override;
  std::shared_ptr<const LayerBatch> batch(std::int32_t first) override;

private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace tetvdb
