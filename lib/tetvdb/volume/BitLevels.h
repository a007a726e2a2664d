// SPDX-License-Identifier: Apache-2.0
//
// The levels of detail of voxels that are inside or not, counted while a writer takes these
// (volume/BitSource.h).
#pragma once

#include "tetvdb/volume/BitSource.h"
#include "tetvdb/volume/LevelBuilder.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace tetvdb {

/// Passes on what another source has. Memory: that of the coarser trees.
class BitLevels : public BitSource {
public:
  /// As addLevels(). `source` must outlive it.
  BitLevels(BitSource& source, const LevelRange& levels, std::size_t maxMemory);

  const std::vector<RootCube>& cubes() const override { return source_.cubes(); }
  /// Cubes come in their order; an earlier one begins another pass, and the count anew.
  std::vector<int> begin(std::size_t cube) override;
  void fill(int stack, BitStack& out) override;

  /// When all cubes were passed on: for each of `grids`, which all have these voxels, the grids of
  /// the levels, in that order.
  openvdb::GridPtrVec finish(const openvdb::GridPtrVec& grids);

private:
  using Builder = LevelBuilder<openvdb::FloatTree, double>;

  void restart();
  void endCube();

  BitSource& source_;
  LevelRange levels_;
  std::size_t maxMemory_;
  std::optional<Builder> builder_;
  std::optional<std::size_t> cube_; ///< under way
  std::size_t next_ = 0;            ///< the first cube that may come in this pass
  Builder::RootChild child_;
};

} // namespace tetvdb
