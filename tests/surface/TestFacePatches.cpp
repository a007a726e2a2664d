// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/surface/FacePatches.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <tbb/task_arena.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

bool isWhole(const std::uint32_t* v) {
  return v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
}

// Patches and components by walks over neighbours that a map of directed sides gives.
struct Walked {
  std::vector<std::uint32_t> patchOf, partOfFace;
  std::vector<std::uint8_t> against, orientable;
};

Walked walk(const TriangleMesh& mesh) {
  struct Side {
    std::uint32_t face;
    bool ascends;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> sides;
  const auto faces = static_cast<std::uint32_t>(mesh.triangleCount());
  const auto eachSide = [&](std::uint32_t face, const auto& visit) {
    const std::uint32_t* v = &mesh.triangles[3 * face];
    for (std::uint32_t k = 0; isWhole(v) && k < 3; ++k)
      visit(std::minmax(v[k], v[(k + 1) % 3]), v[k] < v[(k + 1) % 3]);
  };
  for (std::uint32_t face = 0; face < faces; ++face)
    eachSide(face, [&](const auto& edge, bool ascends) { sides[edge].push_back({face, ascends}); });

  Walked walked;
  walked.patchOf.assign(faces, EdgeTable::kNone);
  walked.partOfFace.assign(faces, EdgeTable::kNone);
  walked.against.assign(faces, 0);
  std::uint32_t parts = 0;
  for (std::uint32_t first = 0; first < faces; ++first) {
    if (!isWhole(&mesh.triangles[3 * first]))
      continue;
    for (const bool manifold : {true, false}) {
      std::vector<std::uint32_t>& label = manifold ? walked.patchOf : walked.partOfFace;
      if (label[first] != EdgeTable::kNone)
        continue;
      label[first] = manifold ? static_cast<std::uint32_t>(walked.orientable.size()) : parts++;
      if (manifold)
        walked.orientable.push_back(1);
      std::vector<std::uint32_t> queue{first};
      for (std::size_t i = 0; i < queue.size(); ++i)
        eachSide(queue[i], [&](const auto& edge, bool ascends) {
          const std::vector<Side>& around = sides[edge];
          if (manifold && around.size() != 2)
            return;
          for (const Side& other : around) {
            if (other.face == queue[i])
              continue;
            const bool against = (walked.against[queue[i]] != 0) != (other.ascends == ascends);
            if (label[other.face] == EdgeTable::kNone) {
              label[other.face] = label[first];
              if (manifold)
                walked.against[other.face] = against;
              queue.push_back(other.face);
            } else if (manifold && (walked.against[other.face] != 0) != against) {
              walked.orientable[label[first]] = 0;
            }
          }
        });
    }
  }
  return walked;
}

void expectAsWalked(const TriangleMesh& mesh) {
  const Walked walked = walk(mesh);
  const EdgeTable edges(mesh);
  for (const int threads : {1, 2, 8}) {
    tbb::task_arena arena(threads);
    Progress progress;
    const FacePatches patches =
        arena.execute([&] { return findPatches(mesh.triangleCount(), edges, progress); });
    ASSERT_EQ(patches.patchOf, walked.patchOf);
    ASSERT_EQ(patches.orientable, walked.orientable);
    ASSERT_EQ(patches.patchCount(), walked.orientable.size());
    std::uint32_t parts = 0;
    for (std::size_t face = 0; face < mesh.triangleCount(); ++face) {
      const std::uint32_t patch = patches.patchOf[face];
      if (patch == EdgeTable::kNone)
        continue;
      ASSERT_EQ(patches.partOf[patch], walked.partOfFace[face]);
      parts = std::max(parts, patches.partOf[patch] + 1);
      if (patches.orientable[patch]) {
        ASSERT_EQ(patches.against[face], walked.against[face]) << face;
      }
    }
    ASSERT_EQ(patches.partCount, parts);
  }
}

void reverseSome(TriangleMesh& mesh, std::uint64_t seed) {
  meshes::Random random(seed);
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    if (random.below(3) == 0)
      std::swap(mesh.triangles[3 * face], mesh.triangles[3 * face + 1]);
}

TEST(FacePatches, OfClosedAndOpenMeshes) {
  expectAsWalked(TriangleMesh{});
  expectAsWalked(meshes::box());
  expectAsWalked(meshes::moebius());
  expectAsWalked(meshes::sphere({0, 0, 0}, 1, 100)); // several tasks
}

TEST(FacePatches, OfReversedFaces) {
  for (TriangleMesh mesh :
       {meshes::box(), meshes::moebius(), meshes::torus(), meshes::sphere({0, 0, 0}, 1, 100)}) {
    reverseSome(mesh, 5);
    expectAsWalked(mesh);
  }
}

TEST(FacePatches, OfSoups) {
  meshes::Random random(11);
  for (int round = 0; round < 60; ++round) { // from all edges of two faces to hardly any
    TriangleMesh mesh;
    const std::size_t points = 12 + 4 * static_cast<std::size_t>(round);
    mesh.points.resize(points);
    for (int corner = 0; corner < 3 * 300; ++corner)
      mesh.triangles.push_back(static_cast<std::uint32_t>(random.below(points)));
    expectAsWalked(mesh);
  }
}

} // namespace
} // namespace tetvdb
