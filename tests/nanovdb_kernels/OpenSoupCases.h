// SPDX-License-Identifier: Apache-2.0
//
// Open triangle soups that the device, its twin and the CPU must make the same grids of.
#pragma once

#include "SoupCases.h"
#include "tetvdb/voxelize/OpenSoup.h"
#include "tetvdb/voxelize/SolidFaces.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// A soup with what fills its holes.
struct FilledSoup {
  FilledSoup(const TriangleMesh& mesh, const GridTransform& transform) {
    Report report;
    Progress progress;
    StageTimer timer(report, "");
    faces = solidFaces(mesh, {}, transform, timer, progress);
    soup = std::make_unique<OpenSoup>(*faces.holes, progress);
    holes = soup->view();
    view = viewOf(mesh);
    view.holes = &holes;
  }

  SolidFaces faces;
  std::unique_ptr<OpenSoup> soup;
  nano::HolesView holes;
  nano::MeshView view;
};

/// `small`: without those of many voxels.
inline std::vector<SoupCase> openSoupCases(bool small) {
  using namespace meshes;
  std::vector<SoupCase> cases;
  const TriangleMesh ball = sphere({3, -70, 100}, 40.3, 12);
  cases.push_back({"a face is missing", without(ball, [](std::size_t f) { return f == 3; })});
  cases.push_back(
      {"every seventh face is missing", without(ball, [](std::size_t f) { return f % 7 == 0; })});
  cases.push_back({"half a sphere", without(ball, [&](std::size_t f) {
                     return ball.points[ball.triangles[3 * f]][2] > 100;
                   })});
  // Voxel centres lie in the plane of the hole: angles that no formula in doubles decides.
  const TriangleMesh cube = box({-16, -16, -16}, {16, 16, 16}, 4);
  for (const std::size_t axis : {0u, 1u, 2u})
    cases.push_back(
        {"a box without a side " + std::to_string(axis), without(cube, [&](std::size_t f) {
           bool side = true;
           for (std::size_t k = 0; k < 3; ++k)
             side = side && cube.points[cube.triangles[3 * f + k]][axis] > 15;
           return side;
         })});
  cases.push_back({"faces turned at random", withFacesFlipped(ball, 0.3, 5)});
  const TriangleMesh holed = without(ball, [](std::size_t f) { return f % 5 == 1; });
  cases.push_back({"twice", joined({holed, holed})});
  cases.push_back({"inside out", flipped(holed)});
  cases.push_back({"anisotropic voxels",
                   without(movedBy(torus(), 37, {-20.1, -5000.7, 3.3}),
                           [](std::size_t f) { return f % 11 < 3; }),
                   {{0.9, 1.1, 1.7}, {0.25, -3, 8}}});
  cases.push_back(
      {"across root tiles", without(movedBy(sphere({0, 0, 0}, 1, 10), 60, {1, -2, 4100}),
                                    [](std::size_t f) { return f % 9 == 4; })});
  // Inside is what lies beyond the box of the points too: forty sheets upon each other.
  const TriangleMesh part =
      without(box({-9, -9, -3}, {9, 9, 3}, 3), [](std::size_t f) { return f > 40; });
  TriangleMesh sheets = part;
  for (int i = 1; i < 40; ++i)
    append(sheets, part);
  cases.push_back({"beyond the box", std::move(sheets)});
  for (std::uint64_t seed = 0; seed < (small ? 3u : 20u); ++seed) {
    TriangleMesh mesh = facesOf(
        soup(1 + seed * 7 % 40, 20 * double(1 + seed % 3), seed % 2 == 0 ? 6 : 25, seed, 2));
    if (seed % 4 > 1)
      mesh = moved(mesh, [](const Vec3d& p) {
        return Vec3d{std::round(p[0]), std::round(p[1]), std::round(p[2])};
      });
    cases.push_back({"soup " + std::to_string(seed),
                     without(mesh, [&](std::size_t f) { return f % (2 + seed % 5) == 0; })});
  }
  if (small)
    return cases;
  // Clusters of triangles take part: many triangles over the holes.
  const TriangleMesh fine = sphere({5, 5, 5}, 70, 70);
  cases.push_back({"thousands of holes", without(fine, [](std::size_t f) { return f % 3 == 0; })});
  cases.push_back(
      {"a large hole of many edges", without(fine, [&](std::size_t f) {
         return fine.points[fine.triangles[3 * f]][0] + fine.points[fine.triangles[3 * f]][2] > 40;
       })});
  return cases;
}

} // namespace tetvdb
