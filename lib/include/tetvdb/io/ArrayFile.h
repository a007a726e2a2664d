// SPDX-License-Identifier: Apache-2.0
//
// Writes volumes as dense arrays, for programs that do not read OpenVDB, and reads such arrays.
//
//   tetvdb::ArrayOptions options;
//   options.compress = true;
//   tetvdb::writeArrays("a.npz", volume, options, progress);
//   const tetvdb::Volume same = tetvdb::readArrays("a.npz", {}, progress);
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

/// How arrays become grids; what is empty, the file decides.
struct ArrayInput {
  std::optional<Vec3d> voxelSize; ///< world units
  std::optional<Vec3d> origin;    ///< world units: the centre of voxel (0, 0, 0)
  bool zSlowest = false; ///< of files without a transform (.npy, .npz): [z][y][x], not [x][y][z]
  /// The value of inactive voxels: 0, and the largest value of an array that is cut off like a
  /// level set.
  std::optional<double> background;
  /// Of a .tif: further files, whose pages follow.
  std::vector<std::string> pages;
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

/// The box that writeArrays() takes where the options have none; empty where no voxel is active.
VoxelBox arrayBoxOf(const Volume& volume);

/// Writes the grids of a volume in the format of the path's extension; docs/formats.md has the
/// order of axes and the names of each. Whole or absent. Processes several planes at a time: memory
/// does not depend on the array's size. Throws Error(Usage) as checkArrayOptions() does, for grids
/// of several transforms, for a transform or a type that the format cannot represent;
/// Error(Invalid) if no voxel is active and no box is given, Error(Limit) if the disk or the format
/// is too small, before anything is written; Error(Write), Error(Cancelled).
void writeArrays(const std::string& path, const Volume& volume, const ArrayOptions& options,
                 Progress& progress);

/// Reads a file of dense arrays, by content, into sparse grids: a voxel is active if its value is
/// not the background. Numbers become float grids, integers of 32 and 64 bits int32 and int64,
/// booleans and bytes of 0 and 1 masks, three components vectors, other components grids of their
/// own, NAME_0 and so on. A float array is a level set if a tenth of its voxels (of an array named
/// "surface" one) is at its largest value or the negative of it, none is further from 0 and none at
/// the sides of its box is negative; other floats are fog. An array without a name is "density",
/// "mask", "vector" or "surface". NaN is inactive, and counted in Volume::notNumbers; arrays that
/// are not of voxels are in Volume::unread. Memory: the trees, and one array where the file has it
/// compressed. Parallel; a few ns a voxel. Throws Error(Invalid) for files that are damaged or hold
/// no array of voxels, Error(Usage) for options that the file has no use for, Error(Limit) for
/// arrays beyond voxel 2^30, Error(Cancelled).
Volume readArrays(const std::string& path, const ArrayInput& options, Progress& progress);

} // namespace tetvdb
