// SPDX-License-Identifier: Apache-2.0
//
// The library knows settings, not options: its texts (errors, warnings, findings, verdicts) name a
// setting between backquotes, as `max_memory`, or with a value as `mesher=winding`. On the command
// line these are --max-memory and --mesher winding.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb::cli {

/// `text` with each setting between backquotes spelled as an option. Whatever else stands between
/// backquotes stays.
std::string withOptionNames(std::string_view text);

} // namespace tetvdb::cli
