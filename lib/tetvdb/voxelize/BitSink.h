// SPDX-License-Identifier: Apache-2.0
//
// A sink that makes the nodes of a BitStack from slabs.
#pragma once

#include "tetvdb/volume/BitSource.h"
#include "tetvdb/voxelize/Slab.h"

#include <memory>

namespace tetvdb {

/// Puts nodes into a stack that has its lowest node at zFirst. Nodes may be given in any order,
/// each once, by one thread; so may the slabs of a node, by several threads at a time.
class BitSink : public NodeSink {
public:
  BitSink(std::int32_t zFirst, BitStack& stack) : zFirst_(zFirst), stack_(stack) {}

  std::unique_ptr<Node> begin(const NodeIndex& node) override;
  void slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) override;
  void end(std::unique_ptr<Node> node) override;
  void fullRun(std::int32_t x, std::int32_t y, std::int32_t zBegin, std::int32_t zEnd) override;
  void fullNode(const NodeIndex& node, std::uint32_t owner) override;

private:
  struct OpenNode;
  std::int32_t zFirst_;
  BitStack& stack_;
};

} // namespace tetvdb
