// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/RelativeLength.h"
#include "tetvdb/surface/SmoothSurface.h"

#include <cstddef>
#include <optional>

namespace tetvdb {

/// What is done to a surface that is closed and manifold, if it is asked for.
struct FinishOptions {
  RelativeLength smooth; ///< as SmoothOptions::distance; 0: not smoothed
  std::size_t faces = 0; ///< as SimplifyOptions::faces; 0: no number
  RelativeLength error;  ///< as SimplifyOptions::tolerance; 0 without faces: not simplified

  bool isAsked() const { return smooth.value > 0 || faces > 0 || error.value > 0; }
};

struct FinishResult {
  std::optional<SmoothCounts> smoothed;
  bool simplified = false;
  std::size_t facesBefore = 0; ///< simplification
  double distance = 0; ///< largest, both ways, from before to after: measured (CompareMeshes.h)
};

/// Smooths, then simplifies, with feature edges kept. Adds stages "smooth" and "simplify" to
/// `report`; where more faces are left than asked for, warning `faces-not-reached`, and the report
/// is partial. Throws what smoothSurface() and simplifySurface() throw.
FinishResult finishSurface(TriangleMesh& mesh, const FinishOptions& options, Report& report,
                           Progress& progress);

} // namespace tetvdb
