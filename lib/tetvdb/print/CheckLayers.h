// SPDX-License-Identifier: Apache-2.0
//
// Finds features that fail when layers are printed, with position and size.
//
//   tetvdb::PrintChecks checks = tetvdb::checkLayers(source, limits, progress);
//   for (const tetvdb::PrintFinding& f : checks.findings) ...
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/PrintFindings.h"

namespace tetvdb {

/// One sweep over the layers from below. A pixel is solid if its level is 128 or more, and is
/// connected to the pixels below and above, and in its layer by `neighbours`; void has the
/// complementary neighbours in a layer.
///
/// Overhang: a pixel whose centre is farther from the centres of all solid pixels of the layer
/// below than h tan(angle) plus half a pixel's diagonal, with h the layer distance; islands have
/// none in their first layers. Thickness is measured in every n-th layer, with n the largest number
/// whose height is at most a quarter of the limit. The result does not depend on the number of
/// threads. Memory: 32 layers' spans, the components of two layers, the findings, and for drains
/// about one span per row of eighths of the drain. Throws Error(Usage) for invalid limits,
/// Error(Cancelled).
PrintChecks checkLayers(LayerSource& source, const PrintLimits& limits, Progress& progress);

} // namespace tetvdb
