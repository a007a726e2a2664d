// SPDX-License-Identifier: Apache-2.0
//
// The leaves' buffers of a packed grid, taken from the store: the bytes that BufferPieces
// (io/volume/VdbPieces.h) makes of leaves with values. Internal to the .vdb writer.
#pragma once

#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/GridTypes.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

template <class TreeT>
class PackedPieces {
public:
  PackedPieces(const TreeT& tree, const PackedGrid& packed, bool asHalf)
      : packed_(packed), leaves_(NodeLists<TreeT>(tree).leaves()), tails_(leaves_.size()) {
    const T background = tree.background();
    NodeStream out(vdbCompression(), &background);
    for (std::size_t l = 0; l < leaves_.size(); ++l) {
      if (const openvdb::Index32 place = leaves_[l]->transientData(); place > 0) {
        tails_[l] = packed.tails[place - 1];
        missing_ += leaves_[l]->buffer().empty(); // OpenVDB 13 makes some for the box
        continue;
      }
      // A leaf with its values, as openFirstTile() makes it; there are few of them or none.
      out.bytes().clear();
      leaves_[l]->writeBuffers(out.stream(), asHalf);
      tails_[l] = {own_.size(), static_cast<std::uint32_t>(out.bytes().size() - kLeafMaskBytes),
                   static_cast<std::int8_t>(out.bytes()[kLeafMaskBytes])};
      own_.append(out.bytes(), kLeafMaskBytes);
    }
  }

  std::size_t size() const { return (leaves_.size() + kLeavesAPiece - 1) / kLeavesAPiece; }
  std::size_t leafCount() const { return leaves_.size(); }
  /// The bytes by which the tree is smaller than one with values.
  std::size_t missingBytes() const { return missing_ * Leaf::SIZE * sizeof(T); }

  std::string make(std::size_t piece) const {
    const std::size_t begin = piece * kLeavesAPiece;
    const std::size_t end = std::min(begin + kLeavesAPiece, leaves_.size());
    NodeStream out(vdbCompression(), nullptr);
    std::string& bytes = out.bytes();
    std::size_t size = 0;
    for (std::size_t l = begin; l < end; ++l)
      size += kLeafMaskBytes + tails_[l].size;
    bytes.reserve(size);
    for (std::size_t l = begin; l < end; ++l) {
      leaves_[l]->getValueMask().save(out.stream());
      const LeafTail& tail = tails_[l];
      if (leaves_[l]->transientData() == 0) {
        bytes.append(own_, tail.at, tail.size);
        continue;
      }
      bytes.resize(bytes.size() + tail.size);
      packed_.store->read(tail.at, bytes.data() + bytes.size() - tail.size, tail.size);
    }
    return std::move(bytes);
  }

  void describe(openvdb::io::DelayedLoadMetadata& metadata) const {
    metadata.resizeMask(leaves_.size());
    metadata.resizeCompressedSize(leaves_.size());
    for (std::size_t l = 0; l < leaves_.size(); ++l)
      describeTail<T>(metadata, l, tails_[l].restore, tails_[l].size);
  }

private:
  using T = typename TreeT::ValueType;
  using Leaf = typename TreeT::LeafNodeType;
  static constexpr std::size_t kLeavesAPiece = 512;

  const PackedGrid& packed_;
  std::vector<const Leaf*> leaves_;
  std::vector<LeafTail> tails_; ///< in order of the leaves
  std::string own_;             ///< tails of leaves with values
  std::size_t missing_ = 0;     ///< leaves without an array
};

} // namespace tetvdb
