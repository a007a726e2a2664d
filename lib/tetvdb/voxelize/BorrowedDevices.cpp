// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/BorrowedDevices.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <mutex>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint64_t kMaxKeptBytes = std::uint64_t(1) << 30;

struct Kept {
  int number;
  pid_t process;
  std::unique_ptr<DeviceSet> devices;
};

std::mutex mutex;

// Never destroyed: CUDA ends before static objects do.
std::vector<Kept>& kept() {
  static auto& all = *new std::vector<Kept>;
  return all;
}

} // namespace

BorrowedDevices::BorrowedDevices(const DeviceChoice& choice, const std::vector<std::string>& names,
                                 std::string& name)
    : numbers_(choice.numbers), failures_(std::uncaught_exceptions()) {
  if (numbers_.size() == 1) {
    const std::lock_guard<std::mutex> lock(mutex);
    const auto found = std::find_if(kept().begin(), kept().end(), [&](const Kept& one) {
      return one.number == numbers_[0] && one.process == getpid();
    });
    if (found != kept().end()) {
      devices_ = std::move(found->devices);
      kept().erase(found);
    }
  }
  if (devices_ == nullptr)
    devices_ = std::make_unique<DeviceSet>(choice, names);
  name = devices_->name();
}

BorrowedDevices::~BorrowedDevices() {
  if (numbers_.size() != 1 || std::uncaught_exceptions() != failures_ ||
      devices_->deviceBytes() > kMaxKeptBytes)
    return;
  const std::lock_guard<std::mutex> lock(mutex);
  kept().push_back({numbers_[0], getpid(), std::move(devices_)});
}

} // namespace tetvdb
