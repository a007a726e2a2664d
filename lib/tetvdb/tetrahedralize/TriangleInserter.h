// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/InsertPoint.h"
#include "tetvdb/tetrahedralize/LatticeSoup.h"
#include "tetvdb/tetrahedralize/TetComplex.h"

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tetvdb {

/// Edges of the mesh in place of edges of the input. A path goes from the lower point of the input
/// edge to the higher. An edge of the mesh only ever gives way to its two halves (nothing is
/// collapsed while triangles are inserted), so that a path stays as it was made, and the points
/// that halved its edges since are looked up.
struct InsertedPaths {
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> paths; ///< by edgeKey()
  std::unordered_map<std::uint64_t, std::uint32_t> middles; ///< of edges that were halved

  /// The path of an edge of the input, ends included, from a to b; empty where there is none.
  std::vector<std::uint32_t> path(std::uint32_t a, std::uint32_t b) const;
  /// A path as it is now, its edges halved where they were.
  std::vector<std::uint32_t> refined(const std::vector<std::uint32_t>& path) const;
};

/// Puts triangles into a mesh whose points include their corners, one by one.
///
/// A triangle's edges come first: from corner to corner along edges of the mesh, where these are
/// within `tolerance` of the segment; elsewhere faces in the way are swapped for edges, or get a
/// new point, in their inside or in an edge. Then the
/// inside, from the edges inward: about the edge at the front the face that lies within tolerance
/// of the triangle is taken, or the tet that the triangle runs through is parted by a point in its
/// far edge, until the front has closed. So every triangle becomes a disc of faces that ends
/// exactly at its edges' paths, which it shares with its neighbours, and the faces of a closed soup
/// are closed again. All corners of these faces are within twice the tolerance of the triangle:
/// its neighbourhood is convex, so that the faces are too.
/// Only splits and swaps happen, which keep the mesh valid; a triangle that fails leaves no more
/// than some needless points. Serial.
class TriangleInserter {
public:
  enum class Result : std::uint8_t {
    In,
    Elsewhere, ///< tets of another part are in the way
    Failed     ///< a tet would not stay positive, or the front did not close
  };

  /// Lattice units, 2 <= tolerance <= reach. Paths go up to `reach` aside where tets are so flat
  /// that they cannot be parted. A triangle for which more than `mostEffort` tets would be looked
  /// at fails.
  TriangleInserter(TetComplex& complex, InsertedPaths& known, double tolerance, double reach,
                   std::size_t mostEffort)
      : complex_(complex), known_(known), insert_(complex), tolerance_(tolerance), reach_(reach),
        mostEffort_(mostEffort) {}

  /// `corners` are points of the complex. `chain` is what the triangle counts, on the side that it
  /// looks away from. `through` is a corner that the path of the edge between the two others must
  /// go through, 0 to 2, or 3: for triangles that are all but collinear.
  Result insert(const std::array<std::uint32_t, 3>& corners, Chain chain, unsigned through);

  /// The same for triangles that lie in a plane and are connected across edges, as one face: what
  /// is between them need not become edges of the mesh.
  Result insertFlat(const std::vector<std::array<std::uint32_t, 3>>& triangles, Chain chain);

private:
  using Path = std::vector<std::uint32_t>;
  using Face = std::array<std::uint32_t, 3>;
  struct Stop {
    Result why;
  };

  void spend(std::size_t tets);
  void recover(std::uint32_t a, std::uint32_t b);
  std::uint32_t nextOnSegment(std::uint32_t from, std::uint32_t a, std::uint32_t b);
  bool openFace(std::uint32_t t, unsigned slot);
  double heightOf(const std::array<std::uint32_t, 4>& corners) const;
  std::uint32_t splitEdge(std::uint32_t a, std::uint32_t b, const Vec3d& at);

  void cover(std::array<Path, 3> sides, int depth, std::vector<Face>& faces);
  void closeFront(const std::vector<Path>& sides, double room, std::vector<Face>& faces);
  std::uint32_t faceAtFront(std::uint32_t u, std::uint32_t v);
  double setTriangle(const std::array<Path, 3>& sides);
  double setFlat(const std::vector<Face>& triangles);
  double height(const Vec3d& p) const;
  double inside(const Vec3d& p) const;

  void mark(std::vector<Face> faces, Chain chain);

  TetComplex& complex_;
  InsertedPaths& known_;
  PointInsertion insert_;
  double tolerance_, reach_;
  std::size_t mostEffort_, effort_ = 0; // of the triangle at work
  int flips_ = 0;
  bool mayFlip_ = true;
  // The triangle at work, or the part of it; of flat faces all triangles and the edges around them.
  std::array<Vec3d, 3> at_{};
  Vec3d normal_{0, 0, 0};                  ///< of length 1
  std::array<Vec3d, 3> inward_{};          ///< of each edge i, i + 1: in the plane, of length 1
  std::vector<std::array<Vec3d, 3>> flat_; ///< empty: the triangle
  std::vector<std::array<Vec3d, 2>> border_;
  std::vector<std::uint32_t> onLoop_;            ///< sorted: points of the loop
  std::unordered_map<std::uint64_t, int> front_; ///< directed edges: from << 32 | to
  std::set<Face> taken_;                         ///< faces of the front's disc, sorted
  std::map<Face, std::uint32_t> faceMiddles_;    ///< points put in faces since insert() began
  std::vector<std::uint32_t> tets_, ring_;
};

} // namespace tetvdb
