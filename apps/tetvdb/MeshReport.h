// SPDX-License-Identifier: Apache-2.0
//
// The text about the envelope mesher's tets.
#pragma once

#include "tetvdb/pipeline/MeshSummary.h"

#include <string>

namespace tetvdb::cli {

/// A line about size and quality, and one about requested and reached quality.
std::string textOf(const MeshSummary& mesh);

} // namespace tetvdb::cli
