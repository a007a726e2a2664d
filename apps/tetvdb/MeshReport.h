// SPDX-License-Identifier: Apache-2.0
//
// What is said for people about the envelope mesher's tets.
#pragma once

#include "tetvdb/pipeline/MeshSummary.h"

#include <string>

namespace tetvdb::cli {

/// A line about size and quality, one about what was asked and reached.
std::string textOf(const MeshSummary& mesh);

} // namespace tetvdb::cli
