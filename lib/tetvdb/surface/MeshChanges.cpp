// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/MeshChanges.h"

#include "tetvdb/surface/FloatPositions.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <tbb/parallel_sort.h>
#include <vector>

namespace tetvdb {
namespace {

using Face = std::array<FloatPosition, 3>;

std::vector<Face> sortedFaces(const TriangleMesh& mesh) {
  std::vector<Face> faces(mesh.triangleCount());
  for (std::size_t face = 0; face < faces.size(); ++face) {
    for (std::size_t k = 0; k < 3; ++k) {
      faces[face][k] = asFloats(mesh.points[mesh.triangles[3 * face + k]]);
      for (float& c : faces[face][k])
        c += 0.0f; // -0 equals 0
    }
    std::sort(faces[face].begin(), faces[face].end());
  }
  tbb::parallel_sort(faces.begin(), faces.end());
  return faces;
}

} // namespace

MeshChanges meshChanges(const TriangleMesh& before, const TriangleMesh& after) {
  const std::vector<Face> first = sortedFaces(before), second = sortedFaces(after);
  MeshChanges changes;
  for (auto a = first.begin(), b = second.begin(); a != first.end() && b != second.end();) {
    if (*a < *b) {
      ++a;
    } else if (*b < *a) {
      ++b;
    } else {
      ++changes.kept;
      ++a;
      ++b;
    }
  }
  changes.removed = first.size() - changes.kept;
  changes.added = second.size() - changes.kept;
  return changes;
}

} // namespace tetvdb
