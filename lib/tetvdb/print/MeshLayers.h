// SPDX-License-Identifier: Apache-2.0
//
// Layers of the solid that closed faces bound.
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

/// The meaning of a pixel's grey level.
enum class LayerShare : std::uint8_t {
  Area,    ///< the solid share of the pixel in the layer's middle plane
  Volume,  ///< the solid share of the pixel times the layer's height
  Contours ///< no pixels: the lines in which the middle plane cuts the faces
};

/// Triangles in the coordinates of a frame: x and y in pixels of the image, for
/// LayerShare::Contours in millimetres on the plate; z in millimetres above the plate.
struct FrameFaces {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> triangles; ///< three point indices each
  bool mirrored = false;                ///< whether outward faces are clockwise seen from outside
};

/// Millimetres by which layers are grown, or shrunk if negative, within their planes
/// (print/OffsetRows.h).
struct LayerOffset {
  double all = 0;              ///< every layer
  double foot = 0;             ///< additional shrinking of the first layer
  std::int32_t footLayers = 1; ///< number of layers over which it decreases linearly

  double of(std::int32_t k) const {
    return k >= footLayers ? all : all - foot * (footLayers - k) / footLayers;
  }
};

/// Cuts closed faces exactly. With N(p) the winding number of the faces around p, a share is the
/// integral of N over the pixel (of the middle plane, or of the whole layer), limited to 0 to 1:
/// exact up to sums of doubles, within 2^-32. Where solids overlap within a pixel that both
/// boundaries cross, the overlap counts twice, up to 1; Layer::overlap is the sum that was cut off.
/// A vertex on the middle plane counts as above it. Layers with an offset are sampled along lines:
/// 32 per row of pixels in the middle plane (Area), or 8 in each of 4 planes (Volume).
/// LayerShare::Contours does not support offsets. Faces must lie within the frame. Layers depend on
/// the faces as a set, and not on the number of threads. Cost: about 60 ns per pixel and face that
/// meet in a layer (Volume), 20 ns (Area).
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
