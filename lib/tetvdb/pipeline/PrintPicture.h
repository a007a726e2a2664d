// SPDX-License-Identifier: Apache-2.0
//
// A picture of a model with the findings of a print check.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/visualize/Image.h"

namespace tetvdb {

/// Draws `mesh`, in the input's coordinates, from above and from below, with a box around each
/// finding in the colour of its kind: full if it is visible, paler if the model hides it. At most
/// the 200 largest of each kind. The kinds and their counts are listed below. 1520 x 760 pixels.
Image printPicture(TriangleMesh mesh, const CheckPrintResult& result, Progress& progress);

} // namespace tetvdb
