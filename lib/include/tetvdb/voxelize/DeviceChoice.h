// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

enum class DeviceKind : std::uint8_t {
  Auto, ///< the GPU where there is one and it is expected to be faster
  Cpu,
  Cuda
};

struct DeviceChoice {
  DeviceKind kind = DeviceKind::Auto;
  /// In CUDA's order; several share a job by columns of root tiles, each named once.
  std::vector<int> numbers = {0};
};

/// The device that made a job's grids.
struct DeviceUsed {
  std::string name = "cpu"; ///< or "cuda:0 NVIDIA H200", several with commas
  std::string why;          ///< of DeviceKind::Auto: why this one
};

} // namespace tetvdb
