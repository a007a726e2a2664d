// SPDX-License-Identifier: Apache-2.0
//
// What to do about a file that cannot be read: for the end of messages (core/Error.h).
#pragma once

namespace tetvdb {

constexpr const char* kCut = "the file is damaged or cut off; export it again";
constexpr const char* kExport = "repair the file or export it again";

} // namespace tetvdb
