// SPDX-License-Identifier: Apache-2.0
//
// What a Python call gives as inputs, as inputs of a job: paths, and meshes and volumes in memory.
// The Python side (tetvdb/_inputs.py) has told apart whatever object came.
#pragma once

#include "tetvdb/pipeline/MemoryInput.h"

#include <nanobind/nanobind.h>
#include <string>
#include <vector>

namespace tetvdb::python {

namespace nb = nanobind;

struct Inputs {
  std::vector<std::string> names; ///< paths, or keys of `memory`
  MemoryInputs memory;
};

/// Of a list of tuples:
///   ("file", path)
///   ("triangles", name, points, faces)                      arrays (N, 3) and (M, 3)
///   ("tets", name, points, tets, point_data, cell_data)     arrays (N, 3) and (M, 4)
///   ("cells", name, points, types, ends, nodes, point_data, cell_data)
///       VTK's cell types, where each cell ends in `nodes`
///   ("volume", name, Volume)
/// Data are dicts from names to arrays, or None. Arrays are NumPy's or have __dlpack__, on the CPU,
/// of any layout; they are kept alive and are read when the job runs, straight into the mesh.
/// Throws Error(Usage) for arrays of other shapes and types.
Inputs inputsOf(const nb::list& given);

/// Whether an input is a volume: in memory, or a file by its first bytes.
bool isVolume(const std::string& name, const MemoryInputs& memory);

} // namespace tetvdb::python
