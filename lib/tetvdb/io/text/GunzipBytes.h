// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// Deflate makes at most so many bytes of one (zlib's documentation).
constexpr std::uint64_t kBestDeflate = 1032;

/// The first `most` bytes of what a gzip stream holds. Throws Error(Invalid) with `path` for bytes
/// that are damaged or end early.
std::string gunzip(std::string_view bytes, std::size_t most, const std::string& path);

/// The `size` bytes that a zlib stream holds; throws as gunzip().
std::string inflateZlib(std::string_view bytes, std::size_t size, const std::string& path);

} // namespace tetvdb
