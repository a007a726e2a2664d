// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/MergeFlatFaces.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/CubeRegions.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/SelfIntersections.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = EdgeTable::kNone;
constexpr double kRegionEdges = 64; ///< side of a region, in mean edge lengths
constexpr double kFlatCosine = 0.9; ///< least, of the angle between normals of a flat star
constexpr double kMinCosine = 0.5;  ///< of the angle by which a normal may change
constexpr double kMinShape = 0.02;  ///< height over longest side of a new face, unless it increases
constexpr std::size_t kMaxFaces = 24; ///< around a vertex
constexpr std::size_t kTries = 4;     ///< candidate neighbours per vertex

// The faces around a vertex v: face i has the corners v, ring[i] and ring[i + 1].
struct Star {
  std::size_t size = 0;
  std::array<std::uint32_t, kMaxFaces> sides; ///< from v to ring[i], of face i
  std::array<std::uint32_t, kMaxFaces> ring;
  std::array<Vec3d, kMaxFaces> offsets; ///< of the ring from v
  std::array<Vec3d, kMaxFaces> normals; ///< of unit length

  std::size_t after(std::size_t i) const { return i + 1 == size ? 0 : i + 1; }
  std::size_t before(std::size_t i) const { return i == 0 ? size - 1 : i - 1; }
};

// One pass over a mesh: the cubes of space in parallel, each serially. A vertex moves only if all
// of its neighbours are in its cube, so that nothing is written that another cube reads.
class FlatMerge {
public:
  FlatMerge(TriangleMesh& mesh, std::vector<float>& errors, double tolerance, bool outward,
            CubeRegions regions)
      : mesh_(mesh), errors_(errors), tolerance_(tolerance), outward_(outward),
        regions_(std::move(regions)), opposite_(mesh.triangles.size(), kNone),
        firstSide_(mesh.points.size(), kNone), isGone_(mesh.triangleCount(), 0),
        isChanged_(mesh.triangleCount(), 0), touched_(mesh.points.size(), 0),
        queued_(mesh.points.size(), 0) {}

  // Whether the mesh is a closed manifold.
  bool connect() {
    const EdgeTable edges(mesh_);
    std::atomic<bool> isManifold{true};
    forEachIndex(edges.edgeCount(), [&](std::size_t i) {
      const auto edge = static_cast<std::uint32_t>(i);
      const EdgeTable::Sides sides = edges.sides(edge);
      if (edges.isManifold(edge)) {
        opposite_[sides[0]] = sides[1];
        opposite_[sides[1]] = sides[0];
      } else {
        isManifold = false;
      }
    });
    const auto isLeftOut = [&](std::size_t face) {
      return !edges.hasFace(static_cast<std::uint32_t>(face));
    };
    if (!isManifold || countWhere(mesh_.triangleCount(), isLeftOut) > 0)
      return false;
    for (std::uint32_t side = 0; side < opposite_.size(); ++side)
      firstSide_[mesh_.triangles[side]] = side;
    // Where the faces at a point are several fans, some are not in the one that is counted.
    const double sides = sumOver(firstSide_.size(), [&](std::size_t v) {
      return firstSide_[v] == kNone ? 0.0
                                    : static_cast<double>(valence(static_cast<std::uint32_t>(v)));
    });
    return sides == static_cast<double>(opposite_.size());
  }

