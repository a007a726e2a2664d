// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/RegionSurface.h"

#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/Regions.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kPointsPerCheck = 65536;

// A face in the list of its lowest point.
struct Face {
  std::uint32_t middle, high;
  std::uint32_t tet;
  std::uint8_t slot;
};

bool earlier(const Face& f, const Face& g) {
  return std::tie(f.middle, f.high, f.tet, f.slot) < std::tie(g.middle, g.high, g.tet, g.slot);
}

// The corners of face `slot`, so that it looks out of the tet.
std::array<std::uint32_t, 3> faceOf(const std::array<std::uint32_t, 4>& corners, unsigned slot) {
  const auto& at = kFaceCorners[slot];
  return {corners[at[0]], corners[at[1]], corners[at[2]]};
}

std::array<std::uint32_t, 3> sorted(std::array<std::uint32_t, 3> face) {
  std::sort(face.begin(), face.end());
  return face;
}

} // namespace

RegionSurface regionSurface(const TetMesh& mesh, Progress& progress) {
  RegionSurface surface;
  surface.mesh.points = mesh.points;
  std::vector<std::array<std::uint32_t, 4>> tets;
  std::vector<std::int32_t> regions;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::int32_t region = mesh.regions.empty() ? 1 : mesh.regions[mesh.cell(t)];
    if (region == kOutsideRegion)
      continue;
    std::array<std::uint32_t, 4> corners{};
    std::copy_n(mesh.tets.begin() + static_cast<std::ptrdiff_t>(4 * t), 4, corners.begin());
    const auto at = [&](std::size_t i) -> const Vec3d& { return mesh.points[corners[i]]; };
    if (orientation(at(0), at(1), at(2), at(3)) < 0)
      std::swap(corners[2], corners[3]);
    surface.volume += dot(cross(minus(at(1), at(0)), minus(at(2), at(0))), minus(at(3), at(0))) / 6;
    tets.push_back(corners);
    regions.push_back(region);
  }
  progress.check();

  std::vector<std::size_t> begins(mesh.points.size() + 1, 0);
  for (const auto& corners : tets)
    for (unsigned slot = 0; slot < 4; ++slot)
      ++begins[sorted(faceOf(corners, slot))[0] + 1];
  for (std::size_t i = 1; i < begins.size(); ++i)
    begins[i] += begins[i - 1];
  std::vector<Face> faces(4 * tets.size());
  std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
  for (std::uint32_t t = 0; t < tets.size(); ++t)
    for (std::uint8_t slot = 0; slot < 4; ++slot) {
      const auto key = sorted(faceOf(tets[t], slot));
      faces[next[key[0]]++] = {key[1], key[2], t, slot};
    }
  progress.check();

  std::vector<std::uint32_t> between;
  const auto add = [&](const Face& face, std::vector<std::uint32_t>& list) {
    const auto corners = faceOf(tets[face.tet], face.slot);
    list.insert(list.end(), corners.begin(), corners.end());
  };
  for (std::size_t point = 0; point + 1 < begins.size(); ++point) {
    if (point % kPointsPerCheck == 0)
      progress.check();
    Face *face = faces.data() + begins[point], *end = faces.data() + begins[point + 1];
    std::sort(face, end, earlier);
    while (face != end) {
      const Face* first = face;
      bool differ = false;
      for (; face != end && face->middle == first->middle && face->high == first->high; ++face)
        differ = differ || regions[face->tet] != regions[first->tet];
      if (face - first == 1)
        add(*first, surface.mesh.triangles);
      else if (differ)
        add(*first, between);
    }
  }
  surface.outerFaces = surface.mesh.triangleCount();
  surface.mesh.triangles.insert(surface.mesh.triangles.end(), between.begin(), between.end());
  surface.mesh.faceCount = surface.mesh.triangleCount();
  return surface;
}

} // namespace tetvdb
