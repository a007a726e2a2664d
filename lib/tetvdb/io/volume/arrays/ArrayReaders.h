// SPDX-License-Identifier: Apache-2.0
//
// The readers of array formats; readArrays() (io/ArrayFile.h) chooses. They check what a file
// declares against its size before they follow it, and pass its arrays to a sink, one at a time.
// Throw Error(Invalid) for damaged files, Error(Cancelled). Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/arrays/StoredArray.h"

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

void readNpy(const Source& source, const ArraySink& sink, Progress& progress);
void readNpz(const Source& source, const ArraySink& sink, Progress& progress);
void readVtkImage(const Source& source, const ArraySink& sink, Progress& progress);
void readVti(const Source& source, const ArraySink& sink, Progress& progress);
void readNrrd(const Source& source, const ArraySink& sink, Progress& progress);
void readHdf5Arrays(const Source& source, const ArraySink& sink, Progress& progress);
void readMetaImage(const Source& source, const ArraySink& sink, Progress& progress);
void readNifti(const Source& source, const ArraySink& sink, Progress& progress);
void readTiff(const Source& source, const ArraySink& sink, Progress& progress);
/// The pages of several files as those of one stack; at least one.
void readTiffs(const std::vector<Source>& sources, const ArraySink& sink, Progress& progress);
void readRaw(const Source& source, const ArraySink& sink, Progress& progress);
/// readRaw() with the text of the header, from the file `headerPath`.
void readRawArrays(std::string_view header, const std::string& headerPath, const Source& source,
                   const ArraySink& sink);
void readBinvox(const Source& source, const ArraySink& sink, Progress& progress);

} // namespace tetvdb
