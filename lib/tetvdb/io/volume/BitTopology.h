// SPDX-License-Identifier: Apache-2.0
//
// Reads back, node by node, the topology of a grid that BitVdbWriter writes.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/volume/BitCodec.h"

#include <cstdint>
#include <memory>

namespace tetvdb {

class BitTopology {
public:
  /// `at`: where the first of so many upper nodes begins. All must outlive it; the file is flushed.
  BitTopology(const AtomicFile& file, std::uint64_t at, const BitCodec& codec, std::uint64_t uppers)
      : file_(file), codec_(codec), at_(at), uppers_(uppers) {}

  struct Piece {
    Vec3i origin{};                    ///< the node's first voxel
    std::unique_ptr<UpperMasks> upper; ///< null: a lower node
    BitNode node;
  };
  /// The next node in the order of the file; false at the end. Throws Error(Write).
  bool next(Piece& piece);

private:
  template <class T>
  void read(T* to, std::size_t count) {
    file_.readAt(at_, to, count * sizeof(T));
    at_ += count * sizeof(T);
  }

  const AtomicFile& file_;
  const BitCodec& codec_;
  std::uint64_t at_;
  std::uint64_t uppers_; ///< left
  Vec3i upperOrigin_{};
  UpperMasks upper_;
  std::size_t word_ = 512; ///< of upper_.children, of which bits are taken away
};

} // namespace tetvdb
