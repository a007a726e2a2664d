// SPDX-License-Identifier: Apache-2.0
//
// The input's triangles as sheets: how far a candidate is from the sheet over it.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The triangles of a tree, in pairs across their edges.
///   A candidate is compared with those that are over it, seen along its normal: some triangle near
/// it, and the other one of the pair at every edge over the candidate. If no such edge is without
/// another, the boundary of these triangles is nowhere over the candidate, so that any two of its
/// points have as many of them over them, modulo 2. If that is an odd number at one point, each
/// point of the candidate is as far as one of the triangles along the normal, or nearer; the
/// largest such distance is at a corner of one of the pieces that their edges cut it into.
/// Immutable once made; queries are thread-safe.
class InputSheets {
public:
  /// `faces` are the tree's, and their corners below `points`. The tree has to outlive this. Where
  /// more than two triangles have an edge, the flattest pairs are taken.
  InputSheets(const TriangleTree& tree, const std::vector<std::array<std::uint32_t, 3>>& faces,
              std::size_t points);

  struct Gap {
    /// No point of the candidate is farther from the triangles, up to rounding; infinity where that
    /// is not known: where they do not form a sheet over it or are many, or where it is more than
    /// what was asked for.
    double bound;
    bool isFar; ///< in the last case
    Vec3d far;  ///< then a point of the candidate that is so far along the normal
  };
  /// Of triangle (a, b, c); `start` is a triangle of the tree near its centre. A bound below
  /// `enough` is not improved. Some 50 ns for each triangle over it.
  Gap gap(const Vec3d& a, const Vec3d& b, const Vec3d& c, std::uint32_t start, double most,
          double enough) const;

private:
  void pair(std::vector<std::uint32_t>& edges);

  const TriangleTree& tree_;
  /// Of a triangle of the tree, across the edge from corner k to the next; kNone: none.
  std::vector<std::array<std::uint32_t, 3>> across_;
};

} // namespace tetvdb
