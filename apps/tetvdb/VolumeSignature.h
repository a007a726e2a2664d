// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace tetvdb::cli {

enum class VolumeSignature : std::uint8_t { None, OpenVDB, NanoVDB };

/// Tells volumes from everything else by a file's first bytes; None for a file that cannot be read.
VolumeSignature signatureOf(const std::string& path);

} // namespace tetvdb::cli
