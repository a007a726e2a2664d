// SPDX-License-Identifier: Apache-2.0
//
// A model with what a check of its print has found, to look at.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/visualize/Image.h"

namespace tetvdb {

/// `mesh`, in the input's coordinates, from above and from below, with a box around each finding in
/// its kind's colour: full where it is in view, paler where the model hides it. Of each kind the
/// largest 200. The kinds and how many there are of each stand below. 1520 x 760 pixels.
Image printPicture(TriangleMesh mesh, const CheckPrintResult& result, Progress& progress);

} // namespace tetvdb
