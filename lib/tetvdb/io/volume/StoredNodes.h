// SPDX-License-Identifier: Apache-2.0
//
// The nodes of one child of the root node, kept so that parts of them can be taken one after
// another.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/TailStore.h"
#include "tetvdb/volume/BitSource.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

class StoredNodes {
public:
  /// Takes all nodes of a cube of `source`, in parallel. Beyond `inMemory` bytes they are in a file
  /// in `folder` without a name. Throws Error(Write) and what progress.check() does.
  StoredNodes(BitSource& source, std::size_t cube, const std::string& folder, std::size_t inMemory,
              Progress& progress);

  /// A cube of size^3 voxels, 128 to 2048 along a side, at `origin`, as the source of a whole file.
  class Part : public BitSource {
  public:
    Part(const StoredNodes& nodes, const Vec3i& origin, std::int32_t size);
    bool isEmpty() const { return stacks_.empty(); }
    const std::vector<RootCube>& cubes() const override { return cubes_; }
    std::vector<int> begin(std::size_t) override { return stacks_; }
    void fill(int stack, BitStack& out) override;

  private:
    const StoredNodes& nodes_;
    int zBegin_, zEnd_; ///< nodes
    std::vector<RootCube> cubes_;
    std::vector<int> stacks_;
  };

private:
  struct Place {
    std::uint64_t at = 0; ///< in the store
    std::uint32_t leaves = 0;
    NodeState state = NodeState::Empty;
  };
  void keep(const BitNode& node, Place& place);

  Vec3i origin_;
  std::vector<Place> places_; ///< by stack, then z
  TailStore store_;
};

} // namespace tetvdb
