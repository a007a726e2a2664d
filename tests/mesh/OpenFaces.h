// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TetMesh.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>

namespace tetvdb::meshes {

/// Faces that belong to one tet alone; none may belong to more than two.
inline std::size_t openFaces(const TetMesh& mesh) {
  std::map<std::array<std::uint32_t, 3>, int> count;
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<std::uint32_t, 3> face{};
      for (std::size_t i = 0, n = 0; i < 4; ++i)
        if (i != skip)
          face[n++] = mesh.tets[4 * t + i];
      std::sort(face.begin(), face.end());
      ++count[face];
    }
  std::size_t open = 0;
  for (const auto& [face, times] : count) {
    EXPECT_LE(times, 2);
    open += times == 1;
  }
  return open;
}

} // namespace tetvdb::meshes
