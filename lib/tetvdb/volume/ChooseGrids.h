// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tetvdb {

/// Which of `all`, the names of a file's grids, are wanted: those of `names` in that order, all
/// where there are none. Throws Error(Usage) for a name that is not among them, or comes twice.
std::vector<std::size_t> chooseGrids(const std::vector<std::string>& all,
                                     const std::vector<std::string>& names,
                                     const std::string& path);

} // namespace tetvdb
