// SPDX-License-Identifier: Apache-2.0
#include "FieldsOnDevice.h"

#include "tetvdb/fields/SampleOnDevice.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

namespace tetvdb::bench {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Copies in pinned memory.
class PinnedCopies {
public:
  const void* add(const void* from, std::size_t bytes) {
    all_.emplace_back(nano::allocatePinned(bytes), &nano::freePinned);
    std::memcpy(all_.back().get(), from, bytes);
    bytes_ += static_cast<double>(bytes);
    return all_.back().get();
  }
  double bytes() const { return bytes_; }

private:
  std::vector<std::unique_ptr<void, void (*)(void*)>> all_;
  double bytes_ = 0;
};

struct CountedLeaves : nano::LeafReceiver {
  std::uint64_t leaves = 0;
  void expect(std::uint64_t) override { leaves = 0; }
  void take(const nano::LeafBatch& batch) override { leaves += batch.count; }
};

TetMesh withArrays(TetMesh mesh) {
  std::vector<float> heat, load, force;
  for (const Vec3d& p : mesh.points) {
    heat.push_back(static_cast<float>(300 + 40 * p[0] * p[1]));
    load.push_back(static_cast<float>(p[2] * p[2]));
  }
  for (std::size_t c = 0; c < 3 * mesh.cellCount; ++c)
    force.push_back(static_cast<float>(c % 977));
  mesh.attributes.push_back({"heat", Attribute::On::Points, 1, std::move(heat)});
  mesh.attributes.push_back({"load", Attribute::On::Points, 1, std::move(load)});
  mesh.attributes.push_back({"force", Attribute::On::Cells, 3, std::move(force)});
  return mesh;
}

} // namespace

void fieldsTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& ball,
                 const std::string& name, int resolution, int times) {
  const TetMesh mesh = withArrays(ball);
  GridTransform transform;
  for (std::size_t k = 0; k < 3; ++k) {
    transform.voxelSize[k] = 2.0 / resolution;
    transform.origin[k] = -1.0 - 0.3 * 2.0 / resolution;
  }
  Report report;
  Progress progress;
  FieldOptions wanted;
  wanted.all = true;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);

  {
    PinnedCopies pinned;
    nano::FieldJob job = fieldJobFor(mesh, transform, fields);
    for (nano::ArrayView& array : job.arrays)
      array.values = pinned.add(array.values, array.bytes());
    const nano::MeshView view{
        static_cast<const double*>(pinned.add(mesh.points[0].data(), mesh.points.size() * 24)),
        mesh.points.size(),
        static_cast<const std::uint32_t*>(pinned.add(mesh.tets.data(), mesh.tets.size() * 4)),
        mesh.tetCount(), nullptr};
    CountedLeaves counted;
    std::vector<double> wall, upload;
    std::vector<std::pair<std::string, std::vector<double>>> parts;
    for (int i = 0; i < times + 2; ++i) {
      const double start = now();
      device.sample(view, job, counted);
      if (i < 2)
        continue;
      wall.push_back(now() - start);
      const nano::Times t = device.times();
      upload.push_back(t.upload);
      parts.resize(t.parts.size());
      for (std::size_t k = 0; k < t.parts.size(); ++k) {
        parts[k].first = t.parts[k].first;
        parts[k].second.push_back(t.parts[k].second);
      }
    }
    // Of a leaf: its mask and 5 numbers a voxel come down. Within the device they are written and
    // read, and so are the owners.
    const double leaves = static_cast<double>(counted.leaves), down = leaves * (64 + 512 * 5 * 4);
    const double bus = pinned.bytes() / speeds.up + down / speeds.down;
    const double within = 2 * (pinned.bytes() + down + leaves * 2048) / speeds.within;
    std::printf(
        "fields of %s at %d^3, device alone: %.2f ms; floor %.2f ms by the bus (%.0f MB up, "
        "%.0f MB down), %.2f ms within; upload %.2f ms",
        name.c_str(), resolution, median(wall) * 1e3, bus * 1e3, pinned.bytes() * 1e-6, down * 1e-6,
        within * 1e3, median(upload) * 1e3);
    for (const auto& [part, seconds] : parts)
      std::printf(", %s %.2f", part.c_str(), median(seconds) * 1e3);
    std::printf("\n");
  }

  double numbers = 0;
  for (const Field& field : fields)
    numbers += field.width();
  const DeviceCost cost = estimateFieldCost(mesh, transform, numbers);
  for (const bool packs : {false, true}) {
    PackOptions pack;
    pack.folder = "/tmp";
    std::vector<double> seconds[2];
    for (int i = 0; i < std::max(times / 4, 3); ++i)
      for (const DeviceKind kind : {DeviceKind::Cpu, DeviceKind::Cuda}) {
        DeviceUsed used;
        Volume volume;
        std::vector<std::unique_ptr<PackedGrid>> packed;
        const double start = now();
        sampleFields(mesh, transform, fields, {}, packs ? &pack : nullptr, {kind, {0}}, used,
                     packed, volume, report, progress);
        seconds[kind == DeviceKind::Cuda].push_back(now() - start);
      }
    std::printf("fields of %s at %d^3, arrays to %s: CPU %.1f ms (expected %.1f), GPU after its "
                "start %.1f ms (expected with it %.1f)\n",
                name.c_str(), resolution, packs ? "packed leaves" : "OpenVDB's trees",
                median(seconds[0]) * 1e3, cost.cpu * 1e3, median(seconds[1]) * 1e3,
                cost.device * 1e3);
  }
  std::fflush(stdout);
}

} // namespace tetvdb::bench
