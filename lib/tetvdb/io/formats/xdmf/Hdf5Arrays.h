// SPDX-License-Identifier: Apache-2.0
//
// Datasets of HDF5 files as arrays of numbers.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/Hdf5File.h"
#include "tetvdb/io/source/IsolatedRead.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct Hdf5Dataset {
  std::string file;
  std::string path;    ///< within the file: "/Mesh/geometry"
  bool sliced = false; ///< read only `slab`
  Slab slab;           ///< with the number of dimensions of the dataset
  std::size_t min = 0; ///< required numbers; fewer are an error
};

/// Reads the datasets, in their order, each of numbers of at most 64 bits (8- and 16-bit integers
/// and unsigned ones are widened as in mesh/Attribute.h). Runs in a child process with limits of
/// memory and time, since the HDF5 library crashes on damaged files. Links to other files and
/// plugins are not followed, and datasets must not be larger than their file can hold after
/// decompression. `path` is for messages. Throws Error(Invalid), Error(Limit), Error(Cancelled).
NumberArrays readHdf5(const std::vector<Hdf5Dataset>& datasets, const std::string& path,
                      Report& report, Progress& progress);

/// The lengths of a dataset's dimensions, read likewise.
std::vector<std::uint64_t> hdf5Shape(const Hdf5Dataset& dataset, const std::string& path,
                                     Report& report, Progress& progress);

} // namespace tetvdb
