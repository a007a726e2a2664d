// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/ChooseMesher.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/TriangleWriter.h"

#include <algorithm>

namespace tetvdb {
namespace {

bool asksForGrid(const VoxelizeJob& job, GridKind kind) {
  return job.makesVolume() && contains(job.grids, kind);
}

bool asksForTetFile(const VoxelizeJob& job) {
  return !job.meshOutput.empty() && !writesTriangles(job.meshOutput);
}

// The option that requires tets; empty if there is none.
std::string tetsFor(const VoxelizeJob& job) {
  if (asksForGrid(job, GridKind::TetId))
    return "`grid=tet_id`";
  if (asksForTetFile(job))
    return "`write_mesh=" + job.meshOutput + "`";
  return job.epsilon.value > 0 ? "`epsilon`" : "";
}

// The option that requires a method without tets; empty if there is none.
std::string noTetsFor(const VoxelizeJob& job) {
  if (job.solid.shell > 0)
    return "`shell`";
  return job.solid.inside == InsideRule::Winding ? "" : "`inside`";
}

} // namespace

std::string nameOf(Mesher mesher) {
  constexpr const char* kNames[] = {"auto", "envelope", "winding"};
  return kNames[static_cast<std::size_t>(mesher)];
}

bool needsTets(const VoxelizeJob& job) {
  return asksForGrid(job, GridKind::TetId) || asksForTetFile(job);
}

void checkMesher(const VoxelizeJob& job) {
  const std::string tets = tetsFor(job), without = noTetsFor(job);
  if (job.mesher == Mesher::Winding) {
    if (!tets.empty())
      throw Error(Status::Usage, tets,
                  "requires tets, which `mesher=" + nameOf(job.mesher) + "` does not make",
                  "use `mesher=envelope`");
    return;
  }
  if (without.empty())
    return;
  if (!tets.empty())
    throw Error(Status::Usage, tets, "requires tets, which " + without + " does not make",
                "leave one of them out");
  if (job.mesher == Mesher::Envelope)
    throw Error(Status::Usage, without, "cannot be combined with `mesher=envelope`",
                "use `mesher=winding`");
}

MesherChoice chooseMesher(const VoxelizeJob& job, double diagonal, const Vec3d& voxelSize) {
  const double voxel = std::min({voxelSize[0], voxelSize[1], voxelSize[2]});
  const double half = voxel / 2;
  const double epsilon = job.epsilon.value > 0 ? job.epsilon.inWorld(diagonal, voxel) : half;
  if (job.mesher == Mesher::Envelope)
    return {Mesher::Envelope, "asked for", epsilon};
  if (job.mesher == Mesher::Winding)
    return {Mesher::Winding, "asked for", 0};
  if (const std::string tets = tetsFor(job); !tets.empty())
    return {Mesher::Envelope, tets + " needs tets", epsilon};
  if (const std::string without = noTetsFor(job); !without.empty())
    return {Mesher::Winding, without + " needs no tets", 0};
  return {Mesher::Winding, "no output requires tets", 0};
}

} // namespace tetvdb
