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

/// Optional processing of a closed manifold surface.
struct FinishOptions {
  RelativeLength smooth; ///< as SmoothOptions::distance; 0: not smoothed
  std::size_t faces = 0; ///< as SimplifyOptions::faces; 0: no limit
  RelativeLength error;  ///< as SimplifyOptions::tolerance; 0 without faces: not simplified

  bool isAsked() const { return smooth.value > 0 || faces > 0 || error.value > 0; }
};

struct FinishResult {
  std::optional<SmoothCounts> smoothed;
  bool simplified = false;
  std::size_t facesBefore = 0; ///< before simplification
  double distance = 0;         ///< measured maximum, both directions (CompareMeshes.h)
};

/// Smooths, then simplifies, preserving feature edges. Adds stages "smooth" and "simplify" to
/// `report`. If more faces remain than requested, adds the warning `faces-not-reached`, and the
/// report is partial. Throws the errors of smoothSurface() and simplifySurface().
FinishResult finishSurface(TriangleMesh& mesh, const FinishOptions& options, Report& report,
                           Progress& progress);

} // namespace tetvdb
