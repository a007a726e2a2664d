// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SurfaceDefects.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/DuplicateFaces.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FacePatches.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/WeldPoints.h"
#include "tetvdb/surface/WindingShares.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

constexpr std::size_t kFacesPerTask = 1 << 13;
constexpr double kSliverDegrees = 1;

using Corners = std::vector<std::uint32_t>;

Corners weldedCorners(const TriangleMesh& mesh, SurfaceDefects& defects, Progress& progress) {
  const std::vector<std::uint32_t> becomes = weldPoints(mesh.points, 0, progress);
  std::vector<std::uint8_t> used(mesh.points.size(), 0), usedAsGiven(mesh.points.size(), 0);
  Corners corners(mesh.triangles.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = becomes[mesh.triangles[i]];
    used[corners[i]] = 1;
    usedAsGiven[mesh.triangles[i]] = 1;
  }
  for (std::size_t point = 0; point < becomes.size(); ++point) {
    defects.weldedVertices += used[point];
    defects.unreferencedVertices += usedAsGiven[point] == 0;
    defects.duplicateVertices += becomes[point] != point;
  }
  return corners;
}

// --- Single faces.

// Whether the smallest angle is below the limit, or the largest as close to a straight one.
bool isSliver(const Vec3d& a, const Vec3d& b, const Vec3d& c, double twiceArea) {
  const double tangent = std::tan(kSliverDegrees * 3.14159265358979323846 / 180);
  const Vec3d ab = minus(b, a), bc = minus(c, b), ca = minus(a, c);
  for (const double cosine : {-dot(ab, ca), -dot(bc, ab), -dot(ca, bc)}) // times two lengths
    if (twiceArea < tangent * std::abs(cosine))
      return true;
  return false;
}

struct FaceSums {
  double area = 0, volume = 0;
  std::size_t degenerate = 0, slivers = 0;
};

FaceSums sumFaces(const TriangleMesh& mesh, const Vec3d& centre,
                  std::vector<std::uint8_t>& degenerate) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangleCount(), kFacesPerTask), FaceSums(),
      [&](const tbb::blocked_range<std::size_t>& range, FaceSums sums) {
        for (std::size_t face = range.begin(); face != range.end(); ++face) {
          const Vec3d& a = mesh.points[mesh.triangles[3 * face]];
          const Vec3d& b = mesh.points[mesh.triangles[3 * face + 1]];
          const Vec3d& c = mesh.points[mesh.triangles[3 * face + 2]];
          const Vec3d normal = cross(minus(b, a), minus(c, a));
          const double twiceArea = length(normal);
          sums.area += twiceArea / 2;
          sums.volume += dot(minus(a, centre), normal) / 6;
          degenerate[face] = areCollinear(a, b, c);
          if (degenerate[face])
            ++sums.degenerate;
          else
            sums.slivers += isSliver(a, b, c, twiceArea);
        }
        return sums;
      },
      [](FaceSums left, const FaceSums& right) {
        left.area += right.area;
        left.volume += right.volume;
        left.degenerate += right.degenerate;
        left.slivers += right.slivers;
        return left;
      });
}

void measureFaces(const TriangleMesh& mesh, SurfaceDefects& defects,
                  std::vector<std::uint8_t>& degenerate) {
  const Box box = boxOf(mesh.points, mesh.triangles);
  if (mesh.triangles.empty())
    return;
  defects.boxMin = box.low;
  defects.boxMax = box.high;
  const FaceSums sums = sumFaces(mesh, times(plus(box.low, box.high), 0.5), degenerate);
  defects.area = sums.area;
  defects.volume = sums.volume;
  defects.degenerateFaces = sums.degenerate;
  defects.sliverFaces = sums.slivers;
}

// --- Edges and connectivity.

void countEdges(const EdgeTable& edges, SurfaceDefects& defects) {
  defects.watertight = edges.edgeCount() > 0;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    const int imbalance = edges.imbalance(edge);
    defects.watertight = defects.watertight && imbalance == 0;
    defects.boundaryEdges += sides.size() == 1;
    defects.nonManifoldEdges += sides.size() > 2;
    defects.misorientedEdges += sides.size() == 2 && imbalance != 0;
  }
}

// Connects corners of faces at a point across edges of that point: a set is a fan.
DisjointSets findFans(const Corners& corners, const EdgeTable& edges) {
  DisjointSets fans(corners.size());
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    const auto cornerAt = [&](std::uint32_t side, bool low) {
      return edges.ascends(side) == low ? side : EdgeTable::next(side);
    };
    for (std::size_t i = 1; i < sides.size(); ++i)
      for (const bool low : {true, false})
        fans.join(cornerAt(sides[0], low), cornerAt(sides[i], low));
  }
  return fans;
}

std::size_t countNonManifoldVertices(const Corners& corners, const EdgeTable& edges,
                                     std::size_t pointCount, DisjointSets& fans) {
  std::vector<std::uint8_t> count(pointCount, 0); // up to 2
  std::size_t vertices = 0;
  for (std::uint32_t corner = 0; corner < corners.size(); ++corner) {
    if (!edges.hasFace(EdgeTable::faceOf(corner)) || fans.find(corner) != corner)
      continue;
    std::uint8_t& here = count[corners[corner]];
    here = static_cast<std::uint8_t>(std::min(here + 1, 3));
    vertices += here == 2;
  }
  return vertices;
}

