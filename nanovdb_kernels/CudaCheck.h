// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Error.h"

#include <cuda_runtime.h>
#include <string>

namespace tetvdb::nano {

/// Throws Error(Limit) where the device's memory is full, Error(Device) for any other failure.
inline void check(cudaError_t status, const char* what) {
  if (status == cudaSuccess)
    return;
  cudaGetLastError(); // so that it does not show up again
  const std::string text = std::string(what) + ": " + cudaGetErrorString(status);
  if (status == cudaErrorMemoryAllocation)
    throw Error(Status::Limit, "device", text, "use larger voxels or `device=cpu`");
  throw Error(Status::Device, "device", text, "use `device=cpu`");
}

} // namespace tetvdb::nano
