// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

/// The tets, faces and edges around a point that is not fixed, gathered once for many candidates.
class PointStar {
public:
  /// The face opposite the point: (point, a, b, c) is positive.
  struct LinkFace {
    Vec3d a, b, c;
    std::array<std::uint32_t, 3> corners;
    double weight = 1; ///< of the tet, cubed
  };
  /// The face of a tet opposite one of its corners.
  static LinkFace linkFace(const TetComplex& complex, const TetComplex::Tet& tet,
                           unsigned localFace);
  /// A tracked face (point, p, q).
  struct Sheet {
    std::uint32_t p, q;
  };
  /// A point that an edge leads to.
  struct Spoke {
    std::uint32_t point;
    std::uint32_t sheets; ///< tracked faces around the edge
    double square;        ///< of the length
  };

  /// Cost is that of TetComplex::star() and some ten ns a tet.
  void gather(TetComplex& complex, std::uint32_t point);

  std::uint32_t point() const { return point_; }
  const std::vector<std::uint32_t>& tets() const { return tets_; }
  const std::vector<LinkFace>& faces() const { return faces_; } ///< of the tets, in their order
  const std::vector<Sheet>& sheets() const { return sheets_; }
  const std::vector<Spoke>& spokes() const { return spokes_; }
  bool onSurface() const { return !sheets_.empty(); }
  double worstEnergy() const { return worst_; }

private:
  std::uint32_t point_ = TetComplex::kNone;
  std::vector<std::uint32_t> tets_;
  std::vector<LinkFace> faces_;
  std::vector<Sheet> sheets_;
  std::vector<Spoke> spokes_;
  double worst_ = 0;
  std::vector<std::uint32_t> seen_, spokeOf_; // by point
  std::uint32_t round_ = 0;
};

} // namespace tetvdb
