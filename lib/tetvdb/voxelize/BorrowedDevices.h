// SPDX-License-Identifier: Apache-2.0
//
// Devices that outlive the job that opens them. Internal.
#pragma once

#include "tetvdb/voxelize/DeviceSet.h"

#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

/// The devices of a choice, for one job. Opening a device takes tenths of a second and its memory
/// is taken anew: so a single device is kept when the job ends, and the process's next job has it.
/// It is closed where the job failed or it holds more than 1 GiB; a process that was forked opens
/// its own. Thread-safe: jobs at the same time have different ones.
class BorrowedDevices {
public:
  /// `name` receives DeviceSet::name(). Throws as DeviceSet() does.
  BorrowedDevices(const DeviceChoice& choice, const std::vector<std::string>& names,
                  std::string& name);
  ~BorrowedDevices();
  BorrowedDevices(const BorrowedDevices&) = delete;
  BorrowedDevices& operator=(const BorrowedDevices&) = delete;

  DeviceSet& operator*() const { return *devices_; }
  DeviceSet* operator->() const { return devices_.get(); }

private:
  std::unique_ptr<DeviceSet> devices_;
  std::vector<int> numbers_;
  int failures_;
};

} // namespace tetvdb
