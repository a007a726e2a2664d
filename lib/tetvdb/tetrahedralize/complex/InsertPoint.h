// SPDX-License-Identifier: Apache-2.0
//
// A new point in an edge or a face of the mesh, which stays conforming. The parts of a face that is
// cut have its chain and stay tracked.
#pragma once

#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// Adds to `fresh` the halves of the tets around edge a-b, cut by a new point with the next number.
/// The halves of a face have its chain and stay tracked.
void addEdgeHalves(const TetComplex& complex, const std::vector<std::uint32_t>& around,
                   std::uint32_t a, std::uint32_t b, std::vector<TetComplex::NewTet>& fresh);

/// Serial; keeps scratch memory between calls. Every method returns the new point, or
/// TetComplex::kNone, with nothing changed, where a tet would not stay positive or where tets of
/// another part would have to change.
class PointInsertion {
public:
  explicit PointInsertion(TetComplex& complex) : complex_(complex) {}

  /// In edge a-b, of which `at` should be close to a point.
  std::uint32_t intoEdge(std::uint32_t a, std::uint32_t b, const Vec3d& at);
  /// In the face of tet `t` opposite its corner `localFace`.
  std::uint32_t intoFace(std::uint32_t t, unsigned localFace, const Vec3d& at);

private:
  // To fresh_: tet `t` with the new point in place of a corner.
  void addChild(std::uint32_t t, unsigned corner, std::uint32_t point);
  std::uint32_t commit(const Vec3d& at);

  TetComplex& complex_;
  std::vector<std::uint32_t> old_, ring_;
  std::vector<TetComplex::NewTet> fresh_;
};

} // namespace tetvdb
