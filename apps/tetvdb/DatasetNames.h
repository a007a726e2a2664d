// SPDX-License-Identifier: Apache-2.0
//
// Settings of data sets by the names that users give.
#pragma once

#include "tetvdb/pipeline/dataset/DatasetOptions.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::cli {

inline const std::vector<std::pair<const char*, NormalLength>> kNormalLengths{
    {"longest", NormalLength::Longest},
    {"diagonal", NormalLength::Diagonal},
    {"sphere", NormalLength::Sphere},
    {"none", NormalLength::None}};

inline const std::vector<std::pair<const char*, bool DatasetContent::*>> kDatasetContents{
    {"occupancy", &DatasetContent::occupancy}, {"distance", &DatasetContent::distance},
    {"surface", &DatasetContent::surface},     {"coordinates", &DatasetContent::coordinates},
    {"points", &DatasetContent::points},       {"samples", &DatasetContent::samples}};

/// Ascending, each once.
inline std::vector<int> sortedResolutions(std::vector<int> resolutions) {
  std::sort(resolutions.begin(), resolutions.end());
  resolutions.erase(std::unique(resolutions.begin(), resolutions.end()), resolutions.end());
  return resolutions;
}

} // namespace tetvdb::cli