  void run(Progress& progress) {
    const std::vector<std::uint32_t> before = mesh_.triangles;
    const std::vector<float> errorsBefore = errors_;
    std::vector<std::vector<std::uint32_t>> vertices(regions_.count);
    for (std::uint32_t v = 0; v < firstSide_.size(); ++v)
      if (firstSide_[v] != kNone)
        vertices[regions_.regionOf[v]].push_back(v);
    tbb::parallel_for(std::size_t(0), vertices.size(), [&](std::size_t i) {
      progress.check();
      mergeRegion(std::move(vertices[i]));
    });
    restoreWhereFacesMeet(before, errorsBefore, progress);
    std::size_t kept = 0;
    for (std::size_t face = 0; face < isGone_.size(); ++face)
      if (!isGone_[face])
        errors_[kept++] = errors_[face];
    errors_.resize(kept);
    dropFaces(mesh_, isGone_);
  }

private:
  std::uint32_t nextAround(std::uint32_t side) const {
    return opposite_[EdgeTable::previous(side)];
  }
  std::uint32_t endOf(std::uint32_t side) const { return mesh_.triangles[EdgeTable::next(side)]; }
  std::size_t valence(std::uint32_t v) const {
    std::size_t count = 0;
    std::uint32_t side = firstSide_[v];
    do {
      ++count;
      side = nextAround(side);
    } while (side != firstSide_[v]);
    return count;
  }
  Vec3d offset(std::uint32_t from, std::uint32_t to) const {
    return minus(mesh_.points[to], mesh_.points[from]);
  }

  // In sweeps: a vertex near one that moved waits for the next sweep, which keeps faces about
  // equally large.
  void mergeRegion(std::vector<std::uint32_t> vertices) {
    Star star;
    std::vector<std::uint32_t> next;
    const auto enqueue = [&](std::uint32_t v, std::uint32_t sweep) {
      if (queued_[v] != sweep)
        next.push_back(v);
      queued_[v] = sweep;
    };
    for (std::uint32_t sweep = 1; !vertices.empty(); ++sweep) {
      next.clear();
      for (const std::uint32_t v : vertices) {
        if (firstSide_[v] == kNone)
          continue;
        if (touched_[v] == sweep) {
          enqueue(v, sweep);
          continue;
        }
        if (!look(v, star) || !collapse(v, star))
          continue;
        for (std::size_t i = 0; i < star.size; ++i) {
          touched_[star.ring[i]] = sweep;
          enqueue(star.ring[i], sweep);
        }
      }
      std::sort(next.begin(), next.end());
      vertices.swap(next);
    }
  }

  // False if a neighbour is in another region, or a face has no area.
  bool look(std::uint32_t v, Star& star) const {
    star.size = 0;
    std::uint32_t side = firstSide_[v];
    do {
      const std::uint32_t w = endOf(side);
      if (star.size == kMaxFaces || regions_.regionOf[w] != regions_.regionOf[v])
        return false;
      star.sides[star.size] = side;
      star.ring[star.size] = w;
      star.offsets[star.size] = offset(v, w);
      ++star.size;
      side = nextAround(side);
    } while (side != firstSide_[v]);
    for (std::size_t i = 0; i < star.size; ++i) {
      const Vec3d normal = cross(star.offsets[i], star.offsets[star.after(i)]);
      const double size = length(normal);
      if (!(size > 0))
        return false;
      star.normals[i] = times(normal, 1 / size);
    }
    return true;
  }

  // Bounds how far the surface from vertex `from` of the ring to vertex `to` moves, if its faces
  // are replaced by others of the same vertices: along the first normal, both surfaces are over
  // each other, and the new one is between vertices that are this far from the planes of the old
  // one. Infinity if the normals differ much.
  static double bend(const Star& star, std::size_t from, std::size_t to) {
    double largest = 0;
    std::size_t face = from;
    do {
      if (!(dot(star.normals[face], star.normals[from]) > kFlatCosine))
        return std::numeric_limits<double>::infinity();
      for (std::size_t i = from;; i = star.after(i)) {
        largest = std::max(largest, std::abs(dot(star.normals[face], star.offsets[i])));
        if (star.after(i) == from || (from != to && i == to))
          break;
      }
      face = star.after(face);
    } while (face != to);
    return largest / kFlatCosine;
  }

  // Whether the two faces at the edge from v to ring[i] lie in different planes.
  bool isCrease(const Star& star, std::size_t i) const {
    const std::size_t last = star.before(i);
    return std::abs(dot(star.normals[last], star.offsets[star.after(i)])) > tolerance_ ||
           std::abs(dot(star.normals[i], star.offsets[last])) > tolerance_;
  }

