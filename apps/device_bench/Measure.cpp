// SPDX-License-Identifier: Apache-2.0
#include "Measure.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>

namespace tetvdb::bench {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

GridTransform transformAt(int resolution) {
  GridTransform transform;
  transform.voxelSize.fill(2.0 / resolution);
  transform.origin.fill(-1.0 - 0.3 * 2.0 / resolution);
  return transform;
}

const void* PinnedCopies::add(const void* from, std::size_t bytes) {
  all_.emplace_back(nano::allocatePinned(bytes), &nano::freePinned);
  std::memcpy(all_.back().get(), from, bytes);
  bytes_ += static_cast<double>(bytes);
  return all_.back().get();
}

Measured measure(nano::DeviceVoxelizer& device, int times, const std::function<void()>& job) {
  std::vector<double> wall, upload, build, download;
  std::vector<std::pair<std::string, std::vector<double>>> parts;
  for (int i = 0; i < times + 2; ++i) {
    const double start = now();
    job();
    if (i < 2)
      continue;
    wall.push_back(now() - start);
    const nano::Times t = device.times();
    upload.push_back(t.upload);
    build.push_back(t.build);
    download.push_back(t.download);
    // A part that comes in several batches counts once.
    std::vector<std::pair<std::string, double>> sums;
    for (const auto& part : t.parts) {
      const auto same = std::find_if(sums.begin(), sums.end(),
                                     [&](const auto& sum) { return sum.first == part.first; });
      if (same == sums.end())
        sums.push_back(part);
      else
        same->second += part.second;
    }
    parts.resize(sums.size());
    for (std::size_t k = 0; k < sums.size(); ++k) {
      parts[k].first = sums[k].first;
      parts[k].second.push_back(sums[k].second);
    }
  }
  Measured m{median(wall), median(upload), median(build), median(download), {}};
  for (const auto& [name, seconds] : parts)
    m.parts.emplace_back(name, median(seconds));
  return m;
}

void print(const std::string& name, const Measured& m, double floorSeconds,
           const std::string& note) {
  std::printf("%-44s %9.3f ms  floor %7.3f ms (%5.1f %%)  up %.3f build %.3f down %.3f |",
              name.c_str(), m.wall * 1e3, floorSeconds * 1e3, 100 * floorSeconds / m.wall,
              m.upload * 1e3, m.build * 1e3, m.download * 1e3);
  for (const auto& [part, seconds] : m.parts)
    std::printf(" %s %.3f", part.c_str(), seconds * 1e3);
  std::printf(" | %s\n", note.c_str());
  std::fflush(stdout);
}

void besideCpu(const std::string& name, const DeviceCost& cost, int times,
               const std::function<void(const DeviceChoice&)>& job) {
  std::vector<double> seconds[2];
  for (int i = 0; i < times; ++i)
    for (const DeviceKind kind : {DeviceKind::Cpu, DeviceKind::Cuda}) {
      const double start = now();
      job({kind, {0}});
      seconds[kind == DeviceKind::Cuda].push_back(now() - start);
    }
  std::printf("%s: CPU %.1f ms (expected %.1f), GPU after its start %.1f ms (expected with it "
              "%.1f)\n",
              name.c_str(), median(seconds[0]) * 1e3, cost.cpu * 1e3, median(seconds[1]) * 1e3,
              cost.device * 1e3);
  std::fflush(stdout);
}

} // namespace tetvdb::bench
