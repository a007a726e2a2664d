// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/surface/CrossingGuard.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace tetvdb {
namespace {

using Corners = CrossingGuard::Corners;

// Every face against every other.
TEST(CrossingGuard, SaysWhatALookAtAllPairsSays) {
  meshes::Random random(5);
  std::vector<Vec3d> points;
  for (int i = 0; i < 60; ++i)
    points.push_back({random.unit(), random.unit(), random.unit()});
  const auto newFace = [&] {
    Corners c;
    do
      for (std::uint32_t& v : c)
        v = static_cast<std::uint32_t>(random.below(points.size()));
    while (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]);
    return c;
  };
  std::vector<Corners> faces;
  for (int i = 0; i < 12; ++i)
    faces.push_back(newFace());
  std::vector<char> isGone(faces.size(), 0);
  CrossingGuard guard(points, faces);
  int yes = 0, no = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<Corners> added{newFace()};
    if (random.below(3) == 0)
      added.push_back(newFace());
    std::vector<std::uint32_t> replaced;
    for (std::uint32_t face = 0; face < faces.size(); ++face)
      if (!isGone[face] && random.below(2) == 0)
        replaced.push_back(face);
    bool expected = added.size() == 2 && facesMeet(points, added[0].data(), added[1].data());
    for (std::uint32_t face = 0; face < faces.size(); ++face)
      if (!isGone[face] && std::find(replaced.begin(), replaced.end(), face) == replaced.end())
        for (const Corners& corners : added)
          expected = expected || facesMeet(points, corners.data(), faces[face].data());
    EXPECT_EQ(guard.crosses(added, replaced), expected);
    ++(expected ? yes : no);
    const auto face = static_cast<std::uint32_t>(random.below(faces.size()));
    if (round % 200 == 199 && !isGone[face]) {
      isGone[face] = 1;
      guard.remove(face);
    } else if (!isGone[face]) {
      faces[face] = newFace();
      guard.change(face, faces[face]);
    }
  }
  EXPECT_GT(yes, 100);
  EXPECT_GT(no, 100);
}

} // namespace
} // namespace tetvdb
