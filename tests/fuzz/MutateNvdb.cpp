// SPDX-License-Identifier: Apache-2.0
//
// The mutator of FuzzNvdb: the bytes of a grid lie compressed in the file and under a checksum, so
// that changes of the file hardly reach what reads them. Here the grid is unpacked, changed, left
// without a checksum and packed again.
#include "MutateNumber.h"
#include "tetvdb/io/volume/NvdbLayout.h"

#include <blosc.h>
#include <cstring>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace tetvdb {
namespace {

constexpr std::size_t kMost = std::size_t(4) << 20; ///< bytes of a grid that is unpacked

/// Changes the only grid of a file that Blosc has packed. The new size; 0 where it is no such file.
std::size_t mutateGrid(std::uint8_t* data, std::size_t size, std::size_t most,
                       std::minstd_rand& random) {
  NvdbHeader header;
  NvdbEntry entry;
  std::size_t at = sizeof header + sizeof entry;
  if (size < at)
    return 0;
  std::memcpy(&header, data, sizeof header);
  std::memcpy(&entry, data + sizeof header, sizeof entry);
  if (header.gridCount != 1 || header.codec != NvdbCodec::Blosc || entry.gridSize > kMost ||
      entry.gridSize < sizeof(NvdbGrid) || entry.nameSize > size - at)
    return 0;
  at += entry.nameSize;
  std::uint64_t packed = 0;
  if (size - at < sizeof packed)
    return 0;
  std::memcpy(&packed, data + at, sizeof packed);
  at += sizeof packed;
  std::size_t claimed = 0;
  std::vector<std::uint8_t> grid(entry.gridSize);
  if (packed > size - at || blosc_cbuffer_validate(data + at, packed, &claimed) < 0 ||
      claimed != grid.size() ||
      blosc_decompress_ctx(data + at, grid.data(), grid.size(), 1) != static_cast<int>(claimed))
    return 0;
  for (auto changes = 1 + random() % 3; changes > 0; --changes)
    fuzz::mutateNumber(grid.data(), grid.size(), sizeof(NvdbGrid) + 128, random);
  const std::uint64_t noChecksum = ~0ULL;
  std::memcpy(grid.data() + 8, &noChecksum, sizeof noChecksum);
  const int made =
      blosc_compress_ctx(1, 1, 1, grid.size(), grid.data(), data + at, most - at, "lz4", 0, 1);
  if (made <= 0)
    return 0;
  packed = static_cast<std::uint64_t>(made);
  std::memcpy(data + at - sizeof packed, &packed, sizeof packed);
  return at + packed;
}

} // namespace
} // namespace tetvdb

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  if (random() % 4 != 0) {
    std::vector<std::uint8_t> changed(data, data + size);
    changed.resize(most);
    if (const std::size_t made = tetvdb::mutateGrid(changed.data(), size, most, random)) {
      std::memcpy(data, changed.data(), made);
      return made;
    }
  }
  return LLVMFuzzerMutate(data, size, most);
}
