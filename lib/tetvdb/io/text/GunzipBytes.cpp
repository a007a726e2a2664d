// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/GunzipBytes.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <zlib.h>

namespace tetvdb {
namespace {

constexpr std::size_t kFirstPart = 4096;
constexpr std::size_t kZlibMost = std::size_t(1) << 30; // zlib counts in 32 bits
constexpr int kWindow = 15, kGzip = 16;                 // as inflateInit2() takes them

// `first`: bytes of room at first, which doubles.
std::string inflated(std::string_view bytes, int window, std::size_t first, std::size_t most,
                     const std::string& path) {
  z_stream stream{};
  if (inflateInit2(&stream, window) != Z_OK)
    throw Error(Status::Limit, path, "not enough memory to decompress the file");
  struct End {
    z_stream& stream;
    ~End() { inflateEnd(&stream); }
  } const end{stream};
  std::string text;
  int status = Z_OK;
  while (status != Z_STREAM_END && text.size() < most) {
    if (stream.avail_in == 0) {
      const std::size_t part = std::min(bytes.size(), kZlibMost);
      if (part == 0)
        break;
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
      stream.avail_in = static_cast<uInt>(part);
      bytes.remove_prefix(part);
    }
    const std::size_t before = text.size();
    text.resize(std::min(most, std::max(2 * before, first)));
    const std::size_t room = std::min(text.size() - before, kZlibMost);
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
    stream.avail_out = static_cast<uInt>(room);
    status = inflate(&stream, Z_NO_FLUSH);
    text.resize(before + room - stream.avail_out);
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR)
      break;
  }
  if (status != Z_STREAM_END && text.size() < most)
    throw Error(Status::Invalid, path, "cannot be decompressed", kCut);
  return text;
}

} // namespace

std::string gunzip(std::string_view bytes, std::size_t most, const std::string& path) {
  return inflated(bytes, kWindow + kGzip, kFirstPart, most, path);
}

std::string inflateZlib(std::string_view bytes, std::size_t size, const std::string& path) {
  std::string text = inflated(bytes, kWindow, size, size, path);
  if (text.size() != size)
    throw Error(Status::Invalid, path, "a compressed block is shorter than it should be", kCut);
  return text;
}

} // namespace tetvdb
