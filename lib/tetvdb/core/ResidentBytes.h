// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace tetvdb {

/// Bytes of this process that are in memory, mapped files included; 0 where the system does not
/// say.
std::size_t residentBytes() noexcept;

} // namespace tetvdb
