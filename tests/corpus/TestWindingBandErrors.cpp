// SPDX-License-Identifier: Apache-2.0
//
// How far the winding numbers that WindingBand gives over the holes of real meshes are from the
// definition. Prints the rows of the table in docs/algorithms.md, section 8a. The folder that holds
// tri/ is named by the environment variable TETVDB_CORPUS.
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/pipeline/CleanInput.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"
#include "voxelize/WindingOracle.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kJudged = 1000; ///< voxels of a file, evenly spaced among those evaluated

struct EvaluatedVoxel {
  Vec3d place; ///< in index space
  double winding;
};

std::vector<EvaluatedVoxel> evaluated(const TriangleClusters& holes) {
  const Progress progress;
  const WindingBand band(holes, progress);
  std::vector<EvaluatedVoxel> voxels;
  test::forEvaluated(band, [&](const std::array<int, 3>& at, double winding) {
    voxels.push_back({{double(at[0]), double(at[1]), double(at[2])}, winding});
  });
  return voxels;
}

class WindingBandErrors : public testing::TestWithParam<const char*> {};

TEST_P(WindingBandErrors, AgainstTheDefinition) {
  const char* corpus = std::getenv("TETVDB_CORPUS");
  if (corpus == nullptr)
    GTEST_SKIP() << "TETVDB_CORPUS is not set";
  Report report;
  Progress progress;
  TriangleMesh mesh = readTriangles(std::string(corpus) + "/tri/" + GetParam(), report, progress);
  cleanInput(mesh, "", {}, report, progress);
  VoxelizeOptions options;
  options.resolution = 256;
  const SnappedMesh snapped = snapPoints(mesh.points, chooseTransform(mesh, options), progress);
  const SoupBoundary boundary = soupBoundary(mesh, progress);
  const std::vector<FillTriangle> holes = fillHoles(boundaryEdges(boundary.edges, snapped));
  const std::vector<EvaluatedVoxel> voxels = evaluated(TriangleClusters(holes));
  ASSERT_FALSE(voxels.empty());
  std::vector<double> errors;
  const std::size_t stride = std::max<std::size_t>(1, voxels.size() / kJudged);
  for (std::size_t i = 0; i < voxels.size(); i += stride)
    errors.push_back(std::abs(voxels[i].winding - test::windingOf(holes, voxels[i].place)));
  std::sort(errors.begin(), errors.end());
  std::printf("| %s | %zu | %zu | %zu | %.1e | %.1e | %.1e |\n", GetParam(), boundary.edges.size(),
              holes.size(), voxels.size(), errors[errors.size() / 2],
              errors[errors.size() * 99 / 100], errors.back());
  EXPECT_LT(errors.back(), kWindingBandError);
}

INSTANTIATE_TEST_SUITE_P(Corpus, WindingBandErrors,
                         testing::Values("trimesh__soup.stl", "libigl-tutorial-data__truck.obj",
                                         "modelnet_samples__bed_0002.off",
                                         "vcglib__abominevole.off"));

} // namespace
} // namespace tetvdb
