// SPDX-License-Identifier: Apache-2.0
//
// OpenVDB's reader trusts sizes that it reads: a damaged file can overflow a buffer, and one that
// is cut within raw data reads as zeros. This traverses the whole structure of a .vdb file
// beforehand, header by header, without decompressing anything. Internal to the .vdb reader.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb {

/// Throws Error(Invalid) where `bytes` are not a whole .vdb file. Files before version 222 (OpenVDB
/// 3, 2015), grids of other types than KnownGrids and grids under a frustum are checked only so far
/// as their place in the file. Cost: a few dozen nanoseconds a leaf.
void checkVdb(std::string_view bytes, const std::string& path);

} // namespace tetvdb
