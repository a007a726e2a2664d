// SPDX-License-Identifier: Apache-2.0
//
// Occupancy, node by node in the order of a .vdb file, for writers that never hold a whole tree in
// memory.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

constexpr int kStackNodes = 32;                           ///< 128^3 nodes along a 4096^3 cube
constexpr int kStacksPerCube = kStackNodes * kStackNodes; ///< stacks of them along z

/// A 128^3 node. Bits are numbered as OpenVDB numbers the entries of an internal node and the
/// voxels of a leaf: x slowest, z fastest.
struct BitNode {
  std::array<std::uint64_t, 64> children{}; ///< entries that are leaves: neither full nor empty
  std::array<std::uint64_t, 64> tiles{};    ///< entries that are full
  std::vector<std::uint64_t> leaves;        ///< eight words a leaf, in order of the entries
};

/// Bits that are set.
template <std::size_t N>
std::size_t countBits(const std::array<std::uint64_t, N>& words) {
  std::size_t bits = 0;
  for (const std::uint64_t word : words)
    bits += static_cast<std::size_t>(__builtin_popcountll(word));
  return bits;
}

/// Counts the bits of every leaf, eight words each; returns their sum.
std::uint64_t countLeafBits(const std::uint64_t* words, std::size_t leaves, std::uint16_t* bits);

enum class NodeState : std::uint8_t { Empty, Full, Mixed };

/// The 32 nodes of a 4096^3 cube that have the same x and y.
struct BitStack {
  std::array<NodeState, kStackNodes> states{};             ///< by z
  std::array<std::unique_ptr<BitNode>, kStackNodes> nodes; ///< of mixed ones
};

/// A 4096^3 cube of the root node.
struct RootCube {
  Vec3i origin;      ///< voxels
  bool full = false; ///< all of its voxels are inside
};

class BitSource {
public:
  virtual ~BitSource() = default;
  /// All cubes that may hold a voxel, by x, then y, then z. One that is not full can turn out to be
  /// empty, but not to be full.
  virtual const std::vector<RootCube>& cubes() const = 0;
  /// The stacks that may hold a voxel, of a cube that is not full: x * 32 + y, ascending. Must be
  /// called before fill(); costs least if cubes are begun in their order.
  virtual std::vector<int> begin(std::size_t cube) = 0;
  /// Thread-safe for different stacks of the cube that was begun last.
  virtual void fill(int stack, BitStack& out) = 0;
};

} // namespace tetvdb
