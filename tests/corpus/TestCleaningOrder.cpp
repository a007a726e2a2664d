// SPDX-License-Identifier: Apache-2.0
//
// The solid of a file has nothing to do with the order in which it lists points and faces: every
// triangle file of the corpus, as it is and shuffled, at a coarse resolution. The folder that holds
// tri/ is named by the environment variable TETVDB_CORPUS.
#include "TriangleMeshes.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxFaces = 60000;
constexpr int kResolution = 24;

// Points and faces in another order, faces from another corner.
TriangleMesh shuffled(const TriangleMesh& mesh) {
  meshes::Random random(17);
  TriangleMesh result = meshes::shuffledFaces(mesh, 17);
  std::vector<std::uint32_t> place(mesh.points.size());
  std::iota(place.begin(), place.end(), 0u);
  for (std::size_t i = place.size(); i > 1; --i)
    std::swap(place[i - 1], place[random.below(i)]);
  for (std::size_t i = 0; i < place.size(); ++i)
    result.points[place[i]] = mesh.points[i];
  for (std::uint32_t& corner : result.triangles)
    corner = place[corner];
  return result;
}

// The mask's hash and what was done; the reason where there is no solid.
std::string solidOf(TriangleMesh mesh) {
  Report report;
  Progress progress;
  try {
    const CleanCounts counts = cleanTriangles(mesh, {}, progress);
    VoxelizeOptions options;
    options.grids = {GridKind::Mask};
    options.resolution = kResolution;
    const Voxelization made = voxelize(mesh, {}, options, report, progress);
    return hash(made.volume) + " flipped " + std::to_string(counts.flippedFaces) + " duplicates " +
           std::to_string(counts.duplicateFaces) + " doubtful " + std::to_string(counts.doubtful);
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(CleaningOrder, ShufflingTheCorpusChangesNoSolid) {
  const char* corpus = std::getenv("TETVDB_CORPUS");
  if (corpus == nullptr)
    GTEST_SKIP() << "TETVDB_CORPUS is not set";
  int compared = 0;
  for (const auto& file : std::filesystem::directory_iterator(std::string(corpus) + "/tri")) {
    SCOPED_TRACE(file.path().filename().string());
    Report report;
    Progress progress;
    TriangleMesh mesh;
    try {
      mesh = readTriangles(file.path().string(), report, progress);
    } catch (const Error&) {
      continue;
    }
    if (mesh.triangleCount() > kMaxFaces)
      continue;
    EXPECT_EQ(solidOf(shuffled(mesh)), solidOf(mesh));
    ++compared;
  }
  EXPECT_GT(compared, 140);
}

} // namespace
} // namespace tetvdb
