// SPDX-License-Identifier: Apache-2.0
//
// What reports say about the envelope mesher's tets.
#pragma once

#include "tetvdb/pipeline/MeshSummary.h"

#include <nlohmann/json.hpp>
#include <string>

namespace tetvdb::cli {

/// The report's "mesh".
nlohmann::ordered_json toJson(const MeshSummary& mesh);

/// For people: a line about size and quality, one about what was asked and reached.
std::string textOf(const MeshSummary& mesh);

} // namespace tetvdb::cli
