// SPDX-License-Identifier: Apache-2.0
//
// A solid ready to be cut into layers, and where it stands: what SliceJob writes and CheckPrintJob
// looks at.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/PlateMap.h"
#include "tetvdb/print/PrinterSettings.h"

#include <functional>
#include <memory>

namespace tetvdb {

struct OpenOptions {
  /// Called before the model is placed, with its box in millimetres, where it would stand by the
  /// job's place; may change both. The sizes of pixels and layers are used before that.
  std::function<void(const WorldBox& box, PrinterSettings& printer, PlaceOptions& place)> fit;
  bool keepMesh = false; ///< OpenedLayers::mesh
};

struct OpenedLayers {
  SliceResult result;      ///< of reading, cleaning and placing
  PrinterSettings printer; ///< of the frame
  PlateMap map;            ///< from the input's coordinates
  TriangleMesh mesh;       ///< in them, where it is kept and there is one
  std::unique_ptr<LayerSource> source;
};

/// As run() of a SliceJob up to its layers, whose output is not looked at. The job's printer must
/// have pixels, display and layer height. Throws what run() throws.
OpenedLayers openLayers(const SliceJob& job, const OpenOptions& options, Report& report,
                        Progress& progress);

} // namespace tetvdb
