// SPDX-License-Identifier: Apache-2.0
//
// Files of triangles as their separate objects.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/pipeline/ReadInput.h"

#include <string>
#include <vector>

namespace tetvdb {

/// Reads one file of triangles, or triangles in `memory`: for .3mf every mesh of its build, with
/// its name; for other formats one object named by the file without folder and ending. Assemblies
/// are numbered from `firstAssembly`. `info` as for readSoup(). Warnings and errors name the
/// file.
std::vector<NamedMesh> readObjects(const std::string& path, std::size_t firstAssembly,
                                   InputInfo* info, Report& report, Progress& progress,
                                   const MemoryInputs& memory = {});

/// All faces in one mesh, without merging points; the units are those of the first object.
TriangleMesh joinObjects(const std::vector<NamedMesh>& objects);

/// Whether a format, by the path's ending, stores separate objects: .3mf.
bool keepsObjects(const std::string& path);

/// The number of metres of a unit, by the names of TriangleMesh::units or the abbreviations um, mm,
/// cm, m, in and ft; 0 for others. `name`, unless null, is set to the name.
double metresOf(const std::string& unit, std::string* name = nullptr);

} // namespace tetvdb
