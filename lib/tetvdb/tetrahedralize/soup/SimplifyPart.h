// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/tetrahedralize/soup/DiscGap.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/SimplifySoup.h"
#include "tetvdb/tetrahedralize/soup/SoupSurface.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

namespace tetvdb {

/// Simplifies one part of a surface: moves points whose neighbours are all of the part, swaps edges
/// whose four points are.
class SimplifyPart {
public:
  SimplifyPart(SoupSurface& surface, const Envelope& envelope, double radius, Progress& progress);

  /// `points` are all of the part. Edges at those that are due are tried.
  void run(const std::vector<std::uint32_t>& points);
  const SimplifyCounts& counts() const { return counts_; }

private:
  struct Edge {
    double square; ///< of its length when it was put into the queue
    std::uint32_t a, b;
    bool operator<(const Edge& other) const { // the queue's top is its largest
      return std::make_tuple(square, a, b) > std::make_tuple(other.square, other.a, other.b);
    }
    bool operator==(const Edge& other) const {
      return square == other.square && a == other.a && b == other.b;
    }
  };
  /// A face with one corner moved.
  struct NewFace {
    std::uint32_t face;
    std::array<Vec3d, 3> at;
    Vec3d normal; ///< before, of twice the area's length
    double shape; ///< before
    std::size_t moving;
    double depth; ///< as in SoupSurface
  };

  double square(std::uint32_t a, std::uint32_t b) const;
  void enqueue(std::uint32_t a, std::uint32_t b);
  void enqueueStar(std::uint32_t point, bool isNewOnly);
  bool isWithinPart(const std::vector<std::uint32_t>& star) const;
  void findNeighbours(std::uint32_t point, const std::vector<std::uint32_t>& star,
                      std::vector<std::uint32_t>& neighbours) const;
  void tryToCollapse(std::uint32_t a, std::uint32_t b);
  bool keepsTopology(std::uint32_t keep, std::uint32_t gone);
  void addNewFaces(std::uint32_t point, const std::vector<std::uint32_t>& star,
                   std::uint32_t other);
  Vec3d bestPlace(const Vec3d& midpoint) const;
  bool isGoodAt(const Vec3d& to);
  void addCarried(std::uint32_t face);
  bool keepsCarried();
  bool isInEnvelope(std::uint32_t keep, std::uint32_t gone, const Vec3d& to);
  bool asksEnvelope(const Vec3d& direction);
  void collapse(std::uint32_t keep, std::uint32_t gone, const Vec3d& to);
  void dealOut();
  using FacePair = std::array<std::array<Vec3d, 3>, 2>;
  /// Of faces (a, b, c) and `across` (b, a, d): edge a-b becomes c-d.
  struct Swap {
    std::uint32_t a, b, c, d, across;
    std::size_t cornerAcross; ///< of a
  };
  void swapAt(std::uint32_t point);
  bool findSwap(std::uint32_t face, std::size_t corner, Swap& swap);
  bool isGoodSwap(const Swap& swap, const FacePair& before, const FacePair& after,
                  std::array<Vec3d, 2>& old);
  bool tryToSwap(std::uint32_t face, std::size_t corner);

  SoupSurface& s_;
  const Envelope& envelope_;
  const double radius_;
  Progress& progress_;
  SimplifyCounts counts_;
  std::uint32_t part_ = 0;
  std::vector<Edge> queue_;
  std::vector<std::uint32_t> starA_, starB_, neighboursA_, neighboursB_;
  std::vector<std::uint32_t> shared_; ///< faces of both ends
  std::vector<NewFace> newFaces_;
  double worstShape_ = 0; ///< of the faces before
  Disc before_, after_;
  DiscGap gap_;
  std::vector<NearTriangle> triangles_;  ///< the new faces
  std::vector<Box> nearBoxes_;           ///< out of which no point is near one
  std::vector<std::uint32_t> carried_;   ///< points that the old faces stood for
  std::vector<std::uint32_t> nearestOf_; ///< of each the new face
};

} // namespace tetvdb
