// SPDX-License-Identifier: Apache-2.0
//
// A model's arrays as an HDF5 file, and files of several models as one.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/pipeline/dataset/ArrayChunks.h"

#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// A dataset an array, deflated in chunks; booleans as h5py has them. The file's attributes are
/// those given, that of an array of voxels its `transform`. The bytes depend on the arguments
/// alone: no times are kept. Whole or absent; throws Error(Write). Not thread-safe: the HDF5
/// library is not.
void writeHdf5Arrays(const std::string& path, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about);

/// One file of several: a group each of the name given, '/' between groups, with all that the file
/// holds. `members`: name and path. The bytes depend on names and files alone. Whole or absent;
/// throws Error(Invalid) for a member that is no HDF5 file, Error(Write).
void joinHdf5Files(const std::string& path,
                   const std::vector<std::pair<std::string, std::string>>& members,
                   Progress& progress);

} // namespace tetvdb
