// SPDX-License-Identifier: Apache-2.0
//
// The writers of array formats, and their properties in the table of formats (io/Formats.h).
// writeArrays() chooses. Internal.
#pragma once

#include "tetvdb/core/Progress.h"

namespace tetvdb {

struct ArrayContent; // io/volume/arrays/ArrayWriters.h

/// What files of an array format can do: a sum of these.
namespace arrays {
constexpr unsigned kSeveral = 1;    ///< hold several grids
constexpr unsigned kCompressed = 2; ///< be compressed
constexpr unsigned kSparse = 4;     ///< hold coordinates and values
constexpr unsigned kMask = 8;       ///< hold only inside and outside, no values
} // namespace arrays

void writeNpy(const ArrayContent& content, Progress& progress);
void writeNpz(const ArrayContent& content, Progress& progress);
void writeVti(const ArrayContent& content, Progress& progress);
void writeNrrd(const ArrayContent& content, Progress& progress);
void writeHdf5(const ArrayContent& content, Progress& progress);
void writeTiff(const ArrayContent& content, Progress& progress);
void writeRaw(const ArrayContent& content, Progress& progress);
void writeBinvox(const ArrayContent& content, Progress& progress);

} // namespace tetvdb
