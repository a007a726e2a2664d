// SPDX-License-Identifier: Apache-2.0
//
// Inputs of a job that are not files: meshes and volumes in memory.
//
//   tetvdb::VoxelizeJob job;
//   job.inputs = {"cube"};
//   job.memory["cube"].triangles = [&] { return cube; };   // a tetvdb::TriangleMesh
#pragma once

#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/volume/Volume.h"

#include <functional>
#include <map>
#include <optional>
#include <string>

namespace tetvdb {

/// Exactly one member is set.
struct MemoryInput {
  /// Called once per run of a job, from the thread that runs it, while the job reads its inputs.
  /// The result is checked like a file's content. Its exceptions end the job.
  std::function<TriangleMesh()> triangles;
  std::function<CellMesh()> cells; ///< the same for meshes of solid cells
  std::optional<Volume> volume;    ///< is read and not changed
};

/// By the name that represents it among a job's inputs and in messages and reports. An input whose
/// name is not in the map is a file's path.
using MemoryInputs = std::map<std::string, MemoryInput>;

/// The input of that name; null if it is a file.
inline const MemoryInput* inMemory(const std::string& input, const MemoryInputs& memory) {
  const auto found = memory.find(input);
  return found == memory.end() ? nullptr : &found->second;
}

} // namespace tetvdb
