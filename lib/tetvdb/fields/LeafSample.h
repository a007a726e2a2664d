// SPDX-License-Identifier: Apache-2.0
//
// The active voxels of a leaf, the tets that own them, and their weights: computed once for all
// fields. Internal.
#pragma once

#include "tetvdb/geometry/TetWeights.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetvdb {

class LeafSample {
public:
  static constexpr std::size_t kVoxels = 512;

  /// `weights`: whether slotWeights() and voxel weights are used.
  LeafSample(const SnappedMesh& mesh, bool weights) : mesh_(&mesh), weights_(weights) {
    if (weights)
      frames_.resize(kVoxels);
  }

  /// Begins a leaf whose first voxel is (x, y, z).
  void begin(std::int32_t x, std::int32_t y, std::int32_t z) {
    origin_ = {x, y, z};
    count_ = slots_ = 0;
    last_ = kNone;
    if (++stamp_ == 0) {
      stamps_.fill(0);
      stamp_ = 1;
    }
  }

  /// Adds the voxel with `offset` (64 x + 8 y + z) in the leaf, owned by `tet`.
  void add(std::uint32_t offset, std::uint32_t tet) {
    if (tet != last_) {
      last_ = tet;
      lastSlot_ = slotFor(tet);
    }
    offsets_[count_] = static_cast<std::uint16_t>(offset);
    slotOf_[count_] = lastSlot_;
    if (weights_)
      weightsOf_[count_] =
          frames_[lastSlot_].at(origin_[0] + static_cast<std::int32_t>(offset >> 6),
                                origin_[1] + static_cast<std::int32_t>(offset >> 3 & 7),
                                origin_[2] + static_cast<std::int32_t>(offset & 7));
    ++count_;
  }

  std::size_t count() const { return count_; } ///< voxels
  std::size_t slots() const { return slots_; } ///< distinct tets
  std::uint32_t offset(std::size_t voxel) const { return offsets_[voxel]; }
  /// Of all voxels, ascending.
  const std::uint16_t* offsets() const { return offsets_.data(); }
  std::size_t slot(std::size_t voxel) const { return slotOf_[voxel]; }
  /// Of the second to fourth corner of the tet by position.
  const std::array<double, 3>& weights(std::size_t voxel) const { return weightsOf_[voxel]; }
  std::uint32_t tet(std::size_t slot) const { return tets_[slot]; }
  /// Point `corner`, by position, of that tet.
  std::uint32_t point(std::size_t slot, std::size_t corner) const {
    return mesh_->tets[4 * std::size_t(tets_[slot]) + frames_[slot].corners()[corner]];
  }
  /// The index in the tet, 0 to 3, of its corner `corner` by position.
  std::size_t place(std::size_t slot, std::size_t corner) const {
    return frames_[slot].corners()[corner];
  }
  const std::array<std::int32_t, 3>& origin() const { return origin_; }

private:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;
  static constexpr std::uint32_t kTable = 1024; // a power of two, above kVoxels

  std::uint16_t slotFor(std::uint32_t tet) {
    std::uint32_t at = tet * 2654435769u >> 22;
    while (stamps_[at] == stamp_) {
      if (tets_[slotAt_[at]] == tet)
        return slotAt_[at];
      at = (at + 1) & (kTable - 1);
    }
    const auto slot = static_cast<std::uint16_t>(slots_++);
    stamps_[at] = stamp_;
    slotAt_[at] = slot;
    tets_[slot] = tet;
    if (weights_)
      frames_[slot] = TetWeights(mesh_->points.data(), mesh_->tets + 4 * std::size_t(tet));
    return slot;
  }

  const SnappedMesh* mesh_;
  bool weights_;
  std::array<std::int32_t, 3> origin_{};
  std::size_t count_ = 0, slots_ = 0;
  std::array<std::uint16_t, kVoxels> offsets_, slotOf_;
  std::array<std::array<double, 3>, kVoxels> weightsOf_;
  std::array<std::uint32_t, kVoxels> tets_;
  std::vector<TetWeights> frames_;
  // Tets of this leaf: an entry is valid if its stamp is that of the leaf.
  std::array<std::uint32_t, kTable> stamps_{};
  std::array<std::uint16_t, kTable> slotAt_;
  std::uint32_t stamp_ = 0, last_ = kNone;
  std::uint16_t lastSlot_ = 0;
};

} // namespace tetvdb
