// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/NodeSpool.h"

#include "tetvdb/core/Error.h"

#include <blosc.h>

namespace tetvdb {

NodeSpool::Packed NodeSpool::pack(const unsigned char* nodes, std::size_t size, std::uint64_t count,
                                  std::uint64_t children) {
  Packed packed{std::string(size + BLOSC_MAX_OVERHEAD, '\0'), static_cast<std::uint32_t>(size),
                count, children};
  const int bytes =
      blosc_compress_ctx(5, BLOSC_SHUFFLE, sizeof(float), size, nodes, packed.bytes.data(),
                         packed.bytes.size(), BLOSC_LZ4_COMPNAME, 0, 1);
  if (bytes <= 0)
    throw Error(Status::Write, "", "Blosc could not compress a grid");
  packed.bytes.resize(static_cast<std::size_t>(bytes));
  packed.bytes.shrink_to_fit();
  return packed;
}

void NodeSpool::add(const Packed& nodes) {
  pieces_.push_back({store_.add(nodes.bytes.data(), nodes.bytes.size()),
                     static_cast<std::uint32_t>(nodes.bytes.size()), nodes.size, nodes_,
                     children_});
  nodes_ += nodes.nodes;
  children_ += nodes.children;
}

NodeMemory NodeSpool::read(const Piece& piece) const {
  std::string packed(piece.packed, '\0');
  store_.read(piece.at, packed.data(), packed.size());
  NodeMemory nodes(piece.size);
  if (blosc_decompress_ctx(packed.data(), nodes.data(), nodes.size(), 1) !=
      static_cast<int>(nodes.size()))
    throw Error(Status::Write, "", "a temporary file is not what was written to it");
  return nodes;
}

} // namespace tetvdb
