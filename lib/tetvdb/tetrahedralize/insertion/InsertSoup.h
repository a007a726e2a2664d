// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/insertion/TriangleInserter.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// Inserts the triangles of a soup into a mesh that has the soup's points among its own
/// (TriangleInserter.h). Faces in one plane that are connected across edges of no other face are
/// inserted as one: the edges of a fan would otherwise cut the tets in its plane again and again.
/// Points on edges of a single face are marked as on the boundary.
class SoupInsertion {
public:
  /// Point i of the soup is point firstPoint + i of the mesh. `reach` in lattice units: how far the
  /// faces of a triangle may be from it; most are a hundred times nearer. `coarsen` reduces the
  /// number of tets: it may remove and move any point that is not fixed, as long as tracked faces
  /// stay faces. The soup must outlive this.
  SoupInsertion(const LatticeSoup& soup, std::size_t inputCount, std::uint32_t firstPoint,
                double reach, std::function<void(TetComplex&)> coarsen);

  /// Inserts the faces that are not in yet; `first` before all others, which helps faces that were
  /// missing: the earlier, the fewer tets are in the way. Parallel by TetParts, faces across parts
  /// in later rounds; the same mesh for any number of threads. About 10 us a triangle.
  ///   Long thin triangles leave long thin tets, which cut the next triangles in more places: the
  /// number of tets grows geometrically. Where the mesh has grown much, or triangles do not go in,
  /// it is coarsened in between. Throws Error(Limit) where millions of tets are left.
  void run(TetComplex& complex, const std::vector<std::uint32_t>& first, Progress& progress);

  /// Faces that could not be inserted, ascending.
  std::vector<std::uint32_t> missing() const;

private:
  struct PartWork;
  void findFaces(PartWork& mine, const TetComplex& complex) const;
  void insert(PartWork& mine, TetComplex& complex) const;
  bool bring(std::uint32_t face, PartWork& mine, std::array<std::uint32_t, 3>& corners) const;
  bool insertFlat(std::uint32_t flat, PartWork& mine, TriangleInserter& inserter) const;
  struct EdgeFace {
    std::uint32_t faces[2], count; ///< the first two faces at an edge, and how many there are
  };
  using EdgeFaces = std::unordered_map<std::uint64_t, EdgeFace>; ///< by edgeKey()
  EdgeFaces facesAtEdges() const;
  void findFlats();
  std::vector<std::uint32_t> growFlat(std::uint32_t seed, const EdgeFaces& facesAtEdge,
                                      std::vector<bool>& isFree) const;
  void round(TetComplex& complex, int round, const std::vector<std::uint32_t>& named,
             Progress& progress);
  void collect(const std::vector<PartWork>& works, std::size_t pointsBefore);
  void thin(TetComplex& complex);
  void markBoundary(TetComplex& complex) const;
  std::array<std::uint32_t, 3> cornersOf(std::uint32_t face) const;
  Chain chainOf(std::uint32_t face) const;
  Vec3d areaOf(std::uint32_t face) const; ///< twice, along the normal

  const LatticeSoup& soup_;
  std::size_t inputCount_;
  std::uint32_t firstPoint_;
  double tolerance_, reach_;
  std::vector<bool> in_;
  std::vector<std::uint8_t> through_; // of TriangleInserter::insert()
  std::vector<std::uint32_t> facesBegin_, facesOfPoint_;
  std::vector<std::uint32_t> flatOf_;             // of a face; kNone: on its own
  std::vector<std::vector<std::uint32_t>> flats_; // faces in one plane, ascending
  InsertedPaths paths_; // midpoints are merged into the paths after each round
  std::function<void(TetComplex&)> coarsen_;
  bool isCutShort_ = false; // the last round, by the growth of a part
};

} // namespace tetvdb
