// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Why there are no tets.
struct MesherStop {
  Status status = Status::Ok; ///< Cancelled: time; Limit: memory; Invalid: nothing inside
  std::string why;            ///< one clause
};

/// tetrahedralize() for a job that has another method: with half of the time that is left until the
/// progress's deadline, so that the other half serves that method. Nothing, and `stop`, where the
/// time or the memory does not suffice or nothing is inside; `report` then has the stage, but no
/// warnings of it. Throws Error(Cancelled) where the job was cancelled, and what else the mesher
/// throws.
std::optional<Tetrahedralization> meshWithinLimits(const std::vector<TriangleMesh>& inputs,
                                                   const TetrahedralizeOptions& options,
                                                   MesherStop& stop, Report& report,
                                                   Progress& progress);

} // namespace tetvdb
