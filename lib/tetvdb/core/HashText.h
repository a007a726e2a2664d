// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <string>
#include <xxhash.h>

namespace tetvdb {

/// 32 hexadecimal digits.
inline std::string textOf(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace tetvdb
