// SPDX-License-Identifier: Apache-2.0
//
// XDMF 2 and 3 (.xdmf, .xmf): XML that describes meshes and arrays, whose numbers lie in it, in
// binary files or in HDF5 files beside it.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/ReadOptions.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/CellMesh.h"

#include <string>
#include <vector>

namespace tetvdb {

/// The uniform grids of the first domain, of spatial collections and trees all, of temporal
/// collections the step options.timeStep (the last where that is -1), laid together. Grids with the
/// same topology (by reference or XInclude) are one mesh with the attributes of all, as FEniCS
/// writes one temporal collection a function; grids of the domain with other cells on the points of
/// another grid are left out with a warning (FEniCS' mesh tags). Files are looked for where the
/// XML's names say, beside the .xdmf file where these are relative; HDF5 is read by a child process
/// (io/formats/xdmf/Hdf5Arrays.h).
/// Throws Error(Invalid) for whatever is not a whole mesh, for structured grids and for data items
/// that are functions; Error(Usage) for a time step that the file does not have.
CellMesh readXdmf(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// The times of the steps: those of the first temporal collection, counted from 0 where it has
/// none; empty where there is no temporal collection. Throws as readXdmf() does.
std::vector<double> xdmfTimes(const Source& source);

/// The files beside that hold its numbers, by name, each once; whether they exist or not.
std::vector<std::string> xdmfFiles(const Source& source);

} // namespace tetvdb
