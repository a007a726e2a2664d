// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShownValues.h"

#include <fmt/format.h>

namespace tetvdb {

std::string whyHidden(const GridInfo& grid) {
  if ((grid.type != "float" && grid.type != "double") || grid.activeVoxels == 0 ||
      grid.gridClass == "level set")
    return {};
  const std::string range = fmt::format("{:.6g} to {:.6g}", grid.minValue, grid.maxValue);
  if (grid.maxValue < kMinShown)
    return fmt::format("ranges from {}: Blender shows nothing below {}", range, kMinShown);
  if (grid.minValue < 0)
    return fmt::format("ranges from {}: renderers treat negative densities as empty", range);
  if (grid.maxValue > kMaxShown)
    return fmt::format("ranges from {}: renderers show such densities as a solid block", range);
  return {};
}

} // namespace tetvdb
