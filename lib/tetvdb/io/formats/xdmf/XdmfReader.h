// SPDX-License-Identifier: Apache-2.0
//
// XDMF 2 and 3 (.xdmf, .xmf): XML that describes meshes and arrays, with numbers in the XML, in
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

class SpooledMesh;

/// Combines the uniform grids of the first domain: all of spatial collections and trees, of
/// temporal collections the step options.timeStep (the last if it is -1). Grids with the same
/// topology (by reference or XInclude) are one mesh with the attributes of all, as FEniCS writes
/// one temporal collection per function; grids of the domain with other cells on the points of
/// another grid are omitted with a warning (FEniCS' mesh tags). Files are searched at the names
/// in the XML, relative to the .xdmf file; HDF5 is read by a child process
/// (io/formats/xdmf/Hdf5Arrays.h). Throws Error(Invalid) for an incomplete mesh, for structured
/// grids and for data items that are functions; Error(Usage) for a time step that does not
/// exist.
CellMesh readXdmf(const Source& source, const ReadOptions& options, Report& report,
                  Progress& progress);

/// By the types of the topologies; of a mixed one the cells are read. Throws as readXdmf() does.
bool xdmfHasSolidCells(const Source& source, Report& report, Progress& progress);

/// The same, part by part, of one mesh of linear cells whose numbers lie in HDF5 files; others are
/// Error(Invalid). Memory: some million numbers, and what HDF5 needs for a chunk of a dataset.
void spoolXdmf(const Source& source, const ReadOptions& options, SpooledMesh& mesh, Report& report,
               Progress& progress);

/// The times of the steps: those of the first temporal collection, counted from 0 if it has none;
/// empty without a temporal collection. Throws as readXdmf() does.
std::vector<double> xdmfTimes(const Source& source);

/// The names of the files with its numbers, without repetition, whether or not they exist.
std::vector<std::string> xdmfFiles(const Source& source);

} // namespace tetvdb