  bool collapse(std::uint32_t v, const Star& star) {
    std::array<std::size_t, 2> creases{};
    std::size_t creaseCount = 0;
    for (std::size_t i = 0; i < star.size; ++i)
      if (isCrease(star, i)) {
        if (creaseCount == 2)
          return false;
        creases[creaseCount++] = i;
      }
    if (creaseCount == 1)
      return false;
    double error = 0;
    for (std::size_t i = 0; i < star.size; ++i)
      error = std::max(error, double(errors_[star.sides[i] / 3]));
    error += creaseCount == 0
                 ? bend(star, 0, 0)
                 : std::max(bend(star, creases[0], creases[1]), bend(star, creases[1], creases[0]));
    if (!(error <= tolerance_))
      return false;
    std::array<std::size_t, kMaxFaces> order{};
    std::size_t candidates = 0;
    for (std::size_t i = 0; i < star.size; ++i)
      if (creaseCount == 0 || i == creases[0] || i == creases[1])
        order[candidates++] = i;
    const auto squared = [&](std::size_t i) { return dot(star.offsets[i], star.offsets[i]); };
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(candidates),
              [&](std::size_t i, std::size_t k) {
                return std::make_pair(squared(i), star.ring[i]) <
                       std::make_pair(squared(k), star.ring[k]);
              });
    for (std::size_t i = 0; i < std::min(candidates, kTries); ++i)
      if (keepsManifold(star, order[i]) && keepsUpright(star, order[i]) &&
          (!outward_ || keepsSolid(v, star, order[i]))) {
        move(v, star, order[i], error);
        return true;
      }
    return false;
  }

  // v and the target have two common neighbours, which keep three faces.
  bool keepsManifold(const Star& star, std::size_t to) const {
    const std::uint32_t u = star.ring[to];
    const auto end = star.ring.begin() + static_cast<std::ptrdiff_t>(star.size);
    std::size_t common = 0, faces = star.size;
    std::uint32_t side = firstSide_[u];
    do {
      common += std::find(star.ring.begin(), end, endOf(side)) != end;
      ++faces;
      side = nextAround(side);
    } while (side != firstSide_[u]);
    return common == 2 && faces <= kMaxFaces + 4 && valence(star.ring[star.after(to)]) > 3 &&
           valence(star.ring[star.before(to)]) > 3;
  }

  // Whether the faces keep their orientation and shape when v moves to the target.
  static bool keepsUpright(const Star& star, std::size_t to) {
    const auto longest = [](const Vec3d& a, const Vec3d& b) {
      const Vec3d c = minus(b, a);
      return std::max({dot(a, a), dot(b, b), dot(c, c)});
    };
    const Vec3d& moved = star.offsets[to];
    for (std::size_t i = star.after(to); i != star.before(to); i = star.after(i)) {
      const Vec3d &a = star.offsets[i], &b = star.offsets[star.after(i)];
      const Vec3d movedA = minus(a, moved), movedB = minus(b, moved);
      const Vec3d normal = cross(movedA, movedB);
      const double size = length(normal);
      const double shapeBefore = length(cross(a, b)) / longest(a, b) * (1 - 1e-9);
      if (!(dot(star.normals[i], normal) > kMinCosine * size &&
            size / longest(movedA, movedB) > std::min(kMinShape, shapeBefore)))
        return false;
    }
    return true;
  }

  // Whether no tet between an old and a new face is taken from the solid.
  bool keepsSolid(std::uint32_t v, const Star& star, std::size_t to) const {
    const std::vector<Vec3d>& points = mesh_.points;
    for (std::size_t i = star.after(to); i != star.before(to); i = star.after(i))
      if (orientation(points[star.ring[to]], points[star.ring[i]], points[star.ring[star.after(i)]],
                      points[v]) > 0)
        return false;
    return true;
  }

  void move(std::uint32_t v, const Star& star, std::size_t to, double error) {
    const std::uint32_t u = star.ring[to];
    // The face beyond each of the two removed faces' sides, in pairs that become opposite.
    const std::uint32_t left = star.sides[to], right = opposite_[left];
    const std::array<std::array<std::uint32_t, 2>, 2> pairs{
        {{opposite_[EdgeTable::next(left)], opposite_[EdgeTable::previous(left)]},
         {opposite_[EdgeTable::next(right)], opposite_[EdgeTable::previous(right)]}}};
    for (std::size_t i = 0; i < star.size; ++i) {
      const std::uint32_t face = star.sides[i] / 3;
      mesh_.triangles[star.sides[i]] = u;
      errors_[face] = roundUp(error);
      isChanged_[face] = 1;
    }
    for (const std::uint32_t side : {left, right})
      isGone_[side / 3] = 1;
    for (const auto& [a, b] : pairs) {
      opposite_[a] = b;
      opposite_[b] = a;
      firstSide_[mesh_.triangles[a]] = a;
      firstSide_[mesh_.triangles[b]] = b;
    }
    firstSide_[v] = kNone;
  }

  static float roundUp(double value) {
    return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
  }

  // The region that has all corners of a face, or kNone.
  std::uint32_t regionOf(const std::uint32_t* corners) const {
    const std::uint32_t region = regions_.regionOf[corners[0]];
    return regions_.regionOf[corners[1]] == region && regions_.regionOf[corners[2]] == region
               ? region
               : kNone;
  }

  // Takes back what was done in regions of which a new face meets others.
  void restoreWhereFacesMeet(const std::vector<std::uint32_t>& before,
                             const std::vector<float>& errorsBefore, Progress& progress) {
    std::vector<std::uint32_t> faces, corners;
    for (std::uint32_t face = 0; face < isGone_.size(); ++face)
      if (!isGone_[face]) {
        faces.push_back(face);
        const std::uint32_t* c = &mesh_.triangles[3 * std::size_t(face)];
        corners.insert(corners.end(), c, c + 3);
      }
    std::vector<char> restores(regions_.count, 0);
    std::vector<char> looked(faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i)
      looked[i] = isChanged_[faces[i]];
    if (std::find(looked.begin(), looked.end(), 1) == looked.end())
      return;
    for (const std::uint32_t i : facesThatMeetOthers(mesh_.points, corners, looked, progress))
      if (isChanged_[faces[i]])
        restores[regionOf(&corners[3 * std::size_t(i)])] = 1;
    for (std::size_t face = 0; face < isGone_.size(); ++face) {
      const std::uint32_t region = regionOf(&before[3 * face]);
      if (region == kNone || !restores[region])
        continue;
      std::copy_n(&before[3 * face], 3, &mesh_.triangles[3 * face]);
      errors_[face] = errorsBefore[face];
      isGone_[face] = 0;
    }
  }

  TriangleMesh& mesh_;
  std::vector<float>& errors_; ///< by face
  double tolerance_;
  bool outward_;
  CubeRegions regions_;
  std::vector<std::uint32_t> opposite_;         ///< by side
  std::vector<std::uint32_t> firstSide_;        ///< by vertex: one from it; kNone: no face has it
  std::vector<char> isGone_, isChanged_;        ///< by face
  std::vector<std::uint32_t> touched_, queued_; ///< by vertex: the last sweep
};

} // namespace

double mergeFlatFaces(TriangleMesh& mesh, double tolerance, bool outward, Progress& progress) {
  if (mesh.triangles.empty())
    return 0;
  const double side = kRegionEdges * meanEdge(mesh.points, mesh.triangles);
  std::vector<float> errors(mesh.triangleCount(), 0.0F);
  for (const double corner : {0.0, 0.5}) {
    FlatMerge merge(mesh, errors, tolerance, outward,
                    divideByCubes(mesh.points, mesh.points.size(), side, corner));
    if (!merge.connect())
      return 0;
    merge.run(progress);
  }
  dropUnusedPoints(mesh);
  return *std::max_element(errors.begin(), errors.end());
}

} // namespace tetvdb
