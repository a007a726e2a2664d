// SPDX-License-Identifier: Apache-2.0
//
// The metadata entry file_delayed_load: of each leaf how its inactive values are restored, and the
// bytes of its values. It comes before the leaves.
#pragma once

#include <algorithm>
#include <cstddef>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// Whether the entry is written without compression: where the values of some leaves, sizeOf(leaf)
/// bytes each, let 64 MB be expected in all, and 512 a leaf. Its size, 9 bytes a leaf, follows from
/// their number then: a writer reserves it, and need not keep values until all sizes are known.
template <class SizeOf>
bool isDelayedLoadPlain(std::size_t leaves, const SizeOf& sizeOf) {
  constexpr std::size_t kSampled = 256, kFew = 4096; // leaves
  constexpr double kManyBytes = 64 << 20, kBytesALeaf = 512;
  if (leaves < kFew)
    return false;
  double bytes = 0, sampled = 0;
  for (std::size_t l = 0; l < leaves; l += leaves / kSampled, ++sampled)
    bytes += static_cast<double>(sizeOf(l));
  const auto count = static_cast<double>(leaves);
  return bytes / sampled * count > std::max(kManyBytes, kBytesALeaf * count);
}

/// Adds the entry, compressed or not.
void insertDelayedLoad(openvdb::MetaMap& metadata, const openvdb::io::DelayedLoadMetadata& entries,
                       std::size_t leaves);

/// Adds an entry of the size of one that is not compressed.
void reserveDelayedLoad(openvdb::MetaMap& metadata, std::size_t leaves);

} // namespace tetvdb
