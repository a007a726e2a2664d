// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace tetvdb {

using Vec3d = std::array<double, 3>;
using Vec3i = std::array<std::int32_t, 3>; ///< voxel or node coordinates, index space

} // namespace tetvdb
