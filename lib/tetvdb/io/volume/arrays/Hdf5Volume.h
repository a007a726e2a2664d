// SPDX-License-Identifier: Apache-2.0
//
// The arrays of voxels of an HDF5 file, read by a child process. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/IsolatedRead.h"
#include "tetvdb/io/source/Source.h"

namespace tetvdb {

/// All datasets of three to five dimensions, at most 64, in groups up to four deep. The first array
/// describes the others, int64: of each the bytes of its numbers in the file, its dimensions'
/// number and lengths, its name's length and bytes. The second has the attributes "transform", 16
/// numbers, and "origin", 3, of the file; it is empty if these are missing. Datasets of other
/// dimensions have 0 bytes and no array. Throws as readHdf5().
NumberArrays readHdf5Volume(const Source& source, Report& report, Progress& progress);

} // namespace tetvdb
