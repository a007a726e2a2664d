// SPDX-License-Identifier: Apache-2.0
//
// Edges of the input as paths of edges of the mesh.
#pragma once

#include "tetvdb/tetrahedralize/complex/InsertPoint.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// Paths along edges of the mesh, each for an edge of the input. A path goes from the lower point
/// of the input edge to the higher. While triangles are inserted an edge of the mesh is only ever
/// replaced by its two halves, never collapsed. A path is therefore stored as it was made;
/// refined() looks up the points that have halved its edges since.
struct InsertedPaths {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> paths; ///< by edgeKey()
  std::unordered_map<std::uint64_t, std::uint32_t> midpoints; ///< of edges that were halved

  /// The path of an edge of the input from a to b, both included; empty where there is none.
  std::vector<std::uint32_t> path(std::uint32_t a, std::uint32_t b) const;
  /// A path as it is now, its edges halved where they were.
  std::vector<std::uint32_t> refined(const std::vector<std::uint32_t>& path) const;
};

enum class InsertResult : std::uint8_t {
  In,
  Elsewhere, ///< tets of another part are in the way
  Failed     ///< a tet would not stay positive, or the front did not close
};

/// Thrown within one insertion, and caught by TriangleInserter.
struct InsertStop {
  InsertResult why;
};

/// Inserts edges of the input into a mesh that has their points. A path follows edges of the mesh
/// that are within `tolerance` of the segment. Where there are none, the face that the segment
/// leaves through is swapped for an edge or gets a new point, in its inside or in one of its edges.
/// Serial.
class EdgeInserter {
public:
  using Face = std::array<std::uint32_t, 3>;

  /// Lattice units, 2 <= tolerance <= reach. Paths go up to `reach` aside where tets are too flat
  /// to be cut. insert() and spend() throw InsertStop once more than `maxEffort` tets were visited.
  EdgeInserter(TetComplex& complex, InsertedPaths& known, double tolerance, double reach,
               std::size_t maxEffort)
      : complex_(complex), known_(known), insert_(complex), tolerance_(tolerance), reach_(reach),
        maxEffort_(maxEffort) {}

  /// Begins the next triangle: its effort is 0, faces may be swapped.
  void begin();
  /// Until begin(): keeps every face of the mesh.
  void keepFaces() { maySwap_ = false; }
  /// Counts tets that were visited.
  void spend(std::size_t tets);

  /// Makes a path for edge a-b of the input, where there is none yet. Throws InsertStop.
  void insert(std::uint32_t a, std::uint32_t b);

  /// Splits an edge of the mesh at the point of it nearest to `at`. Returns the new point; kNone as
  /// PointInsertion.
  std::uint32_t split(std::uint32_t a, std::uint32_t b, const Vec3d& at);

  /// Points put into faces (sorted corners) since begin().
  const std::map<Face, std::uint32_t>& facePoints() const { return facePoints_; }

private:
  struct Segment;
  struct Step {
    std::uint32_t next;   ///< the next point of the path, joined by an edge; kNone: there is none
    std::uint32_t detour; ///< the point nearest to the segment, within reach; kNone: there is none
  };
  Step stepAlongEdge(std::uint32_t from, std::uint32_t to, const Segment& segment) const;
  std::uint32_t stepThroughFace(std::uint32_t from, std::uint32_t a, std::uint32_t b,
                                const Segment& segment, std::uint32_t detour);
  std::uint32_t next(std::uint32_t from, std::uint32_t a, std::uint32_t b);
  std::uint32_t splitNearEdge(const Face& face, const Vec3d& cut, const Segment& segment);
  std::uint32_t splitFace(std::uint32_t t, unsigned localFace, const Vec3d& cut);
  bool swapFace(std::uint32_t t, unsigned localFace);
  double heightOf(const std::array<std::uint32_t, 4>& corners) const;

  TetComplex& complex_;
  InsertedPaths& known_;
  PointInsertion insert_;
  const double tolerance_, reach_;
  const std::size_t maxEffort_;
  std::size_t effort_ = 0; // of the triangle at work
  int swaps_ = 0;          // along the edge at work
  bool maySwap_ = true;
  std::map<Face, std::uint32_t> facePoints_;
  std::vector<std::uint32_t> tets_;
};

/// A face's corners, ascending.
std::array<std::uint32_t, 3> sortedCorners(std::array<std::uint32_t, 3> face);

} // namespace tetvdb
