// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/GreyLevels.h"

#include "tetvdb/core/Error.h"

#include <cmath>

namespace tetvdb {

GreyLevels::GreyLevels(const GreyOptions& options)
    : options_(options),
      plain_(options.levels == 256 && options.gamma == 1 && !options.table.has_value()) {
  if (options.levels < 2 || options.levels > 256)
    throw Error(Status::Usage, "`levels`", "must be from 2 to 256");
  if (!(options.gamma >= 0) || !std::isfinite(options.gamma))
    throw Error(Status::Usage, "`gamma`", "must be a number, zero or more");
}

std::uint8_t GreyLevels::mapped(std::int64_t share) const {
  std::int64_t level = 0; // from 0 to levels - 1
  const std::int64_t top = options_.levels - 1;
  if (options_.gamma == 1) {
    level = (share * top + kWhole / 2) >> 46;
  } else if (options_.gamma == 0) {
    level = 2 * share >= kWhole ? top : 0;
  } else {
    const double part = static_cast<double>(share) / static_cast<double>(kWhole);
    level =
        static_cast<std::int64_t>(std::pow(part, options_.gamma) * static_cast<double>(top) + 0.5);
  }
  const auto grey = static_cast<std::uint8_t>((2 * 255 * level + top) / (2 * top));
  return options_.table ? (*options_.table)[grey] : grey;
}

} // namespace tetvdb
