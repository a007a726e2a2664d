// SPDX-License-Identifier: Apache-2.0
//
// What will fail when layers are printed, where and how large.
//
//   tetvdb::PrintChecks checks = tetvdb::checkLayers(source, limits, progress);
//   for (const tetvdb::PrintFinding& f : checks.findings) ...
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/print/LayerSource.h"
#include "tetvdb/print/PrintFindings.h"

namespace tetvdb {

/// One sweep over the layers from below. A pixel is solid where its level is 128 or more, and
/// connected with the pixel below and above, and in its layer by `neighbours`; void has the
/// complementary neighbours in a layer.
///
/// Overhang: a pixel whose centre is farther from the centres of all solid pixels of the layer
/// below than h tan(angle) and half a pixel's diagonal, with h the layers' distance; islands have
/// none in their first layers. Thickness is looked at in every n-th layer, with n the largest
/// number whose height is a quarter of the limit. The result does not depend on the number of
/// threads. Memory: 32 layers' spans, the components of two layers, the findings, and for drains
/// about a span for every row of eighths of the drain. Throws Error(Usage) for limits that make no
/// sense, Error(Cancelled).
PrintChecks checkLayers(LayerSource& source, const PrintLimits& limits, Progress& progress);

} // namespace tetvdb