// Boundary edges are consecutive if they belong to one fan.
std::size_t countHoles(const EdgeTable& edges, DisjointSets& fans) {
  DisjointSets loops(edges.edgeCount());
  struct End {
    std::uint32_t fan, edge;
  };
  std::vector<End> ends;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    if (edges.sides(edge).size() != 1)
      continue;
    const std::uint32_t side = edges.sides(edge)[0];
    ends.push_back({fans.find(side), edge});
    ends.push_back({fans.find(EdgeTable::next(side)), edge});
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) {
    return a.fan != b.fan ? a.fan < b.fan : a.edge < b.edge;
  });
  std::vector<std::uint32_t> looseEdges; // at a fan with an odd number of boundary edges
  for (std::size_t i = 0, last; i < ends.size(); i = last) {
    for (last = i; last < ends.size() && ends[last].fan == ends[i].fan; ++last)
      loops.join(ends[i].edge, ends[last].edge);
    if ((last - i) % 2 == 1)
      looseEdges.push_back(ends[i].edge);
  }
  std::vector<std::uint8_t> isLoop(edges.edgeCount(), 0);
  for (const End& end : ends)
    isLoop[loops.find(end.edge)] = 1;
  for (const std::uint32_t edge : looseEdges)
    isLoop[loops.find(edge)] = 0;
  return static_cast<std::size_t>(std::count(isLoop.begin(), isLoop.end(), 1));
}

void lookAtTopology(const Corners& corners, std::size_t pointCount, const EdgeTable& edges,
                    SurfaceDefects& defects, Progress& progress) {
  countEdges(edges, defects);
  const FacePatches patches = findPatches(corners.size() / 3, edges, progress);
  defects.components = patches.partCount;
  defects.orientable = std::find(patches.orientable.begin(), patches.orientable.end(), 0) ==
                       patches.orientable.end();
  DisjointSets fans = findFans(corners, edges);
  defects.nonManifoldVertices = countNonManifoldVertices(corners, edges, pointCount, fans);
  defects.holes = countHoles(edges, fans);

  if (edges.edgeCount() == 0 ||
      defects.boundaryEdges + defects.nonManifoldEdges + defects.nonManifoldVertices > 0 ||
      !defects.orientable)
    return;
  std::vector<std::uint8_t> used(pointCount, 0);
  std::int64_t vertices = 0, faces = 0;
  for (std::uint32_t face = 0; face < corners.size() / 3; ++face) {
    if (!edges.hasFace(face))
      continue;
    ++faces;
    for (std::size_t k = 0; k < 3; ++k) {
      std::uint8_t& here = used[corners[3 * std::size_t(face) + k]];
      vertices += here == 0;
      here = 1;
    }
  }
  // Euler: V - E + F = 2 (components - genus).
  const std::int64_t characteristic = vertices - std::int64_t(edges.edgeCount()) + faces;
  defects.genus = std::int64_t(defects.components) - characteristic / 2;
}

// --- Intersections.

void countIntersections(const TriangleMesh& mesh, const Corners& corners,
                        const std::vector<std::uint8_t>& degenerate,
                        const DuplicateGroups& duplicates, std::size_t limit,
                        SurfaceDefects& defects, Progress& progress) {
  std::vector<std::uint8_t> skip = degenerate;
  for (std::size_t group = 0; group < duplicates.count(); ++group)
    for (std::uint32_t i = duplicates.first[group] + 1; i < duplicates.first[group + 1]; ++i)
      skip[duplicates.faces[i]] = 1;
  Corners faces;
  for (std::size_t face = 0; face < skip.size(); ++face)
    if (!skip[face])
      faces.insert(faces.end(), &corners[3 * face], &corners[3 * face] + 3);
  // A power of two as scale changes no decision and prevents overflow and underflow of products.
  double largest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    largest = std::max({largest, std::abs(defects.boxMin[axis]), std::abs(defects.boxMax[axis])});
  const double scale =
      largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)) : 1;
  std::vector<Vec3d> points = mesh.points;
  for (Vec3d& p : points)
    p = times(p, scale);
  const SelfIntersections found = countIntersections(points, faces, limit, progress);
  defects.selfIntersections = found.pairs;
  defects.selfIntersectionsComplete = found.complete;
}

// --- Unit of length.

std::string unitOf(double diagonal) {
  if (!(diagonal > 0))
    return "";
  if (diagonal < 0.5)
    return "metres";
  if (diagonal < 4)
    return "metres or a normalised model";
  if (diagonal < 20)
    return "inches, centimetres or metres";
  if (diagonal < 2000)
    return "millimetres";
  if (diagonal < 100000)
    return "millimetres of something large, or micrometres";
  return "micrometres, or metres on a map";
}

} // namespace

SurfaceDefects surfaceDefects(const TriangleMesh& mesh, const DefectOptions& options,
                              Progress& progress) {
  checkMesh(mesh);
  SurfaceDefects defects;
  defects.vertices = mesh.points.size();
  defects.triangles = mesh.triangleCount();
  const Corners corners = weldedCorners(mesh, defects, progress);
  std::vector<std::uint8_t> degenerate(mesh.triangleCount(), 0);
  measureFaces(mesh, defects, degenerate);
  progress.update(0.2);

  const EdgeTable edges(corners, mesh.points.size());
  const DuplicateGroups duplicates = findDuplicates(edges);
  defects.duplicateFaces = duplicates.surplus();
  progress.update(0.3);
  // Topology is found by one thread.
  tbb::parallel_invoke(
      [&] { lookAtTopology(corners, mesh.points.size(), edges, defects, progress); },
      [&] {
        if (options.maxIntersections > 0)
          countIntersections(mesh, corners, degenerate, duplicates, options.maxIntersections,
                             defects, progress);
      });
  progress.update(0.8);
  defects.windingShares = windingShares(mesh, corners, edges, options.windingSamples, progress);
  defects.likelyUnit = unitOf(length(minus(defects.boxMax, defects.boxMin)));
  progress.update(1);
  return defects;
}

} // namespace tetvdb
