// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/arrays/GzipStream.h"

#include <algorithm>
#include <array>
#include <new>

namespace tetvdb {
namespace {

constexpr int kGzip = 15 + 16; // zlib: the largest window, with gzip's header
constexpr int kMemory = 8;     // zlib's default
constexpr std::size_t kOnce = std::size_t(1) << 30;

} // namespace

GzipStream::GzipStream(AtomicFile& file) : file_(file) {
  if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

GzipStream::~GzipStream() {
  deflateEnd(&stream_);
}

void GzipStream::write(const char* bytes, std::size_t size) {
  for (std::size_t at = 0; at < size; at += kOnce)
    pack(bytes + at, std::min(kOnce, size - at), Z_NO_FLUSH);
}

void GzipStream::finish() {
  pack(nullptr, 0, Z_FINISH);
}

void GzipStream::pack(const char* bytes, std::size_t size, int flush) {
  stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes));
  stream_.avail_in = static_cast<uInt>(size);
  std::array<Bytef, 65536> packed;
  do {
    stream_.next_out = packed.data();
    stream_.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream_, flush);
    file_.write(packed.data(), packed.size() - stream_.avail_out);
  } while (stream_.avail_out == 0);
}

} // namespace tetvdb
