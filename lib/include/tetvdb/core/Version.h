// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tetvdb {

/// The library's version, "major.minor.patch".
const char* version() noexcept;

} // namespace tetvdb
