// SPDX-License-Identifier: Apache-2.0
//
// Bytes in memory through zlib. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tetvdb {

/// Compresses bytes to a whole zlib stream.
std::string zlibBytes(const char* bytes, std::size_t size);

/// The CRC-32 of zlib and NanoVDB.
std::uint32_t crc32Of(const void* bytes, std::size_t size);

} // namespace tetvdb
