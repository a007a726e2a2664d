// SPDX-License-Identifier: Apache-2.0
//
// Reading through a library that crashes on damaged files.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"

#include <functional>
#include <string>

namespace tetvdb {

/// Calls `read` in a child process and returns its mesh; its warnings go to `report`. An Error that
/// it throws is thrown here; where the child dies, Error(Invalid) for `path`. The child has a
/// Progress of its own and is killed when `progress` is cancelled. `read` must not need other
/// threads.
CellMesh readIsolated(const std::function<CellMesh(Report&, Progress&)>& read,
                      const std::string& path, Report& report, Progress& progress);

} // namespace tetvdb
