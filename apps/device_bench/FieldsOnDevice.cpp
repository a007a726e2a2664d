// SPDX-License-Identifier: Apache-2.0
#include "FieldsOnDevice.h"

#include "Measure.h"
#include "tetvdb/fields/SampleOnDevice.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <utility>
#include <vector>

namespace tetvdb::bench {
namespace {

struct CountedLeaves : nano::LeafReceiver {
  std::uint64_t leaves = 0;
  void expect(std::uint64_t) override { leaves = 0; }
  void take(const nano::LeafBatch& batch) override { leaves += batch.count; }
};

// Pinned memory that grids are brought to, run after run.
class PinnedGrids : public nano::GridReceiver {
public:
  void begin() { next_ = bytes_ = 0; }
  unsigned char* place(const nano::GridCounts& counts) override {
    bytes_ += counts.bytes;
    if (next_ == places_.size())
      places_.emplace_back(static_cast<unsigned char*>(nano::allocatePinned(counts.bytes)),
                           nano::freePinned);
    return places_[next_++].get();
  }
  double bytes() const { return static_cast<double>(bytes_); } ///< of the last run

private:
  std::vector<std::unique_ptr<unsigned char, void (*)(void*)>> places_;
  std::size_t next_ = 0;
  std::uint64_t bytes_ = 0;
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

// Copies of a job's arrays and of its mesh, which `view` becomes.
nano::FieldJob pinnedJob(PinnedCopies& pinned, const TetMesh& mesh, const GridTransform& transform,
                         const std::vector<Field>& fields, nano::MeshView& view) {
  nano::FieldJob job = fieldJobFor(mesh, transform, fields);
  for (nano::ArrayView& array : job.arrays)
    array.values = pinned.add(array.values, array.bytes());
  view = {static_cast<const double*>(pinned.add(mesh.points[0].data(), mesh.points.size() * 24)),
          mesh.points.size(),
          static_cast<const std::uint32_t*>(pinned.add(mesh.tets.data(), mesh.tets.size() * 4)),
          mesh.tetCount(), nullptr};
  return job;
}

// Three grids, as those of a .nvdb file: two of floats, and `force` by its length or as it is.
void gridsRows(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& mesh,
               const std::string& name, const GridTransform& transform, FieldPart force,
               int times) {
  const std::string what =
      name +
      (force == FieldPart::Whole ? ", 3 grids of NanoVDB, one of vectors" : ", 3 grids of NanoVDB");
  Report report;
  Progress progress;
  FieldOptions wanted;
  wanted.requests = {{"", "heat", FieldPart::Whole, ""},
                     {"", "load", FieldPart::Whole, ""},
                     {"", "force", force, ""}};
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);
  PinnedCopies pinned;
  nano::MeshView view;
  const nano::FieldJob job = pinnedJob(pinned, mesh, transform, fields, view);
  PinnedGrids grids;
  const Measured measured = measure(device, times, [&] {
    grids.begin();
    device.sampleGrids(view, job, grids);
  });
  print(what, measured, pinned.bytes() / speeds.up + grids.bytes() / speeds.down,
        fmt::format("{:.0f} MB up, {:.0f} MB down", pinned.bytes() * 1e-6, grids.bytes() * 1e-6));
  besideCpu(what + "; the CPU's: OpenVDB's trees",
            estimateFieldCost(mesh, transform, force == FieldPart::Whole ? 5 : 3),
            std::max(times / 4, 3), [&](const DeviceChoice& choice) {
              DeviceUsed used;
              std::vector<NanoBytes> made;
              Volume volume;
              sampleNanoGrids(
                  mesh, transform, fields, {}, choice, used, made,
                  [&]() -> Volume& { return volume; }, report, progress);
            });
}

} // namespace

void fieldsTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& ball,
                 const std::string& name, int resolution, int times) {
  const TetMesh mesh = withArrays(ball);
  const GridTransform transform = transformAt(resolution);
  const std::string what = fmt::format("fields of {} at {}^3", name, resolution);
  Report report;
  Progress progress;
  FieldOptions wanted;
  wanted.all = true;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);

  {
    PinnedCopies pinned;
    nano::MeshView view;
    const nano::FieldJob job = pinnedJob(pinned, mesh, transform, fields, view);
    CountedLeaves counted;
    const Measured measured = measure(device, times, [&] { device.sample(view, job, counted); });
    // Of a leaf: its mask and 5 numbers a voxel come down. Within the device they are written and
    // read, and so are the owners.
    const double leaves = static_cast<double>(counted.leaves), down = leaves * (64 + 512 * 5 * 4);
    const double bus = pinned.bytes() / speeds.up + down / speeds.down;
    const double within = 2 * (pinned.bytes() + down + leaves * 2048) / speeds.within;
    print(what + ", device alone", measured, bus,
          fmt::format("{:.0f} MB up, {:.0f} MB down; {:.2f} ms within", pinned.bytes() * 1e-6,
                      down * 1e-6, within * 1e3));
  }

  for (const FieldPart force : {FieldPart::Magnitude, FieldPart::Whole})
    gridsRows(device, speeds, mesh, what, transform, force, times);

  double numbers = 0;
  for (const Field& field : fields)
    numbers += field.width();
  const DeviceCost cost = estimateFieldCost(mesh, transform, numbers);
  for (const bool packs : {false, true}) {
    PackOptions pack;
    pack.folder = "/tmp";
    besideCpu(what + (packs ? ", arrays to packed leaves" : ", arrays to OpenVDB's trees"), cost,
              std::max(times / 4, 3), [&](const DeviceChoice& choice) {
                DeviceUsed used;
                Volume volume;
                std::vector<std::unique_ptr<PackedGrid>> packed;
                sampleFields(mesh, transform, fields, {}, packs ? &pack : nullptr, choice, used,
                             packed, volume, report, progress);
              });
  }
}

} // namespace tetvdb::bench
