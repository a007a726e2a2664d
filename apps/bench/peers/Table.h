// SPDX-License-Identifier: Apache-2.0
//
// Tables and numbers in words.
#pragma once

#include <string>
#include <vector>

namespace tetvdb::bench {

/// Aligned Markdown; the first line is the heading, columns but the first two are right-aligned.
std::string markdown(const std::vector<std::vector<std::string>>& lines);

/// "1.23 s", "12 ms".
std::string duration(double seconds);
/// "1.23 GB", "45.6 MB".
std::string size(double bytes);

} // namespace tetvdb::bench
