// SPDX-License-Identifier: Apache-2.0
//
// Format: "TIFF Revision 6.0", sections 9 (PackBits) and 13 (LZW).
#include "tetvdb/io/volume/arrays/TiffCodec.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/GunzipBytes.h"

#include <algorithm>
#include <vector>

namespace tetvdb::tiff {
namespace {

[[noreturn]] void failShort(const std::string& path) {
  throw Error(Status::Invalid, path, "a strip of a page is damaged or ends early", kCut);
}

std::string unpackBits(std::string_view packed, std::size_t size, const std::string& path) {
  std::string bytes;
  bytes.reserve(size);
  std::size_t at = 0;
  while (bytes.size() < size) {
    if (at + 1 >= packed.size())
      failShort(path);
    const int n = static_cast<signed char>(packed[at++]);
    if (n >= 0) {
      const auto count = static_cast<std::size_t>(n) + 1;
      if (count > packed.size() - at)
        failShort(path);
      bytes.append(packed.substr(at, count));
      at += count;
    } else if (n != -128) {
      bytes.append(static_cast<std::size_t>(1 - n), packed[at++]);
    }
  }
  bytes.resize(size);
  return bytes;
}

// Codes of 9 to 12 bits, the highest bit first; a code's length grows one code early.
class LzwDecoder {
public:
  LzwDecoder(std::string_view packed, std::size_t size, const std::string& path)
      : packed_(packed), size_(size), path_(path) {}

  std::string run() {
    bytes_.reserve(size_);
    int code = 0;
    while (bytes_.size() < size_ && (code = next()) != kEnd) {
      if (code == kClear) {
        entries_.clear();
        last_ = {};
        continue;
      }
      add(code);
    }
    if (bytes_.size() < size_)
      failShort(path_);
    bytes_.resize(size_);
    return std::move(bytes_);
  }

private:
  static constexpr int kClear = 256, kEnd = 257, kFirst = 258;
  static constexpr std::size_t kMostEntries = 4096 - kFirst;

  // Bytes that are already in the result.
  struct Range {
    std::size_t at = 0, count = 0;
  };

  int next() {
    const std::size_t codes = kFirst + entries_.size();
    const int length = codes >= 2047 ? 12 : codes >= 1023 ? 11 : codes >= 511 ? 10 : 9;
    while (bits_ < length) {
      if (at_ == packed_.size())
        return kEnd;
      word_ = word_ << 8 | static_cast<unsigned char>(packed_[at_++]);
      bits_ += 8;
    }
    bits_ -= length;
    return static_cast<int>(word_ >> bits_ & ((1U << length) - 1));
  }

  // Each code but the first makes an entry: the last code's bytes and one of this one's.
  void add(int code) {
    const std::size_t begin = bytes_.size();
    const bool isNew = last_.count > 0 && entries_.size() < kMostEntries;
    if (isNew)
      entries_.push_back({last_.at, last_.count + 1}); // the bytes after the last are this one's
    if (code < kClear) {
      bytes_ += static_cast<char>(code);
    } else {
      const auto entry = static_cast<std::size_t>(code - kFirst);
      if (entry >= entries_.size())
        failShort(path_);
      const Range from = entries_[entry];
      for (std::size_t i = 0; i < from.count; ++i) // may overlap what it makes
        bytes_ += bytes_[from.at + i];
    }
    last_ = {begin, bytes_.size() - begin};
  }

  std::string_view packed_;
  std::size_t size_;
  const std::string& path_;
  std::string bytes_;
  std::vector<Range> entries_;
  Range last_;
  std::size_t at_ = 0;
  std::uint32_t word_ = 0;
  int bits_ = 0;
};

} // namespace

std::uint64_t largestRatio(std::uint64_t compression) {
  switch (compression) {
  case kNone:
    return 1;
  case kPackBits:
    return 64;
  case kLzw:
    return 4096;
  case kDeflate:
  case kOldDeflate:
    return kBestDeflate;
  default:
    return 0;
  }
}

std::string decompress(std::string_view packed, std::uint64_t compression, std::size_t size,
                       const std::string& path) {
  switch (compression) {
  case kPackBits:
    return unpackBits(packed, size, path);
  case kLzw:
    return LzwDecoder(packed, size, path).run();
  case kDeflate:
  case kOldDeflate:
    return inflateZlib(packed, size, path);
  default:
    if (packed.size() < size)
      failShort(path);
    return std::string(packed.substr(0, size));
  }
}

} // namespace tetvdb::tiff
