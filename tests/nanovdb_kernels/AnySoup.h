// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Meshes.h"

#include <cstddef>
#include <cstdint>
#include <rapidcheck.h>
#include <utility>

namespace tetvdb::meshes {

/// Up to 40 tets anywhere, small or large, half of the time with corners on a lattice; to be called
/// within a property of RapidCheck.
inline TetMesh anySoup() {
  const auto count = static_cast<std::size_t>(*rc::gen::inRange(1, 40));
  const auto seed = static_cast<std::uint64_t>(*rc::gen::inRange(0, 1 << 30));
  const double size = *rc::gen::element(1.0, 10.0, 60.0), tet = *rc::gen::element(0.3, 2.0, 25.0);
  TetMesh mesh = soup(count, size, tet, seed, 2);
  if (*rc::gen::inRange(0, 2) == 1)
    mesh = rounded(std::move(mesh), *rc::gen::element(1.0, 0.5, 0.125));
  return mesh;
}

} // namespace tetvdb::meshes
