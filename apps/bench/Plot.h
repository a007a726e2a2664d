// SPDX-License-Identifier: Apache-2.0
//
// A case of the benchmark as a picture, SVG.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::bench {

/// Times on a logarithmic axis: bars with their min and max time and the floor as a mark,
/// or, where the case says along what (Tables::begin), curves. Empty for a case without rows.
std::string plot(const nlohmann::ordered_json& entry);

} // namespace tetvdb::bench
