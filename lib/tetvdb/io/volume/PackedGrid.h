// SPDX-License-Identifier: Apache-2.0
//
// Grids whose leaves are compressed as soon as they are made, to be written to a .vdb file: in
// memory is only their topology.
//
//   tetvdb::PackedGrid packed;
//   packed.store = std::make_shared<tetvdb::TailStore>("out", 32 << 20);
//   tetvdb::LeafPacker<openvdb::FloatTree> packer(background, half, packed); // LeafPacker.h
//   lower->addLeaf(packer.pack(*leaf).release()); // from any thread
//   ...
//   tetvdb::writeVdb("out/a.vdb", volume, {packed}, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/volume/TailStore.h"
#include "tetvdb/volume/Grids.h"

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tbb/concurrent_vector.h>
#include <vector>

namespace tetvdb {

/// The bytes of a leaf after its mask in a .vdb file: one that says how inactive values are
/// restored, and the compressed active values.
struct LeafTail {
  std::uint64_t at = 0; ///< in the store
  std::uint32_t size = 0;
  std::int8_t restore = 0; ///< its first byte
};

struct PackedGrid {
  /// The tree, with tiles. Leaves have their masks but no values: those of a leaf with
  /// transientData() n > 0 are tails[n - 1]. A leaf with 0 is an ordinary one.
  openvdb::GridBase::Ptr grid;
  tbb::concurrent_vector<LeafTail> tails;
  std::shared_ptr<TailStore> store; ///< several grids can share one
  /// Over the active values of packed leaves, of the length for vectors; min > max where
  /// there are none.
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
};

/// The result of describe() for a grid (volume/Volume.h); `bytes` are those of a tree with its
/// values.
GridInfo describe(const PackedGrid& packed);

/// Writes `volume` and then `packed` to a .vdb file: the bytes that writeVolume() would write if
/// all grids were in `volume`. Throws as writeVolume() does.
void writeVdb(const std::string& path, const Volume& volume,
              const std::vector<std::unique_ptr<PackedGrid>>& packed, Progress& progress);

} // namespace tetvdb
