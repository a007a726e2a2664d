// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SharpenCreases.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/SelfIntersections.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kSharpCosine = 0.9; ///< of the angle between two normals of a cube with a crease
constexpr double kFlat = 0.02;       ///< eigenvalue over the largest: no plane has this direction
constexpr double kOutside = 0.6;     ///< voxels that the point may lie outside its cube
constexpr int kSweeps = 12;
constexpr int kRounds = 4; ///< of omitting fans that intersect faces
constexpr std::size_t kCubesPerTask = 512;

using Matrix = std::array<Vec3d, 3>; ///< rows

// Computes eigenvalues on the diagonal of `m` and eigenvectors in the columns of `vectors` by
// cyclic Jacobi rotations (Golub and Van Loan, Matrix Computations, 8.5).
void diagonalize(Matrix& m, Matrix& vectors) {
  vectors = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t p = 0; p < 2; ++p)
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (m[p][q] == 0)
          continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b;
          m[k][q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b;
          m[q][k] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double a = vectors[k][p], b = vectors[k][q];
          vectors[k][p] = c * a - s * b;
          vectors[k][q] = s * a + c * b;
        }
      }
}

// The least-squares point of the planes; of several, the one closest to the mean of their points.
// Directions that the planes hardly determine are left out.
Vec3d nearestToPlanes(const std::vector<const ShapeContact*>& planes) {
  Vec3d mean{0, 0, 0};
  for (const ShapeContact* plane : planes)
    mean = plus(mean, times(plane->point, 1.0 / static_cast<double>(planes.size())));
  Matrix m{}, vectors;
  Vec3d right{0, 0, 0};
  for (const ShapeContact* plane : planes) {
    const Vec3d n{plane->normal[0], plane->normal[1], plane->normal[2]};
    const double distance = dot(n, minus(plane->point, mean));
    for (std::size_t i = 0; i < 3; ++i) {
      right[i] += n[i] * distance;
      for (std::size_t j = 0; j < 3; ++j)
        m[i][j] += n[i] * n[j];
    }
  }
  diagonalize(m, vectors);
  const double largest = std::max({m[0][0], m[1][1], m[2][2]});
  Vec3d result = mean;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(m[k][k] > kFlat * largest))
      continue;
    const Vec3d v{vectors[0][k], vectors[1][k], vectors[2][k]};
    result = plus(result, times(v, dot(v, right) / m[k][k]));
  }
  return result;
}

class Sharpening {
public:
  Sharpening(TriangleMesh& mesh, const std::vector<ShapeContact>& contacts,
             const std::vector<CubePatch>& cubes, const GridTransform& transform,
             Progress& progress)
      : mesh_(mesh), contacts_(contacts), cubes_(cubes), transform_(transform), progress_(progress),
        first_(cubes.size() + 1, 0), isSharp_(cubes.size(), 0), apex_(cubes.size()) {
    for (std::size_t i = 0; i < cubes.size(); ++i)
      first_[i + 1] = first_[i] + cubes[i].triangles;
  }

  std::size_t run() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cubes_.size(), kCubesPerTask),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        progress_.check();
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          look(i);
                      });
    const std::size_t before = mesh_.points.size();
    marched_ = mesh_.triangles;
    for (int round = 0;; ++round) {
      const std::vector<std::size_t> cubeOf = addPoints(before);
      emit(before);
      flipEdges(before);
      if (round == kRounds || !dropCrossing(before, cubeOf))
        break;
    }
    mesh_.faceCount = mesh_.triangleCount();
    return mesh_.points.size() - before;
  }

