// SPDX-License-Identifier: Apache-2.0
//
// What a GPU takes of an open soup: WindingBand down to cubes as large as leaves, as plain arrays.
// Internal.
#pragma once

#include "nanovdb_kernels/HolesView.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/voxelize/WindingBand.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

class OpenSoup final : public nano::OctantEvaluator {
public:
  /// Finds the leaves, in parallel: 500 bytes each, and 4 for every triangle or cluster that is
  /// near. Both must outlive it. Throws what WindingBand() throws, and Error(Limit) for more than
  /// nano::kMaxWindingLeaves.
  OpenSoup(const TriangleClusters& fill, const Progress& progress);

  /// Refers to this.
  nano::HolesView view();

  void evaluate(const std::uint32_t* octants, std::uint64_t count, bool* needed,
                double* values) override;

private:
  WindingBand::Cube cubeOf(std::size_t leaf) const;

  WindingBand band_;
  std::vector<nano::WindingLeaf> leaves_;
  std::vector<Expansion> far_; // by leaf
  std::vector<std::uint32_t> near_;
  std::array<Vec3d, kExpansionPoints> points_ = WindingBand::octantPoints();
};

} // namespace tetvdb
