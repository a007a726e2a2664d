// SPDX-License-Identifier: Apache-2.0
//
// The comparisons that can be asked for by name.
#pragma once

#include "Children.h"
#include "Results.h"
#include "SampleMeshes.h"
#include "Table.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <string>
#include <vector>

namespace tetvdb::bench {

struct Setup {
  int repeat = 7;      ///< rounds of a comparison; slow ones take fewer
  int threads = 0;     ///< of every rival that can use several
  int shrink = 1;      ///< --shrink N: meshes of about N times fewer tets, to try things out
  std::string folder;  ///< an empty one for temporary files
  std::string program; ///< the tetvdb program
  /// Files of triangles: of `triangles` instead of spheres made here, of `models`.
  std::vector<std::string> meshes;
  Launcher* launcher = nullptr;

  /// At most `max` rounds, for what takes long.
  int rounds(int max) const { return repeat < max ? repeat : max; }
};

/// A named comparison.
struct Case {
  const char* name;
  const char* about;
  void (*run)(const Setup& setup, Tables& tables);
  bool onlyByName; ///< too long or too large for a plain run
};

const std::vector<Case>& allCases();

void runOccupancy(const Setup&, Tables&);
void runOwners(const Setup&, Tables&);
void runFields(const Setup&, Tables&);
void runLarge(const Setup&, Tables&);
void runHuge(const Setup&, Tables&);
void runPaths(const Setup&, Tables&);
void runWrite(const Setup&, Tables&);
void runWrite5M(const Setup&, Tables&);
void runRead(const Setup&, Tables&);
void runTriangles(const Setup&, Tables&);
void runReadTriangles(const Setup&, Tables&);
void runLevelSet(const Setup&, Tables&);
void runCoverage(const Setup&, Tables&);
void runRules(const Setup&, Tables&);
void runRender(const Setup&, Tables&);
void runTets(const Setup&, Tables&);
void runResolution(const Setup&, Tables&);
void runMesher(const Setup&, Tables&);
void runModels(const Setup&, Tables&);
void runSimplify(const Setup&, Tables&);
void runCentroid(const Setup&, Tables&);

/// What `triangles` has done in a process of its own, to see its memory: nothing, mask or
/// meshToVolume; the mesh's name; resolution; --shrink; threads. Returns the exit status.
int trianglesChild(const std::vector<std::string>& words);

// What the cases share.

/// "10^7" or "1.2e6".
std::string countName(double count);

/// A mesh of N times fewer tets goes with a grid of N times fewer voxels.
int shrunk(int resolution, const Setup& setup);

/// voxelize() as a rival: timed as its stage is, the tree freed afterwards. `last` receives the
/// last run's volume statistics if given.
struct OursResult {
  std::uint64_t activeVoxels = 0;
  std::uint64_t bytes = 0;
  OccupancyPath path = OccupancyPath::Tets;
  std::vector<StagePart> parts;
};
double timeOurs(const TetMesh& mesh, const VoxelizeOptions& options, OursResult* last = nullptr);

/// Indices, points and the finished tree: each has to pass through memory once.
double floorBytes(const TetMesh& mesh, double outputBytes);

} // namespace tetvdb::bench
