// SPDX-License-Identifier: Apache-2.0
//
// Triangles as lines of text: one a point, then one a face.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// What a format has beyond the numbers.
struct TriangleLines {
  std::string head;                 ///< lines before the points
  std::string_view ofPoint, ofFace; ///< at the beginning of their lines; may be empty
  std::uint64_t firstPoint = 0;     ///< the number of the first point
};

/// Writes a file. Doubles read back the same. Throws Error(Write).
void writeTriangleLines(const std::string& path, const TriangleMesh& mesh,
                        const TriangleLines& lines, Progress& progress);

} // namespace tetvdb
