// SPDX-License-Identifier: Apache-2.0
//
// The devices that a DeviceChoice selects; several share each job. Internal.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

class DeviceSet {
public:
  /// `names`: of all devices there are (nano::listDevices()). Throws Error(Device).
  DeviceSet(const DeviceChoice& choice, const std::vector<std::string>& names) {
    for (const int number : choice.numbers)
      name_ += (name_.empty() ? "cuda:" : ", cuda:") + std::to_string(number) + " " +
               names.at(static_cast<std::size_t>(number));
    if (choice.numbers.size() == 1)
      one_ = std::make_unique<nano::DeviceVoxelizer>(choice.numbers[0]);
    else
      several_ = std::make_unique<nano::SharedVoxelizer>(choice.numbers);
  }

  const std::string& name() const { return name_; }

  nano::Result run(const nano::MeshView& mesh, const nano::Job& job, const Progress& progress) {
    return one_ != nullptr ? one_->run(mesh, job, &progress) : several_->run(mesh, job, &progress);
  }
  nano::Counts sample(const nano::MeshView& mesh, const nano::FieldJob& job,
                      nano::LeafReceiver& receiver, const Progress& progress) {
    return one_ != nullptr ? one_->sample(mesh, job, receiver, &progress)
                           : several_->sample(mesh, job, receiver, &progress);
  }

  nano::Counts sampleGrids(const nano::MeshView& mesh, const nano::FieldJob& job,
                           nano::GridReceiver& receiver, const Progress& progress) {
    return one_ != nullptr ? one_->sampleGrids(mesh, job, receiver, &progress)
                           : several_->sampleGrids(mesh, job, receiver, &progress);
  }

  std::uint64_t distances(const nano::DistanceJob& job, nano::DistanceReceiver& receiver,
                          const Progress& progress) {
    return one_ != nullptr ? one_->distances(job, receiver, &progress)
                           : several_->distances(job, receiver, &progress);
  }

  nano::Result coverage(const nano::CoverageJob& job, const Progress& progress) {
    return one_ != nullptr ? one_->coverage(job, &progress) : several_->coverage(job, &progress);
  }

  nano::Result levelSet(const nano::MeshView& mesh, const nano::LevelSetJob& job,
                        const Progress& progress) {
    return one_ != nullptr ? one_->levelSet(mesh, job, &progress)
                           : several_->levelSet(mesh, job, &progress);
  }

  /// The device's voxelizer where there is one device; else null.
  nano::DeviceVoxelizer* single() const { return one_.get(); }
  /// Held on the device where there is one; else 0.
  std::uint64_t deviceBytes() const { return one_ != nullptr ? one_->deviceBytes() : 0; }

  /// Seconds of the last job on the slowest device.
  nano::Times times() const {
    if (one_ != nullptr)
      return one_->times();
    nano::Times slowest;
    for (const nano::Times& t : several_->times())
      if (t.build >= slowest.build)
        slowest = t;
    return slowest;
  }

private:
  std::string name_;
  std::unique_ptr<nano::DeviceVoxelizer> one_;
  std::unique_ptr<nano::SharedVoxelizer> several_;
};

} // namespace tetvdb
