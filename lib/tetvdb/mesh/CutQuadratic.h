// SPDX-License-Identifier: Apache-2.0
//
// Quadratic cells into tets at their own nodes.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/mesh/CurvedShape.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace tetvdb {

/// How many tets a cell without repeated nodes is cut into.
std::size_t tetsOf(CurvedShape shape);

/// Cuts the cells of one mesh. Ten-node tets become eight (mesh/CutTet10.h); hexahedra become eight
/// hexahedra of half the size, wedges eight wedges, pyramids six pyramids and four tets, whose
/// faces are cut from their smallest vertices (splitCells()). So neighbours agree on every shared
/// face, whatever their types. Where a cell has no node at the centre of a four-sided face, or of a
/// hexahedron, one is added at the place that the shape functions say, one for both cells of a
/// face, the same bits whatever the order of cells and nodes.
class QuadraticCutter {
public:
  /// Points are added to `points`, which must outlive the cutter.
  explicit QuadraticCutter(std::vector<Vec3d>& points) : points_(points), first_(points.size()) {}

  /// Adds the tets of a cell to `tets`, and to `corners` the places (placeOf()) of each one's
  /// corners. Returns whether their orientations differ. Throws Error(Limit) above 2^32 - 2 points.
  bool cut(CurvedShape shape, const std::uint32_t* nodes, std::vector<std::uint32_t>& tets,
           std::vector<std::array<std::uint8_t, 4>>& corners);

  /// Gives an array of the points values for those that were added: what the shape functions say of
  /// numbers, of integers that of one node.
  void addValues(Attribute& array) const;

private:
  struct Added {
    std::array<std::uint32_t, 20> nodes; ///< corners, then mids, each in order of position
    std::uint8_t corners;                ///< 4 of a face, 8 of a hexahedron
    std::size_t mids() const { return corners == 4 ? 4 : 12; }
    double midWeight() const { return corners == 4 ? 0.5 : 0.25; }
  };
  struct FaceHash {
    std::size_t operator()(const std::array<std::uint32_t, 4>& corners) const;
  };

  std::uint32_t add(const std::uint32_t* nodes, const std::uint8_t* corners,
                    const std::uint8_t* mids, std::size_t cornerCount);
  std::uint32_t faceCentre(const std::uint32_t* nodes, const std::uint8_t* corners,
                           const std::uint8_t* mids);

  std::vector<Vec3d>& points_;
  std::size_t first_; ///< points that were there before
  std::vector<Added> added_;
  std::unordered_map<std::array<std::uint32_t, 4>, std::uint32_t, FaceHash> faces_;
  std::vector<std::uint32_t> made_;
};

} // namespace tetvdb
