// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/BitTopology.h"

namespace tetvdb {

bool BitTopology::next(Piece& piece) {
  while (word_ < upper_.children.size() && upper_.children[word_] == 0)
    ++word_;
  if (word_ == upper_.children.size()) {
    if (uppers_ == 0)
      return false;
    --uppers_;
    read(&upperOrigin_, 1);
    read(&upper_, 1);
    at_ += codec_.upperValues(countBits(upper_.tiles));
    word_ = 0;
    piece.origin = upperOrigin_;
    piece.upper = std::make_unique<UpperMasks>(upper_);
    return true;
  }
  std::uint64_t& bits = upper_.children[word_];
  const auto entry = static_cast<std::int32_t>(word_) * 64 + __builtin_ctzll(bits);
  bits &= bits - 1;
  piece.origin = {upperOrigin_[0] + (entry >> 10) * 128, upperOrigin_[1] + (entry >> 5 & 31) * 128,
                  upperOrigin_[2] + (entry & 31) * 128};
  piece.upper.reset();
  BitNode& node = piece.node;
  read(node.children.data(), node.children.size());
  read(node.tiles.data(), node.tiles.size());
  at_ += codec_.lowerValues(countBits(node.tiles));
  node.leaves.resize(countBits(node.children) * 8);
  read(node.leaves.data(), node.leaves.size());
  return true;
}

} // namespace tetvdb
