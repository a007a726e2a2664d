// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/insertion/EdgeInserter.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// Inserts triangles into a mesh whose points include their corners, one by one.
///
/// A triangle's edges come first (EdgeInserter.h). Then its inside, from the edges inward: at each
/// edge of the front the face that lies within tolerance of the triangle is taken, or the tet that
/// the triangle runs through is cut by a point in the edge opposite, until the front has closed. So
/// every triangle becomes a disc of faces that is bounded exactly by its edges' paths, which it
/// shares with its neighbours, and the faces of a closed soup are closed again. All corners of
/// these faces are within twice the tolerance of the triangle. Its neighbourhood is convex, so the
/// faces are within it too. Only splits and swaps happen, which keep the mesh valid; a triangle
/// that fails leaves no more than some needless points. Serial.
class TriangleInserter {
public:
  using Result = InsertResult;

  /// As EdgeInserter's. A triangle fails once more than `maxEffort` tets were visited.
  TriangleInserter(TetComplex& complex, InsertedPaths& known, double tolerance, double reach,
                   std::size_t maxEffort)
      : complex_(complex), known_(known), edges_(complex, known, tolerance, reach, maxEffort),
        tolerance_(tolerance), reach_(reach) {}

  /// `corners` are points of the complex. `chain` is the triangle's, on the side that it looks away
  /// from. `through` is a corner that the path of the edge between the two others must go through,
  /// 0 to 2, or 3: for triangles that are almost collinear.
  Result insert(const std::array<std::uint32_t, 3>& corners, Chain chain, unsigned through);

  /// Inserts triangles that lie in a plane and are connected across edges, as one face: the edges
  /// between them need not become edges of the mesh.
  Result insertFlat(const std::vector<std::array<std::uint32_t, 3>>& triangles, Chain chain);

private:
  using Path = std::vector<std::uint32_t>;
  using Face = std::array<std::uint32_t, 3>;
  struct FrontEdge;
  struct Side {
    std::uint32_t tet;
    unsigned localFace;
    Chain chain;
  };

  template <typename Work>
  Result attempt(Chain chain, const Work& work);
  void joinPaths(std::uint32_t a, std::uint32_t apex, std::uint32_t b);
  void cover(std::array<Path, 3> sides, int depth, std::vector<Face>& faces);
  void closeFront(const std::vector<Path>& sides, double room, std::vector<Face>& faces);
  bool isOpen(std::uint32_t from, std::uint32_t to) const;
  std::uint32_t pointWithin(const FrontEdge& edge, double tolerance) const;
  std::uint32_t faceAtFront(std::uint32_t u, std::uint32_t v);
  std::uint32_t cutAtFront(const FrontEdge& edge, bool isClosed);
  double setTriangle(const std::array<Path, 3>& sides);
  double setFlat(const std::vector<Face>& triangles);
  double height(const Vec3d& p) const;
  double inside(const Vec3d& p) const;

  bool addHalves(const Face& face, std::vector<Face>& faces) const;
  Side sideOf(const Face& face, Chain chain);
  void mark(std::vector<Face> faces, Chain chain);

  TetComplex& complex_;
  InsertedPaths& known_;
  EdgeInserter edges_;
  const double tolerance_, reach_;
  // The triangle at work, or the half of it; of flat faces all triangles and the edges around them.
  std::array<Vec3d, 3> at_{};
  Vec3d normal_{0, 0, 0};                  ///< of length 1
  std::array<Vec3d, 3> inward_{};          ///< of each edge i, i + 1: in the plane, of length 1
  std::vector<std::array<Vec3d, 3>> flat_; ///< empty: the triangle
  std::vector<std::array<Vec3d, 2>> border_;
  std::vector<std::uint32_t> onLoop_;            ///< sorted: points of the loop
  std::unordered_map<std::uint64_t, int> front_; ///< directed edges: from << 32 | to
  std::set<Face> taken_;                         ///< faces of the front's disc, sorted
  std::vector<std::uint32_t> tets_, ring_;
};

} // namespace tetvdb
