// SPDX-License-Identifier: Apache-2.0
//
// Makes zlib streams (RFC 1950, RFC 1951) from runs of equal bytes, in time proportional to the
// runs, not the bytes.
//
//   tetvdb::RunDeflate stream;
//   stream.add(0, 1000000);
//   stream.add(255, 3);
//   std::string bytes = stream.finish();
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// One block with a dynamic code: single bytes, and runs as matches one byte back, for which the
/// code has the shortest words of deflate (2 bits for 258 bytes). The bytes depend on the
/// sequence only, not on its division into runs. Memory: 16 bytes per run, and the result. Not
/// thread-safe.
class RunDeflate {
public:
  /// `count` times `value`.
  void add(std::uint8_t value, std::uint64_t count) {
    if (count == 0)
      return;
    if (!runs_.empty() && runs_.back().value == value)
      runs_.back().count += count;
    else
      runs_.push_back({count, value});
  }

  /// Returns the whole stream and clears the input.
  std::string finish();

private:
  struct Run {
    std::uint64_t count;
    std::uint8_t value;
  };
  std::vector<Run> runs_;
};

/// Adler's checksum (RFC 1950) of bytes given as runs.
class RunAdler {
public:
  void add(std::uint8_t value, std::uint64_t count);
  std::uint32_t sum() const { return b_ << 16 | a_; }

private:
  std::uint32_t a_ = 1, b_ = 0;
};

} // namespace tetvdb
