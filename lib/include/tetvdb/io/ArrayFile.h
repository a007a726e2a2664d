// SPDX-License-Identifier: Apache-2.0
//
// Writes volumes as dense arrays, for programs that do not read OpenVDB.
//
//   tetvdb::ArrayOptions options;
//   options.compress = true;
//   tetvdb::writeArrays("a.npz", volume, options, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/volume/VoxelBox.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct ArrayOptions {
  bool sparse = false;   ///< coordinates and values of active voxels instead of the dense array
  bool compress = false; ///< deflate
  /// The voxels of the array, index space. None: the cube (0, 0, 0) to (N - 1, N - 1, N - 1) if the
  /// volume's metadata "fit" is N, else the box of the active voxels of all grids.
  std::optional<VoxelBox> box;
};

/// Whether the path's extension, in any case, is that of an array format.
bool isArrayFile(const std::string& path);

/// ".npy, .npz, ... or .binvox".
std::string arrayEndings();

/// Whether files of the path's format contain only the inside of a solid, so that they are made
/// from a mask.
bool isMaskFile(const std::string& path);

/// All files that writeArrays() writes for `path`: the file, and for .raw its header.
std::vector<std::string> arrayFiles(const std::string& path);

/// Throws Error(Usage) if the path's format does not support the options or this number of grids;
/// the message names formats that do.
void checkArrayOptions(const std::string& path, const ArrayOptions& options, std::size_t grids);

/// Throws Error(Limit), with the number of bytes, if the disk of `path` has too little space for
/// them, assuming the best possible compression by deflate if `compress` is set. Devices and pipes
/// have no limit.
void requireRoom(const std::string& path, double bytes, bool compress);

/// Writes the grids of a volume in the format of the path's extension; docs/formats.md has the
/// order of axes and the names of each. Whole or absent. Processes several planes at a time: memory
/// does not depend on the array's size. Throws Error(Usage) as checkArrayOptions() does, for grids
/// of several transforms, for a transform or a type that the format cannot represent;
/// Error(Invalid) if no voxel is active and no box is given, Error(Limit) if the disk or the format
/// is too small, before anything is written; Error(Write), Error(Cancelled).
void writeArrays(const std::string& path, const Volume& volume, const ArrayOptions& options,
                 Progress& progress);

} // namespace tetvdb
