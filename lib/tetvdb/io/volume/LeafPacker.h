// SPDX-License-Identifier: Apache-2.0
//
// Converts leaves to the bytes that a .vdb file holds of them. Internal: instantiates OpenVDB's
// streams.
#pragma once

#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/PackedRange.h"

#include <algorithm>
#include <memory>
#include <tbb/enumerable_thread_specific.h>

namespace tetvdb {

/// Packs the leaves of one grid. Thread-safe; not for trees whose leaves hold bits.
template <typename TreeType>
class LeafPacker {
public:
  using Leaf = typename TreeType::LeafNodeType;
  using Value = typename TreeType::ValueType;

  /// `asHalf`: floats are written with 16 bits.
  LeafPacker(const Value& background, bool asHalf, PackedGrid& packed)
      : background_(background), asHalf_(asHalf), packed_(packed),
        locals_([this] { return std::make_unique<Local>(background_); }) {}
  LeafPacker(const LeafPacker&) = delete;
  LeafPacker& operator=(const LeafPacker&) = delete;

  /// Returns the leaf's voxels without its values, which go to the store. Throws Error(Write).
  std::unique_ptr<Leaf> pack(const Leaf& leaf) {
    Local& local = *locals_.local();
    std::string& bytes = local.stream.bytes();
    bytes.clear();
    leaf.writeBuffers(local.stream.stream(), asHalf_);
    LeafTail tail;
    tail.size = static_cast<std::uint32_t>(bytes.size() - kLeafMaskBytes);
    tail.restore = static_cast<std::int8_t>(bytes[kLeafMaskBytes]);
    tail.at = packed_.store->add(bytes.data() + kLeafMaskBytes, tail.size);
    const auto place = packed_.tails.push_back(tail) - packed_.tails.begin();
    auto bare = std::make_unique<Leaf>(openvdb::PartialCreate(), leaf.origin(), background_, false);
    bare->setValueMask(leaf.getValueMask());
    bare->setTransientData(static_cast<openvdb::Index32>(place + 1));
    const Value* values = leaf.buffer().data();
    for (auto i = leaf.getValueMask().beginOn(); i; ++i) {
      const double size = scalarValue(values[i.pos()]);
      local.min = std::min(local.min, size);
      local.max = std::max(local.max, size);
    }
    return bare;
  }

  /// Writes the range of the packed values to the grid; call once, after the last leaf.
  void finish() {
    for (const auto& local : locals_) {
      packed_.min = std::min(packed_.min, local->min);
      packed_.max = std::max(packed_.max, local->max);
    }
  }

private:
  struct Local {
    explicit Local(const Value& background) : stream(vdbCompression(), &background) {}
    NodeStream stream;
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
  };

  Value background_;
  bool asHalf_;
  PackedGrid& packed_;
  tbb::enumerable_thread_specific<std::unique_ptr<Local>> locals_;
};

} // namespace tetvdb
