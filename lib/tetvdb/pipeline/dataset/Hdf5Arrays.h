// SPDX-License-Identifier: Apache-2.0
//
// Writes a model's arrays to an HDF5 file, and joins the files of several models.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/pipeline/dataset/ArrayChunks.h"

#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// Writes one dataset an array, deflated in chunks, with booleans as h5py stores them. The file
/// gets the given attributes, an array of voxels the attribute `transform`. The bytes depend only
/// on the arguments: no times are stored. The file is whole or absent. Throws Error(Write). Not
/// thread-safe: the HDF5 library is not.
void writeHdf5Arrays(const std::string& path, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about);

/// Joins several files: each becomes a group of the given name, with '/' between groups. `members`:
/// name and path. The bytes depend only on names and files. The file is whole or absent. Throws
/// Error(Invalid) for a member that is no HDF5 file, and Error(Write).
void joinHdf5Files(const std::string& path,
                   const std::vector<std::pair<std::string, std::string>>& members,
                   Progress& progress);

} // namespace tetvdb
