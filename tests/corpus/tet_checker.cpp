// SPDX-License-Identifier: Apache-2.0
//
// Judges tets that were made from triangles.
//
//   tet_checker MESH INPUT EPSILON [SURFACE_SAMPLES [WINDING_SAMPLES [OVERLAP_SAMPLES]]]
//
// Reads tets of any format and triangles, cleans these, prints what tetrahedralize/TetMeshCheck.h
// finds as one line of JSON. Where some tets have a region above 0, those that have none are
// outside: formats lose a region of -1. Exit status: 0 valid, 1 not, 2 usage, or what the library's
// errors say.
#include "tetrahedralize/TetMeshCheck.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  const double epsilon = argc > 3 ? std::atof(argv[3]) : 0;
  if (argc < 4 || argc > 7 || !(epsilon > 0)) {
    std::fprintf(stderr, "usage: tet_checker MESH INPUT EPSILON [SURFACE_SAMPLES "
                         "[WINDING_SAMPLES [OVERLAP_SAMPLES]]]\n");
    return 2;
  }
  tetvdb::TetCheckSamples samples;
  std::size_t* const counts[] = {&samples.surface, &samples.winding, &samples.overlap};
  for (int i = 4; i < argc; ++i)
    *counts[i - 4] = std::strtoull(argv[i], nullptr, 10);
  try {
    tetvdb::Progress progress;
    tetvdb::Report report;
    tetvdb::TetMesh mesh =
        tetvdb::splitCells(tetvdb::readCells(argv[1], {}, report, progress), {}, report, progress);
    if (std::any_of(mesh.regions.begin(), mesh.regions.end(),
                    [](int region) { return region > 0; }))
      for (std::int32_t& region : mesh.regions)
        region = region > 0 ? region : -1;
    tetvdb::TriangleMesh input = tetvdb::readTriangles(argv[2], report, progress);
    tetvdb::cleanTriangles(input, {}, progress);
    const tetvdb::TetMeshCheck check = tetvdb::checkTetMesh(mesh, input, epsilon, samples);
    std::printf("%s\n", check.json().c_str());
    return check.faults().empty() ? 0 : 1;
  } catch (const tetvdb::Error& error) {
    std::fprintf(stderr, "tet_checker: %s\n", error.what());
    return static_cast<int>(error.status());
  }
}
