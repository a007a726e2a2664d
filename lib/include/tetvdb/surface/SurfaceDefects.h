// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace tetvdb {

struct DefectOptions {
  std::size_t maxIntersections = 100000; ///< limit of counted self-intersections; 0: does not count
  std::size_t windingSamples = 4096;     ///< points of the winding histogram; 0: none
};

/// Defects and measurements of a mesh. Topology is counted after equal points are merged; edges are
/// counted over faces without repeated points.
struct SurfaceDefects {
  std::size_t vertices = 0, triangles = 0; ///< of the input
  std::size_t weldedVertices = 0;          ///< distinct positions in use
  std::size_t duplicateVertices = 0;       ///< points equal to an earlier one
  std::size_t unreferencedVertices = 0;
  std::size_t degenerateFaces = 0;     ///< with a repeated point, or collinear (exact)
  std::size_t sliverFaces = 0;         ///< with area and an angle below 1 or above 179 degrees
  std::size_t duplicateFaces = 0;      ///< with the same three points as an earlier face
  std::size_t boundaryEdges = 0;       ///< edges of one face
  std::size_t nonManifoldEdges = 0;    ///< edges of three or more faces
  std::size_t misorientedEdges = 0;    ///< edges of two faces in the same direction
  std::size_t nonManifoldVertices = 0; ///< vertices whose faces form more than one fan
  std::size_t holes = 0;               ///< closed loops of boundary edges
  std::size_t components = 0;          ///< sets of faces connected across shared edges
  bool orientable = true;
  bool watertight = false;           ///< every edge is traversed equally often in both directions
  std::optional<std::int64_t> genus; ///< of a closed, orientable manifold, all components together
  /// Pairs of triangles that intersect in more than their common points, exact, up to the limit.
  std::size_t selfIntersections = 0;
  bool selfIntersectionsComplete = true;
  double area = 0;   ///< world units squared
  double volume = 0; ///< signed; by the divergence theorem about the box's centre
  Vec3d boxMin{0, 0, 0}, boxMax{0, 0, 0};
  /// Fractions of sample points in the box with a winding number below -0.5, from -0.5 to 0.5, from
  /// 0.5 to 1.5, and above 1.5. The mesh is not cleaned.
  std::array<double, 4> windingShares{0, 0, 0, 0};
  std::string likelyUnit; ///< "millimetres", "metres", "inches", ...: guessed from the size
};

/// Analyses `mesh` without changing it. Parallel, deterministic; about 3 us per face, more if many
/// boxes of faces overlap.
SurfaceDefects surfaceDefects(const TriangleMesh& mesh, const DefectOptions& options,
                              Progress& progress);

/// Describes the defects in one line: "watertight", "not watertight: 42 open edges in 3 holes; the
/// solid is closed by winding number", "a sheet without inside; give it thickness with `shell`",
/// ...
std::string verdict(const SurfaceDefects& defects);

} // namespace tetvdb
