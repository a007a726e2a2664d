// SPDX-License-Identifier: Apache-2.0
//
// Converts solid shares of pixels to grey levels.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace tetvdb {

struct GreyOptions {
  int levels = 256; ///< 2 to 256, evenly spaced from 0 to 255
  double gamma = 1; ///< the share is first raised to this power; 0: 1 from a half on, else 0
  std::optional<std::array<std::uint8_t, 256>> table; ///< finally replaces each level
};

/// Grey levels of shares. A share is an integer number of parts of kWhole. By default the level is
/// round(255 share), halves rounded up, computed in integers. Thread-safe.
class GreyLevels {
public:
  static constexpr std::int64_t kWhole = std::int64_t(1) << 46;

  /// Throws Error(Usage) for options out of range.
  explicit GreyLevels(const GreyOptions& options = {});

  /// `share` from 0 to kWhole.
  std::uint8_t of(std::int64_t share) const {
    return plain_ ? static_cast<std::uint8_t>((share * 255 + kWhole / 2) >> 46) : mapped(share);
  }

private:
  std::uint8_t mapped(std::int64_t share) const;

  GreyOptions options_;
  bool plain_ = true;
};

} // namespace tetvdb
