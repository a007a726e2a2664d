// SPDX-License-Identifier: Apache-2.0
//
// Bytes in memory through zlib. Internal.
#pragma once

#include <cstddef>
#include <string>

namespace tetvdb {

/// Compresses bytes to a whole zlib stream.
std::string zlibBytes(const char* bytes, std::size_t size);

} // namespace tetvdb
