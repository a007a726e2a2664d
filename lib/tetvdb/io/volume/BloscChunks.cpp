// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/BloscChunks.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/NvdbLayout.h"

#include <algorithm>
#include <blosc.h>
#include <cstring>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace tetvdb {
namespace {

constexpr std::size_t kMostBlocks = 32; // that are compressed at once
constexpr std::size_t kHeadBytes = 16;  // of a buffer of Blosc: four bytes, then three numbers
constexpr std::size_t kSplitBytes = 8 * sizeof(std::int32_t); // a block's sizes of its parts
using Bytes = std::vector<unsigned char>;

std::uint32_t numberAt(const Bytes& bytes, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// A buffer of Blosc. One thread: with more, the order of blocks in it depends on which ends first.
Bytes compress(const unsigned char* data, std::size_t size, std::size_t spare) {
  Bytes packed(size + BLOSC_MAX_OVERHEAD + spare);
  const int count =
      blosc_compress_ctx(9, BLOSC_SHUFFLE, sizeof(float), size, data, packed.data(), packed.size(),
                         BLOSC_LZ4_COMPNAME, BloscChunks::kAskedBlock, 1);
  if (count <= 0)
    throw Error(Status::Write, "", "Blosc could not compress a grid");
  packed.resize(static_cast<std::size_t>(count));
  return packed;
}

// Blosc takes larger blocks than it is asked for; how large depends on its version.
std::size_t blockSize() {
  static const std::size_t size = [] {
    const Bytes zeros(std::size_t(1) << 23);
    return numberAt(compress(zeros.data(), zeros.size(), 0), 8);
  }();
  return size;
}

// One block as it lies in a buffer of several; `head`: that of the buffer.
Bytes compressBlock(const unsigned char* data, std::size_t size, std::size_t block, Bytes* head) {
  constexpr std::size_t kSpare = 2 * (sizeof(std::int32_t) + kSplitBytes);
  Bytes all(data, data + size);
  if (size < block) // the last one of a buffer is compressed in another way
    all.insert(all.begin(), block, 0);
  Bytes packed = compress(all.data(), all.size(), kSpare);
  if (head != nullptr)
    head->assign(packed.begin(), packed.begin() + kHeadBytes);
  const std::size_t last = all.size() / (block + 1);
  packed.erase(packed.begin(),
               packed.begin() + numberAt(packed, kHeadBytes + last * sizeof(std::int32_t)));
  return packed;
}

} // namespace

BloscChunks::BloscChunks(AtomicFile& file, std::uint64_t size)
    : file_(file), block_(blockSize()),
      batch_(block_ * std::min(kMostBlocks, 2 * static_cast<std::size_t>(
                                                    tbb::this_task_arena::max_concurrency()))),
      left_(size) {
  buffer_.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(size, batch_)));
  beginChunk();
}

void BloscChunks::beginChunk() {
  chunk_ = std::min(left_, kNvdbChunk);
  left_ -= chunk_;
  chunkBytes_ = static_cast<std::uint32_t>(chunk_);
  chunkAt_ = file_.size();
  blocks_.clear();
  if (chunk_ <= block_)
    return;
  // Its size, its head and the table of its blocks, which are known at its end.
  const Bytes place(sizeof(std::uint64_t) + kHeadBytes +
                    (chunk_ + block_ - 1) / block_ * sizeof(std::int32_t));
  file_.write(place.data(), place.size());
}

void BloscChunks::write(const void* data, std::size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  while (size > 0) {
    const auto room =
        static_cast<std::size_t>(std::min<std::uint64_t>(batch_, chunk_) - buffer_.size());
    const std::size_t now = std::min(room, size);
    buffer_.insert(buffer_.end(), bytes, bytes + now);
    bytes += now;
    size -= now;
    if (now == room)
      flush();
  }
}

void BloscChunks::flush() {
  if (chunk_ == buffer_.size() && blocks_.empty() && chunk_ <= block_) {
    const Bytes packed = compress(buffer_.data(), buffer_.size(), 0);
    const std::uint64_t size = packed.size();
    file_.write(&size, sizeof size);
    file_.write(packed.data(), packed.size());
    chunk_ = 0;
  } else {
    std::vector<Bytes> packed((buffer_.size() + block_ - 1) / block_);
    const bool first = blocks_.empty();
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(std::size_t(0), packed.size(), [&](std::size_t i) {
        packed[i] = compressBlock(buffer_.data() + i * block_,
                                  std::min(block_, buffer_.size() - i * block_), block_,
                                  first && i == 0 ? &head_ : nullptr);
      });
    });
    for (const Bytes& block : packed) {
      blocks_.push_back(
          static_cast<std::uint32_t>(file_.size() - chunkAt_ - sizeof(std::uint64_t)));
      file_.write(block.data(), block.size());
    }
    chunk_ -= buffer_.size();
    if (chunk_ == 0)
      endChunk();
  }
  buffer_.clear();
  if (chunk_ == 0 && left_ > 0)
    beginChunk();
}

void BloscChunks::endChunk() {
  const std::uint64_t packed = file_.size() - chunkAt_ - sizeof packed;
  const std::uint32_t sizes[3] = {chunkBytes_, static_cast<std::uint32_t>(block_),
                                  static_cast<std::uint32_t>(packed)};
  std::memcpy(head_.data() + 4, sizes, sizeof sizes);
  file_.writeAt(chunkAt_, &packed, sizeof packed);
  file_.writeAt(chunkAt_ + sizeof packed, head_.data(), head_.size());
  file_.writeAt(chunkAt_ + sizeof packed + kHeadBytes, blocks_.data(),
                blocks_.size() * sizeof blocks_[0]);
}

} // namespace tetvdb
