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

/// The reason why there are no tets.
struct MesherStop {
  Status status = Status::Ok; ///< Cancelled: time; Limit: memory; Invalid: nothing inside
  std::string why;            ///< one clause
};

/// tetrahedralize() for a job with an alternative method: limited to half of the time until the
/// progress's deadline, so that the other half remains for that method. Returns none, and sets
/// `stop`, if time or memory do not suffice or nothing is inside; `report` then has the stage, but
/// none of its warnings. Throws Error(Cancelled) if the job is cancelled, and the other errors of
/// the mesher.
std::optional<Tetrahedralization> meshWithinLimits(const std::vector<TriangleMesh>& inputs,
                                                   const TetrahedralizeOptions& options,
                                                   MesherStop& stop, Report& report,
                                                   Progress& progress);

} // namespace tetvdb
