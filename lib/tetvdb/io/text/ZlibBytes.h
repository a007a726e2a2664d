// SPDX-License-Identifier: Apache-2.0
//
// Bytes in memory through zlib. Internal.
#pragma once

#include <cstddef>
#include <string>

namespace tetvdb {

/// A whole zlib stream of them.
std::string zlibBytes(const char* bytes, std::size_t size);

} // namespace tetvdb
