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
  std::size_t maxIntersections = 100000; ///< stop counting self-intersections here; 0: do not count
  std::size_t windingSamples = 4096;     ///< points for the winding histogram; 0: none
};

/// What is wrong with a mesh, and what it measures. Topology is counted after welding equal points;
/// edges are counted over faces without repeated points.
struct SurfaceDefects {
  std::size_t vertices = 0, triangles = 0; ///< as given
  std::size_t weldedVertices = 0;          ///< distinct positions in use
  std::size_t duplicateVertices = 0;       ///< equal to an earlier one
  std::size_t unreferencedVertices = 0;
  std::size_t degenerateFaces = 0;     ///< without area: a repeated point, or collinear (exact)
  std::size_t sliverFaces = 0;         ///< with area, but an angle below 1 degree or above 179
  std::size_t duplicateFaces = 0;      ///< over the same three points as an earlier one
  std::size_t boundaryEdges = 0;       ///< of one face
  std::size_t nonManifoldEdges = 0;    ///< of three faces or more
  std::size_t misorientedEdges = 0;    ///< of two faces that run along it in the same direction
  std::size_t nonManifoldVertices = 0; ///< whose faces form more than one fan
  std::size_t holes = 0;               ///< closed loops of boundary edges
  std::size_t components = 0;          ///< connected across shared edges
  bool orientable = true;
  bool watertight = false; ///< every edge is run along as often in one direction as in the other
  std::optional<std::int64_t>
      genus; ///< of a closed, orientable manifold: of all components together
  /// Pairs of triangles that meet in more than what they share, exact. Stops at the limit.
  std::size_t selfIntersections = 0;
  bool selfIntersectionsComplete = true;
  double area = 0;   ///< world units squared
  double volume = 0; ///< signed, by the divergence theorem about the box's centre
  Vec3d boxMin{0, 0, 0}, boxMax{0, 0, 0};
  /// Share of sample points in the box with a winding number below -0.5, in -0.5..0.5, 0.5..1.5 and
  /// above 1.5, of the mesh as given.
  std::array<double, 4> windingShares{0, 0, 0, 0};
  std::string likelyUnit; ///< "millimetres", "metres", "inches", ...: a guess from the size
};

/// Looks at `mesh` as it stands. Parallel, deterministic; about 3 us a face, more where many boxes
/// of faces overlap.
SurfaceDefects surfaceDefects(const TriangleMesh& mesh, const DefectOptions& options,
                              Progress& progress);

/// One line: "watertight", or "not watertight: 42 open edges in 3 holes; the solid is closed by
/// winding number", "a sheet without inside; give it thickness with --shell", ...
std::string verdict(const SurfaceDefects& defects);

} // namespace tetvdb
