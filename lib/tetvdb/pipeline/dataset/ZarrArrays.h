// SPDX-License-Identifier: Apache-2.0
//
// Writes a model's arrays as a zarr store: a folder of format version 2, which every reader
// supports. https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html
#pragma once

#include "tetvdb/pipeline/dataset/ArrayChunks.h"

#include <string>
#include <vector>

namespace tetvdb {

/// Writes the group `folder` with one array each, chunks deflated by zlib, booleans as one byte
/// each. Chunks that hold only zeros are left out, since the fill value is 0. The group gets the
/// given attributes, an array of voxels the attribute `transform`. The store is written under
/// another name and renamed: it is whole or absent, and an existing store is replaced. Throws
/// Error(Write).
void writeZarrArrays(const std::string& folder, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about);

/// Makes `root` a group, with all groups between it and `stores`, which are paths within it, and
/// writes the metadata of all into .zmetadata, so that a reader needs to open only that file. Files
/// are whole or absent. Throws Error(Write), and Error(Invalid) for a store that is not there.
void joinZarrStores(const std::string& root, const std::vector<std::string>& stores);

} // namespace tetvdb
