// SPDX-License-Identifier: Apache-2.0
//
// A bounds-checked cursor over binary data in either byte order.
//
//   tetvdb::ByteReader in(source);
//   in.setSwap(in.get<std::int32_t>() == 0x01000000);   // the writer had the other byte order
//   const std::size_t n = in.checkCount(in.get<std::uint64_t>(), 8, "nodes");
//   std::vector<double> values(n);
//   in.read<double>(values.data(), n);
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tetvdb {

/// The bytes of a number in reverse order.
template <class T>
inline T byteSwapped(T value) {
  static_assert(std::is_arithmetic_v<T>);
  if constexpr (sizeof(T) == 2) {
    std::uint16_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bits = __builtin_bswap16(bits);
    std::memcpy(&value, &bits, sizeof bits);
  } else if constexpr (sizeof(T) == 4) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bits = __builtin_bswap32(bits);
    std::memcpy(&value, &bits, sizeof bits);
  } else if constexpr (sizeof(T) == 8) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    bits = __builtin_bswap64(bits);
    std::memcpy(&value, &bits, sizeof bits);
  } else {
    static_assert(sizeof(T) == 1);
  }
  return value;
}

/// The number of type T at `at`, which need not be aligned.
template <class T>
inline T loadNumber(const char* at, bool swap) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return swap ? byteSwapped(value) : value;
}

/// Methods throw Error(Invalid) with "path at byte N". Not thread-safe; several readers may share
/// one source, whose bytes must outlive them.
class ByteReader {
public:
  /// `swap`: numbers are in the byte order opposite to this machine's.
  explicit ByteReader(const Source& source, bool swap = false, std::size_t begin = 0)
      : ByteReader(source.bytes, source.path, swap, begin) {}
  ByteReader(std::string_view bytes, std::string path, bool swap = false, std::size_t begin = 0)
      : bytes_(bytes), path_(std::move(path)), at_(std::min(begin, bytes.size())), swap_(swap) {}

  void setSwap(bool swap) { swap_ = swap; }
  bool swap() const { return swap_; }

  std::size_t position() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  /// Throws beyond the end.
  void seek(std::uint64_t position) {
    if (position > bytes_.size())
      fail("refers to byte " + std::to_string(position) + ", beyond the file's end", kCut);
    at_ = static_cast<std::size_t>(position);
  }
  void skip(std::uint64_t bytes) { take(bytes); }

  /// The next `bytes` bytes.
  std::string_view take(std::uint64_t bytes) {
    if (bytes > remaining())
      fail("the file ends " + std::to_string(bytes - remaining()) + " bytes early", kCut);
    const std::string_view found = bytes_.substr(at_, static_cast<std::size_t>(bytes));
    at_ += found.size();
    return found;
  }
  /// The next number of type T.
  template <class T>
  T get() {
    return loadNumber<T>(take(sizeof(T)).data(), swap_);
  }
  /// The next `n` numbers of type T, converted to U, into `out`.
  template <class T, class U>
  void read(U* out, std::size_t n) {
    const char* from = take(checkCount(n, sizeof(T), "numbers") * sizeof(T)).data();
    if (std::is_same_v<T, U> && !swap_) {
      if (n > 0)
        std::memcpy(out, from, n * sizeof(T));
      return;
    }
    if (swap_)
      for (std::size_t i = 0; i < n; ++i)
        out[i] = static_cast<U>(loadNumber<T>(from + i * sizeof(T), true));
    else
      for (std::size_t i = 0; i < n; ++i)
        out[i] = static_cast<U>(loadNumber<T>(from + i * sizeof(T), false));
  }

  /// Returns `n` after checking that as many elements of `bytesEach` bytes are left. Safe for
  /// reserve(). Also accepts signed numbers, and refuses negative ones.
  template <class Count>
  std::size_t checkCount(Count n, std::size_t bytesEach, std::string_view things) const {
    if constexpr (std::is_signed_v<Count>)
      if (n < 0)
        fail("negative number of " + std::string(things));
    const auto wide = static_cast<std::uint64_t>(n);
    if (wide > remaining() / std::max<std::size_t>(bytesEach, 1))
      fail(std::to_string(wide) + " " + std::string(things) +
               " are declared, more than the file holds",
           kCut);
    return static_cast<std::size_t>(wide);
  }

  /// "path at byte N".
  std::string where() const { return path_ + " at byte " + std::to_string(at_); }
  const std::string& path() const { return path_; }
  [[noreturn]] void fail(std::string_view what, std::string_view advice = {}) const {
    throw Error(Status::Invalid, where(), what, advice);
  }

private:
  std::string_view bytes_;
  std::string path_;
  std::size_t at_;
  bool swap_;
};

} // namespace tetvdb
