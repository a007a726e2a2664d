// SPDX-License-Identifier: Apache-2.0
//
// Files of triangles as the objects that they keep apart.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/MeshPart.h"
#include "tetvdb/pipeline/ReadInput.h"

#include <string>
#include <vector>

namespace tetvdb {

/// Reads one file of triangles, or triangles in `memory`: of .3mf every mesh that its build places,
/// with its name; of other formats one object of the file's name without folder and ending.
/// Assemblies are numbered from `firstAssembly` on. `info` as of readSoup(). Warnings and errors
/// name the file.
std::vector<NamedMesh> readObjects(const std::string& path, std::size_t firstAssembly,
                                   InputInfo* info, Report& report, Progress& progress,
                                   const MemoryInputs& memory = {});

/// All faces in one mesh, points not joined; the units are the first object's.
TriangleMesh joinObjects(const std::vector<NamedMesh>& objects);

/// Whether a format, by the path's ending, keeps objects apart: .3mf.
bool keepsObjects(const std::string& path);

/// How many metres a unit has, by the names of TriangleMesh::units or the abbreviations um, mm, cm,
/// m, in and ft; 0 for others. `name`, unless null, becomes the name.
double metresOf(const std::string& unit, std::string* name = nullptr);

} // namespace tetvdb
