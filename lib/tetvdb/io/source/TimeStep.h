// SPDX-License-Identifier: Apache-2.0
//
// Which step of a file of several is read (ReadOptions::timeStep).
#pragma once

#include "tetvdb/core/Error.h"

#include <cstddef>
#include <optional>
#include <string>

namespace tetvdb {

/// The step `timeStep` of `count`, counted from 0; the last for -1, none if there are no steps.
/// Throws Error(Usage) for a step that does not exist.
inline std::optional<std::size_t> chosenStep(std::size_t count, int timeStep,
                                             const std::string& path) {
  if (timeStep >= 0 && static_cast<std::size_t>(timeStep) >= count)
    throw Error(Status::Usage, path, "has no time step " + std::to_string(timeStep + 1),
                "it has " + std::to_string(count));
  if (timeStep >= 0)
    return static_cast<std::size_t>(timeStep);
  return count > 0 ? std::optional<std::size_t>(count - 1) : std::nullopt;
}

} // namespace tetvdb
