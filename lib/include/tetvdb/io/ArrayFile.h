// SPDX-License-Identifier: Apache-2.0
//
// Volumes as dense arrays, for programs that do not read OpenVDB.
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
  bool sparse = false;   ///< coordinates and values of active voxels in place of the dense array
  bool compress = false; ///< deflate
  /// The voxels of the array, index space. None: the cube (0, 0, 0) to (N - 1, N - 1, N - 1) where
  /// the volume's metadata "fit" is N, else the box of the active voxels of all grids.
  std::optional<VoxelBox> box;
};

/// Whether the path's extension, in any case, is that of an array format.
bool isArrayFile(const std::string& path);

/// ".npy, .npz, ... or .binvox".
std::string arrayEndings();

/// Whether files of the path's format hold the inside of a solid alone, so that a mask is what they
/// are made of.
bool isMaskFile(const std::string& path);

/// All files that writeArrays() makes for `path`: it, and for .raw its header.
std::vector<std::string> arrayFiles(const std::string& path);

/// Throws Error(Usage) where the path's format has no place for what the options ask for or for
/// that many grids, naming formats that have.
void checkArrayOptions(const std::string& path, const ArrayOptions& options, std::size_t grids);

/// Throws Error(Limit), with the number of bytes, where the disk of `path` has too little room for
/// that many, compressed at the best that deflate can do where `compress` is set. Devices and pipes
/// have room for all.
void requireRoom(const std::string& path, double bytes, bool compress);

/// Writes the grids of a volume in the format of the path's extension; docs/formats.md has the
/// order of axes and the names of each. Whole or absent. Some planes at a time: memory does not
/// grow with the array. Throws Error(Usage) as checkArrayOptions() does, for grids of several
/// transforms, for a transform or a type that the format cannot express; Error(Invalid) where no
/// voxel is active and no box is given, Error(Limit) for what the disk or the format has no place
/// for, before anything is written; Error(Write), Error(Cancelled).
void writeArrays(const std::string& path, const Volume& volume, const ArrayOptions& options,
                 Progress& progress);

} // namespace tetvdb
