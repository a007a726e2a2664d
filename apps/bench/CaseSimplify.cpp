// SPDX-License-Identifier: Apache-2.0
//
// Fewer triangles within a tolerance, against OpenMesh's own decimater: case simplify.
#include "Cases.h"
#include "OpenMeshDecimater.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/SimplifySurface.h"

#include <filesystem>
#include <fmt/format.h>
#include <tbb/task_arena.h>

namespace tetvdb::bench {
namespace {

constexpr double kTolerance = 5e-4; ///< of the diagonal

void compare(const std::string& name, const TriangleMesh& mesh, const Setup& setup,
             Tables& tables) {
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  SimplifyOptions options;
  options.tolerance = kTolerance * length(minus(box.high, box.low));
  std::size_t ours = 0, theirs = 0;
  const std::vector<Times> times =
      interleave({{"ours",
                   [&] {
                     TriangleMesh made = mesh;
                     Progress progress;
                     const double start = userSeconds();
                     tbb::task_arena(1).execute([&] { simplifySurface(made, options, progress); });
                     ours = made.triangleCount();
                     return userSeconds() - start;
                   }},
                  {"OpenMesh's DecimaterT",
                   [&] {
                     double seconds = 0;
                     theirs = decimateByOpenMesh(mesh, options.tolerance, &seconds);
                     return seconds;
                   }}},
                 setup.rounds(3), false);
  Row row;
  row.what = fmt::format("{}, {} triangles", name, mesh.triangleCount());
  row.peerName = "OpenMesh's DecimaterT";
  row.ours = times[0];
  row.peer = times[1];
  row.note = fmt::format("{} triangles left, by the peer {}", ours, theirs);
  tables.add(row);
}

} // namespace

void runSimplify(const Setup& setup, Tables& tables) {
  tables.begin("simplify",
               fmt::format("Triangles merged within {} of the diagonal: user CPU seconds, one "
                           "thread. OpenMesh's own Hausdorff module holds the peer's tolerance.",
                           kTolerance));
  for (const std::string& path : setup.meshes) {
    Report report;
    Progress progress;
    TriangleMesh mesh = readTriangles(path, report, progress);
    cleanTriangles(mesh, {}, progress);
    compare(std::filesystem::path(path).stem().string(), mesh, setup, tables);
  }
  if (setup.meshes.empty())
    compare("bumpy sphere", bumpySphere(1e5 / setup.shrink), setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
