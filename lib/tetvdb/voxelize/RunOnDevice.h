// SPDX-License-Identifier: Apache-2.0
//
// Chooses whether a job runs on the CPU or the GPU, and runs it there. Internal.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/voxelize/BorrowedDevices.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <functional>
#include <string>
#include <vector>

namespace tetvdb {

/// What is known of a job before it runs.
struct DeviceQuestion {
  std::string unable; ///< why no GPU can do it; empty: one can
  /// Asked where the choice is Auto, before anything starts CUDA.
  std::function<DeviceCost()> cost;
};

/// Fills `used` for a choice among `names`, all available devices; returns whether it is the GPU.
/// Adds the warning "device-unused" where one was asked for that cannot do the job. Throws
/// Error(Device) where it is not there.
bool takesDevice(const DeviceChoice& choice, const DeviceQuestion& question, DeviceUsed& used,
                 std::vector<std::string>& names, Report& report);

/// Returns onDevice(start) or onCpu(), as takesDevice() says; start() returns the DeviceSet of the
/// choice. If that is Auto and the device fails or has too little memory, onCpu() runs and the
/// warning "device-left" is added; onCpu() must not depend on results of onDevice().
template <typename OnDevice, typename OnCpu>
auto runOnDevice(const DeviceChoice& choice, const DeviceQuestion& question, DeviceUsed& used,
                 Report& report, const OnDevice& onDevice, const OnCpu& onCpu) {
  std::vector<std::string> names;
  if (!takesDevice(choice, question, used, names, report))
    return onCpu();
  try {
    return onDevice([&] { return BorrowedDevices(choice, names, used.name); });
  } catch (const Error& e) {
    if (choice.kind != DeviceKind::Auto ||
        (e.status() != Status::Device && e.status() != Status::Limit))
      throw;
    used = {"cpu", e.what()};
  }
  report.warn("device-left", "the CPU took over from the GPU: " + used.why);
  return onCpu();
}

} // namespace tetvdb
