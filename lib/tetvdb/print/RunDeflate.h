// SPDX-License-Identifier: Apache-2.0
//
// zlib streams (RFC 1950, RFC 1951) out of runs of equal bytes, in time that follows the runs and
// not the bytes.
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

/// One block with a code of its own: single bytes, and runs as matches one byte back, which the
/// code makes as short as deflate allows (2 bits for 258 bytes). The same bytes for the same
/// sequence, however it is cut into runs. Memory: 16 bytes a run, and the result. For one thread at
/// a time.
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

  /// The whole stream; what was added is forgotten.
  std::string finish();

private:
  struct Run {
    std::uint64_t count;
    std::uint8_t value;
  };
  std::vector<Run> runs_;
};

/// Adler's checksum (RFC 1950) of bytes that come in runs.
class RunAdler {
public:
  void add(std::uint8_t value, std::uint64_t count);
  std::uint32_t sum() const { return b_ << 16 | a_; }

private:
  std::uint32_t a_ = 1, b_ = 0;
};

} // namespace tetvdb
