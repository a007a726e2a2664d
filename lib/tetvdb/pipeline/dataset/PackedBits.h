// SPDX-License-Identifier: Apache-2.0
//
// Booleans as numpy.packbits() packs them: the first is the highest bit of the first byte.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

class PackedBits {
public:
  /// `count` of them, all false.
  explicit PackedBits(std::uint64_t count) : bytes_((count + 7) / 8, 0) {}
  /// As many as `flags`; 0 is false.
  explicit PackedBits(const std::vector<std::uint8_t>& flags) : PackedBits(flags.size()) {
    for (std::uint64_t i = 0; i < flags.size(); ++i)
      if (flags[i] != 0)
        set(i);
  }

  void set(std::uint64_t at) { bytes_[at / 8] = static_cast<char>(byte(at) | 0x80u >> at % 8); }
  /// Eight at once, `at` a multiple of 8; the lowest bit of `bits` is the first.
  void setEight(std::uint64_t at, std::uint8_t bits) {
    bits = static_cast<std::uint8_t>((bits & 0xF0) >> 4 | (bits & 0x0F) << 4);
    bits = static_cast<std::uint8_t>((bits & 0xCC) >> 2 | (bits & 0x33) << 2);
    bytes_[at / 8] = static_cast<char>((bits & 0xAA) >> 1 | (bits & 0x55) << 1);
  }
  std::vector<char> takeBytes() && { return std::move(bytes_); }

  /// `count` of them as bytes 0 and 1.
  static std::vector<char> unpacked(const std::vector<char>& bytes, std::uint64_t count) {
    std::vector<char> flags(count);
    for (std::uint64_t i = 0; i < count; ++i)
      flags[i] = static_cast<char>(static_cast<std::uint8_t>(bytes[i / 8]) >> (7 - i % 8) & 1);
    return flags;
  }

private:
  std::uint8_t byte(std::uint64_t at) const { return static_cast<std::uint8_t>(bytes_[at / 8]); }
  std::vector<char> bytes_;
};

} // namespace tetvdb
