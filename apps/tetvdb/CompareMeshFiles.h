// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Session.h"

#include <string>

namespace tetvdb::cli {

/// The part of `compare` for meshes: reads both (tets as their surface), measures, and leaves the
/// section "compare", the text and the status in `session`.
void compareMeshFiles(const std::string& a, const std::string& b, double tolerance,
                      Session& session);

} // namespace tetvdb::cli
