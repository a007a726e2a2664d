// SPDX-License-Identifier: Apache-2.0
//
// A placed solid, ready to be cut into layers: used by SliceJob and
// CheckPrintJob.
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
  /// Is called before the model is placed, with its box in millimetres at the position given by the
  /// job; may change both arguments. The sizes of pixels and layers are used before the call.
  std::function<void(const WorldBox& box, PrinterSettings& printer, PlaceOptions& place)> fit;
  bool keepMesh = false; ///< OpenedLayers::mesh
};

struct OpenedLayers {
  SliceResult result;      ///< of reading, cleaning and placing
  PrinterSettings printer; ///< of the frame
  PlateMap map;            ///< from the input's coordinates
  TriangleMesh mesh;       ///< in the input's coordinates, if it is kept and exists
  std::unique_ptr<LayerSource> source;
};

/// As run() of a SliceJob up to its layers; ignores its output. The job's printer must have pixels,
/// display and layer height. Throws the errors of run().
OpenedLayers openLayers(const SliceJob& job, const OpenOptions& options, Report& report,
                        Progress& progress);

} // namespace tetvdb
