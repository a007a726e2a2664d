// SPDX-License-Identifier: Apache-2.0
//
// The position of a model on the plate, and in the image.
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/MeshLayers.h"
#include "tetvdb/print/PlaceOptions.h"
#include "tetvdb/print/PrinterSettings.h"
#include "tetvdb/voxelize/ChooseTransform.h"

#include <array>
#include <optional>

namespace tetvdb {

/// How far a model may exceed the plate, relative to a length: rounding.
constexpr double kPlateRounding = 1e-9;

/// Maps the model to the plate: point * scale + offset, in millimetres. The plate's x and y are
/// from 0 to the display's width and height, seen from above.
struct PlateMap {
  std::array<double, 3> scale{1, 1, 1}, offset{0, 0, 0};
  WorldBox box; ///< of the model, on the plate

  Vec3d operator()(const Vec3d& p) const {
    return {p[0] * scale[0] + offset[0], p[1] * scale[1] + offset[1], p[2] * scale[2] + offset[2]};
  }
};

/// At any position, on the plate or beside it. Throws Error(Usage) and Error(Invalid) for an
/// invalid scale or box.
PlateMap mapToPlate(const WorldBox& model, const PrinterSettings& printer,
                    const PlaceOptions& options);

/// The same; throws Error(Limit), with the sizes, for a model that does not fit on the plate.
PlateMap placeOnPlate(const WorldBox& model, const PrinterSettings& printer,
                      const PlaceOptions& options);

/// The frame of a printer's images for a model up to a height of `top` millimetres: as many layers
/// as contain a part of it (Volume), or whose middle is below its top, at least one. A portrait
/// display has its sides exchanged. Throws Error(Limit) beyond 2^20 layers.
LayerFrame frameOf(const PrinterSettings& printer, double top, LayerShare share);

/// Whether the images of a printer show the plate mirrored, with rows counted from the top.
bool isMirrored(const PrinterSettings& printer);

/// Maps a point on the plate, in millimetres, to x and y in pixels of the image: seen from above,
/// row 0 is at the plate's largest y; a portrait display is rotated by 90 degrees to the right and
/// mirrored; then the image is mirrored by the printer's setting. The same as PrusaSlicer's.
std::array<double, 2> pixelOf(const PrinterSettings& printer, double x, double y);

/// The place on the plate that pixelOf() maps to a column and row of the image.
std::array<double, 2> plateOf(const PrinterSettings& printer, double column, double row);

/// Maps points of a model to the plate, then to the image; limited to the frame, which they can
/// exceed after placeOnPlate() only by rounding. Contours stay in millimetres.
FrameFaces framedFaces(std::vector<Vec3d> points, std::vector<std::uint32_t> triangles,
                       const PlateMap& map, const PrinterSettings& printer, LayerShare share);

} // namespace tetvdb