private:
  // Determines whether a cube has one surface with a crease, and the point of the crease.
  void look(std::size_t i) {
    std::vector<std::uint32_t> corners(mesh_.triangles.begin() + std::ptrdiff_t(3 * first_[i]),
                                       mesh_.triangles.begin() + std::ptrdiff_t(3 * first_[i + 1]));
    const std::size_t triangles = corners.size() / 3;
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    if (corners.size() != triangles + 2) // more than one disk
      return;
    std::vector<const ShapeContact*> planes;
    double min = 1;
    for (const std::uint32_t v : corners) {
      const ShapeContact& contact = contacts_[v];
      const auto& n = contact.normal;
      if (n[0] == 0 && n[1] == 0 && n[2] == 0)
        return;
      for (const ShapeContact* other : planes)
        min = std::min(min, double(n[0]) * other->normal[0] + double(n[1]) * other->normal[1] +
                                double(n[2]) * other->normal[2]);
      planes.push_back(&contact);
    }
    if (min > kSharpCosine)
      return;
    apex_[i] = nearestToPlanes(planes);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double inCube =
          (apex_[i][axis] - transform_.origin[axis]) / transform_.voxelSize[axis] -
          cubes_[i].cube[axis];
      if (!(inCube > -kOutside && inCube < 1 + kOutside))
        return;
    }
    isSharp_[i] = 1;
  }

  // Adds the points, without those that equal another point. Returns the cubes of the points.
  std::vector<std::size_t> addPoints(std::size_t before) {
    std::vector<std::size_t> cubeOf;
    for (bool isDone = false; !isDone;) {
      mesh_.points.resize(before);
      cubeOf.clear();
      for (std::size_t i = 0; i < cubes_.size(); ++i)
        if (isSharp_[i] != 0) {
          cubeOf.push_back(i);
          mesh_.points.push_back(apex_[i]);
        }
      isDone = true;
      for (const std::uint32_t v : equalAsFloats(mesh_.points))
        if (v >= before) {
          isSharp_[cubeOf[v - before]] = 0;
          isDone = false;
        }
    }
    return cubeOf;
  }

  // Restores the cubes whose fans intersect other faces. Returns whether there were any.
  bool dropCrossing(std::size_t before, const std::vector<std::size_t>& cubeOf) {
    const std::vector<std::uint32_t> crossing =
        facesThatMeetOthers(mesh_.points, mesh_.triangles, isFan_, progress_);
    for (const std::uint32_t face : crossing)
      for (std::size_t k = 0; k < 3; ++k)
        if (const std::uint32_t v = mesh_.triangles[3 * std::size_t(face) + k]; v >= before)
          isSharp_[cubeOf[v - before]] = 0;
    return !crossing.empty();
  }

  // Sides that only one triangle of the cube has.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border(std::size_t i) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides, result;
    for (std::size_t t = first_[i]; t < first_[i + 1]; ++t)
      for (std::size_t k = 0; k < 3; ++k)
        sides.emplace_back(marched_[3 * t + k], marched_[3 * t + (k + 1) % 3]);
    for (const auto& [a, b] : sides)
      if (std::find(sides.begin(), sides.end(), std::make_pair(b, a)) == sides.end())
        result.emplace_back(a, b);
    return result;
  }

  // Writes the faces of all cubes: fans, of which each has a face for every side of the disk's
  // border, two more than the disk, or the faces as they were.
  void emit(std::size_t before) {
    std::vector<std::size_t> place(cubes_.size() + 1, 0); // of a cube's first face
    std::vector<std::uint32_t> apex(cubes_.size());
    auto next = static_cast<std::uint32_t>(before);
    for (std::size_t i = 0; i < cubes_.size(); ++i) {
      place[i + 1] = place[i] + cubes_[i].triangles + (isSharp_[i] != 0 ? 2 : 0);
      apex[i] = next;
      next += isSharp_[i] != 0 ? 1 : 0;
    }
    mesh_.triangles.resize(3 * place.back());
    isFan_.assign(place.back(), 0);
    forEachIndex(cubes_.size(), [&](std::size_t i) {
      auto to = mesh_.triangles.begin() + std::ptrdiff_t(3 * place[i]);
      if (isSharp_[i] == 0) {
        std::copy(marched_.begin() + std::ptrdiff_t(3 * first_[i]),
                  marched_.begin() + std::ptrdiff_t(3 * first_[i + 1]), to);
        return;
      }
      std::fill(isFan_.begin() + std::ptrdiff_t(place[i]),
                isFan_.begin() + std::ptrdiff_t(place[i + 1]), char(1));
      for (const auto& [a, b] : border(i))
        for (const std::uint32_t corner : {a, b, apex[i]})
          *to++ = corner;
    });
  }

  // An edge between two fans is replaced by the edge between their points. Two cubes have two such
  // edges if both run through their common face: the first one is flipped.
  void flipEdges(std::size_t before) {
    std::vector<std::uint32_t> faces, corners; // of the fans
    for (std::uint32_t face = 0; face < isFan_.size(); ++face)
      if (isFan_[face] != 0) {
        faces.push_back(face);
        const auto first = mesh_.triangles.begin() + std::ptrdiff_t(3) * face;
        corners.insert(corners.end(), first, first + 3);
      }
    const EdgeTable edges(corners, mesh_.points.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> joined;
    std::vector<std::array<std::uint32_t, 4>> flips; // both sides, both points
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
      const EdgeTable::Sides sides = edges.sides(edge);
      if (sides.size() != 2 || edges.highPoint(edge) >= before)
        continue;
      const std::uint32_t c = edges.opposite(sides[0]), d = edges.opposite(sides[1]);
      if (c < before || d < before || !joined.insert({std::min(c, d), std::max(c, d)}).second)
        continue;
      flips.push_back({sides[0], sides[1], c, d});
    }
    for (const auto& [first, second, c, d] : flips) {
      const std::uint32_t a = corners[first], b = corners[EdgeTable::next(first)];
      const auto put = [&](std::uint32_t side, const std::array<std::uint32_t, 3>& flipped) {
        std::copy(flipped.begin(), flipped.end(),
                  mesh_.triangles.begin() + std::ptrdiff_t(3) * faces[EdgeTable::faceOf(side)]);
      };
      put(first, {c, a, d});
      put(second, {d, b, c});
    }
  }

  TriangleMesh& mesh_;
  const std::vector<ShapeContact>& contacts_;
  const std::vector<CubePatch>& cubes_;
  const GridTransform& transform_;
  Progress& progress_;
  std::vector<std::uint32_t> marched_; ///< corners of the faces before sharpening
  std::vector<std::size_t> first_;     ///< by cube: its first triangle
  std::vector<char> isSharp_;          ///< by cube
  std::vector<char> isFan_;            ///< by face: one of a fan
  std::vector<Vec3d> apex_;            ///< by cube: the point of its fan
};

} // namespace

std::size_t sharpenCreases(TriangleMesh& mesh, const std::vector<ShapeContact>& contacts,
                           const std::vector<CubePatch>& cubes, const GridTransform& transform,
                           Progress& progress) {
  return Sharpening(mesh, contacts, cubes, transform, progress).run();
}

} // namespace tetvdb
