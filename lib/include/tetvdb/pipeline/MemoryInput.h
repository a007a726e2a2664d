// SPDX-License-Identifier: Apache-2.0
//
// Inputs of a job that are no files: meshes and volumes that the caller has in memory.
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

/// One of the three is set.
struct MemoryInput {
  /// Called once by every run of a job, from the thread that runs it, while the job reads its
  /// inputs. What it returns is checked as a file's content is. Throws what the job is to throw.
  std::function<TriangleMesh()> triangles;
  std::function<CellMesh()> cells; ///< the same for meshes of solid cells
  std::optional<Volume> volume;    ///< is read and not changed
};

/// By the name that stands for it among a job's inputs and in messages and reports. A name of an
/// input that is not in here is a file's path.
using MemoryInputs = std::map<std::string, MemoryInput>;

/// The input of that name; null where it is a file.
inline const MemoryInput* inMemory(const std::string& input, const MemoryInputs& memory) {
  const auto found = memory.find(input);
  return found == memory.end() ? nullptr : &found->second;
}

} // namespace tetvdb
