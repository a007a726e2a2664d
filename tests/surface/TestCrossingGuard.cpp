// SPDX-License-Identifier: Apache-2.0
#include "TriangleMeshes.h"
#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/surface/CrossingGuard.h"

#include <algorithm>
#include <cstdint>
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
    std::size_t expected = added.size() == 2 && facesMeet(points, added[0].data(), added[1].data());
    for (std::uint32_t face = 0; face < faces.size(); ++face)
      if (!isGone[face] && std::find(replaced.begin(), replaced.end(), face) == replaced.end())
        for (const Corners& corners : added)
          expected += facesMeet(points, corners.data(), faces[face].data());
    EXPECT_EQ(guard.crosses(added, replaced), expected > 0);
    EXPECT_EQ(guard.crossings(added, replaced, SIZE_MAX), expected);
    EXPECT_EQ(guard.crossings(added, replaced, 2), std::min<std::size_t>(expected, 2));
    ++(expected > 0 ? yes : no);
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

TEST(CrossingGuard, FacesWithoutAreaCountAndMeetNothing) {
  const std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0},       {0, 1, 0},    {0.2, 0.2, -1},
                                  {1, 1, 1}, {0.2, 0.2, 0.5}, {0.2, 0.2, 1}};
  CrossingGuard guard(points, {{0, 1, 2}, {3, 5, 6}});
  EXPECT_EQ(guard.crossings({{3, 4, 5}}, {}, 9), 1u);  // with the first
  EXPECT_EQ(guard.crossings({{3, 5, 6}}, {1}, 9), 1u); // itself
  EXPECT_EQ(guard.crossings({{3, 4, 5}, {3, 5, 6}}, {0, 1}, 9), 1u);
  guard.change(1, {3, 4, 6});
  EXPECT_EQ(guard.crossings({{0, 1, 2}}, {0}, 9), 1u);
}

} // namespace
} // namespace tetvdb
