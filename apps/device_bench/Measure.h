// SPDX-License-Identifier: Apache-2.0
//
// How the benchmark times a job, on the device alone and as the program does it, and what it
// prints.
#pragma once

#include "nanovdb_kernels/DeviceVoxelizer.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::bench {

/// Seconds since some moment.
double now();
double median(std::vector<double> values);

/// Of a grid of `resolution` across a ball of radius 1 around the origin: off the lattice's
/// symmetry, within one root tile.
GridTransform transformAt(int resolution);

/// Copies in pinned memory.
class PinnedCopies {
public:
  const void* add(const void* from, std::size_t bytes);
  double bytes() const { return bytes_; }

private:
  std::vector<std::unique_ptr<void, void (*)(void*)>> all_;
  double bytes_ = 0;
};

/// Medians, seconds: on the host's clock, and by device events.
struct Measured {
  double wall = 0, upload = 0, build = 0, download = 0;
  std::vector<std::pair<std::string, double>> parts;
};

/// `job` runs on `device`: twice to warm up, then `times` times.
Measured measure(nano::DeviceVoxelizer& device, int times, const std::function<void()>& job);

/// A line: the job's time, its floor, its parts and `note`.
void print(const std::string& name, const Measured& measured, double floorSeconds,
           const std::string& note);

/// `job` by the CPU and by the GPU, in turn: a line of the medians beside what --device auto goes
/// by.
void besideCpu(const std::string& name, const DeviceCost& cost, int times,
               const std::function<void(const DeviceChoice&)>& job);

} // namespace tetvdb::bench
