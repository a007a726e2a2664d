// SPDX-License-Identifier: Apache-2.0
//
// Memory of the nodes of a tree.
#pragma once

#include "tetvdb/volume/GridTypes.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>

namespace tetvdb {

struct NodeBytes {
  std::size_t root, upper, lower, leaf;

  std::uint64_t of(std::uint64_t uppers, std::uint64_t lowers, std::uint64_t leaves) const {
    return root + uppers * upper + lowers * lower + leaves * leaf;
  }
};

/// As OpenVDB counts it in a file's metadata.
template <class TreeT>
NodeBytes openvdbNodeBytes() {
  using Lists = NodeLists<TreeT>;
  using Leaf = typename TreeT::LeafNodeType;
  const auto internal = [](const auto& node) {
    using Node = std::decay_t<decltype(node)>;
    return Node::NUM_VALUES * sizeof(typename Node::UnionType) + node.getChildMask().memUsage() +
           node.getValueMask().memUsage() + sizeof(openvdb::Coord);
  };
  const Leaf leaf(openvdb::Coord(0), openvdb::zeroVal<typename TreeT::ValueType>(), false);
  return {sizeof(typename TreeT::RootNodeType) + sizeof(TreeT),
          internal(*std::make_unique<typename Lists::Upper>()),
          internal(*std::make_unique<typename Lists::Lower>()),
          static_cast<std::size_t>(leaf.memUsage())};
}

/// As describe() counts it.
template <class TreeT>
NodeBytes describedNodeBytes() {
  using Lists = NodeLists<TreeT>;
  return {sizeof(TreeT), sizeof(typename Lists::Upper), sizeof(typename Lists::Lower),
          openvdbNodeBytes<TreeT>().leaf};
}

} // namespace tetvdb
