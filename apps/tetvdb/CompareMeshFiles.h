// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Session.h"
#include "tetvdb/visualize/ComparePicture.h"

#include <string>

namespace tetvdb::cli {

/// The part of `compare` for meshes: reads both (tets as their surface), measures, and leaves the
/// section "compare", the text and the status in `session`. Draws a picture where `output` is not
/// empty.
void compareMeshFiles(const std::string& a, const std::string& b, double tolerance,
                      const std::string& output, Session& session);

/// Captions: the files' names.
ComparedNames namesOf(const std::string& a, const std::string& b);
/// Writes the picture and adds it to section "output".
void writeComparison(const Image& picture, const std::string& output, Session& session);

} // namespace tetvdb::cli
