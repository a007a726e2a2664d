// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TetSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/TetFaces.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/surface/SplitFans.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

// A face of a tet. Equal faces have equal corners, ascending.
struct Face {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t tet : 30, opposite : 2;

  bool operator<(const Face& other) const {
    if (corners != other.corners)
      return corners < other.corners;
    return tet != other.tet ? tet < other.tet : opposite < other.opposite;
  }
};

std::array<std::uint32_t, 3> outward(const TetMesh& mesh, std::size_t tet, std::size_t opposite) {
  std::array<std::uint32_t, 3> v;
  for (std::size_t k = 0; k < 3; ++k)
    v[k] = mesh.tets[4 * tet + kFaceCorners[opposite][k]];
  return v;
}

// Whether it takes an odd number of swaps to sort the corners.
bool isOdd(const std::array<std::uint32_t, 3>& v) {
  return (v[0] > v[1]) != ((v[1] > v[2]) != (v[0] > v[2]));
}

bool hasRepeatedPoint(const std::uint32_t* v) {
  return v[0] == v[1] || v[0] == v[2] || v[0] == v[3] || v[1] == v[2] || v[1] == v[3] ||
         v[2] == v[3];
}

class Surface {
public:
  Surface(const TetMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {}

  TriangleMesh run() {
    if (mesh_.tetCount() >= std::size_t(1) << 30)
      throw Error(Status::Limit, "", "more than 2^30 tetrahedra", "extract their surface in parts");
    orient();
    sortFaces();
    orientFlatTets();
    TriangleMesh surface;
    for (std::size_t i = 0; i < faces_.size();)
      i = addFaces(i, surface);
    if (surface.triangles.empty())
      throw Error(Status::Invalid, "", "the tetrahedra have no surface",
                  "all of them are flat or cancel out");
    compact(surface);
    splitFans(surface, progress_);
    return surface;
  }

private:
  void orient() {
    sign_.assign(mesh_.tetCount(), 0);
    tbb::parallel_for(std::size_t(0), mesh_.tetCount(), [&](std::size_t tet) {
      const std::uint32_t* v = &mesh_.tets[4 * tet];
      const std::vector<Vec3d>& p = mesh_.points;
      // Positive volume: d on the side that b, c turn counter-clockwise from, seen from a.
      sign_[tet] = static_cast<signed char>(orientation(p[v[0]], p[v[1]], p[v[2]], p[v[3]]));
    });
  }

  void sortFaces() {
    faces_.resize(4 * mesh_.tetCount());
    std::size_t count = 0;
    for (std::size_t tet = 0; tet < mesh_.tetCount(); ++tet) {
      if (hasRepeatedPoint(&mesh_.tets[4 * tet]))
        continue;
      for (std::uint32_t opposite = 0; opposite < 4; ++opposite) {
        Face face{outward(mesh_, tet, opposite), static_cast<std::uint32_t>(tet) & 0x3FFFFFFFu,
                  opposite & 3u};
        std::sort(face.corners.begin(), face.corners.end());
        faces_[count++] = face;
      }
    }
    faces_.resize(count);
    progress_.check();
    tbb::parallel_sort(faces_.begin(), faces_.end());
    progress_.check();
  }

  std::size_t endOfEqual(std::size_t i) const {
    std::size_t end = i + 1;
    while (end < faces_.size() && faces_[end].corners == faces_[i].corners)
      ++end;
    return end;
  }

  // 1 where the face, seen from outside its tet, turns as its corners ascend; -1 the other way; 0
  // while its tet is flat and has no side yet.
  int turn(const Face& face) const {
    return isOdd(outward(mesh_, face.tet, face.opposite)) ? -sign_[face.tet] : sign_[face.tet];
  }

  // A flat tet takes the side that makes its faces cancel with a neighbour's, wave by wave.
  void orientFlatTets() {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs; // positions in faces_
    for (std::size_t i = 0; i < faces_.size();) {
      const std::size_t end = endOfEqual(i);
      if (end == i + 2 && (sign_[faces_[i].tet] == 0 || sign_[faces_[i + 1].tet] == 0))
        pairs.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1)});
      i = end;
    }
    for (bool changed = true; changed;) {
      changed = false;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> rest;
      for (const auto& [a, b] : pairs) {
        const Face &first = faces_[a], &second = faces_[b];
        const int turnA = turn(first), turnB = turn(second);
        if (turnA == 0 && turnB == 0) {
          rest.push_back({a, b});
        } else if (turnA == 0 || turnB == 0) {
          const Face& flat = turnA == 0 ? first : second;
          const bool odd = isOdd(outward(mesh_, flat.tet, flat.opposite));
          sign_[flat.tet] = static_cast<signed char>((odd ? 1 : -1) * (turnA + turnB));
          changed = true;
        }
      }
      pairs = std::move(rest);
      progress_.check();
    }
  }

  std::size_t addFaces(std::size_t i, TriangleMesh& surface) const {
    const std::size_t end = endOfEqual(i);
    int sum = 0;
    for (std::size_t k = i; k < end; ++k)
      sum += turn(faces_[k]);
    const std::array<std::uint32_t, 3>& v = faces_[i].corners;
    for (; sum > 0; --sum)
      surface.triangles.insert(surface.triangles.end(), {v[0], v[1], v[2]});
    for (; sum < 0; ++sum)
      surface.triangles.insert(surface.triangles.end(), {v[0], v[2], v[1]});
    return end;
  }

  void compact(TriangleMesh& surface) const {
    std::vector<std::uint32_t> number(mesh_.points.size(), kNone);
    for (const std::uint32_t v : surface.triangles)
      number[v] = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
      if (number[v] == 0) {
        number[v] = static_cast<std::uint32_t>(surface.points.size());
        surface.points.push_back(mesh_.points[v]);
      }
    for (std::uint32_t& v : surface.triangles)
      v = number[v];
  }

  const TetMesh& mesh_;
  Progress& progress_;
  std::vector<signed char> sign_; ///< of a tet's volume
  LargeVector<Face> faces_;
};

} // namespace

TriangleMesh tetSurface(const TetMesh& mesh, Progress& progress) {
  checkMesh(mesh);
  return Surface(mesh, progress).run();
}

} // namespace tetvdb
