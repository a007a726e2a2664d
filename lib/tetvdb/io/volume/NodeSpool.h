// SPDX-License-Identifier: Apache-2.0
//
// Nodes of one level of a NanoVDB grid on their way into a file: compressed, in memory up to a
// limit, and beyond it in a temporary file without a name. They can be read any number of times.
#pragma once

#include "tetvdb/io/volume/NanoNodes.h"
#include "tetvdb/io/volume/TailStore.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

class NodeSpool {
public:
  /// Some nodes, as they are stored.
  struct Packed {
    std::string bytes;
    std::uint32_t size = 0; ///< unpacked
    std::uint64_t nodes = 0;
    std::uint64_t children = 0; ///< of these nodes
  };
  /// Some nodes that are stored.
  struct Piece {
    std::uint64_t at;
    std::uint32_t packed, size;
    std::uint64_t firstNode, firstChild; ///< how many there are before these
  };

  NodeSpool(const std::string& folder, std::size_t inMemory) : store_(folder, inMemory) {}

  /// At most 900 KB. Thread-safe.
  static Packed pack(const unsigned char* nodes, std::size_t size, std::uint64_t count,
                     std::uint64_t children);
  /// Throws Error(Write).
  void add(const Packed& nodes);
  const std::vector<Piece>& pieces() const { return pieces_; }
  std::uint64_t count() const { return nodes_; }
  /// Thread-safe, except with add(). Throws Error(Write).
  NodeMemory read(const Piece& piece) const;
  /// Gives back the room of all pieces before this one, which are not read again.
  void release(const Piece& piece) { store_.release(piece.at); }

private:
  TailStore store_;
  std::vector<Piece> pieces_;
  std::uint64_t nodes_ = 0, children_ = 0;
};

} // namespace tetvdb
