// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tetvdb {

/// The contents of a preview.
struct PreviewInfo {
  std::vector<std::string> panels; ///< from left to right: "input", "tets", ...
  int width = 0, height = 0;       ///< pixels
};

} // namespace tetvdb
