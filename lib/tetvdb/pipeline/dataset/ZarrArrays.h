// SPDX-License-Identifier: Apache-2.0
//
// A model's arrays as a zarr store: a folder of format version 2, which every reader knows.
// https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html
#pragma once

#include "tetvdb/pipeline/dataset/ArrayChunks.h"

#include <string>
#include <vector>

namespace tetvdb {

/// The group `folder` with an array each, chunks deflated by zlib, booleans a byte each; chunks of
/// zeros alone are left out, as the fill value is 0. The group's attributes are those given, that
/// of an array of voxels its `transform`. Made under another name beside it and renamed: whole or
/// absent; a store that is there is replaced. Throws Error(Write).
void writeZarrArrays(const std::string& folder, const std::vector<NamedArray>& arrays,
                     const ArrayAttributes& about);

/// Makes `root` a group with all groups on the way to `stores`, which are paths within it, and
/// writes the metadata of all into .zmetadata, so that a reader opens it by one file. Files are
/// whole or absent. Throws Error(Write), and Error(Invalid) for a store that is not there.
void joinZarrStores(const std::string& root, const std::vector<std::string>& stores);

} // namespace tetvdb
