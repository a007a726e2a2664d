// SPDX-License-Identifier: Apache-2.0
//
// A volume that has only tiles, with one of them opened to a leaf.
#pragma once

#include "tetvdb/volume/BitSource.h"

#include <vector>

namespace tetvdb {

/// The result of openFirstTile() (volume/Grids.h) for `source`, which has no leaf.
class OpenedSource : public BitSource {
public:
  /// `tile`: the first voxel of the tile. `source` must outlive it.
  OpenedSource(BitSource& source, const Vec3i& tile);

  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t cube) override;
  void fill(int stack, BitStack& out) override;

private:
  BitSource& source_;
  std::vector<RootCube> cubes_;
  std::size_t cube_ = 0;
  std::size_t openedCube_ = 0, openedNode_ = 0, openedEntry_ = 0;
  int openedStack_ = 0;
};

} // namespace tetvdb
