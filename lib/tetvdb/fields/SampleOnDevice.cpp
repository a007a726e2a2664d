// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SampleOnDevice.h"

#include "tetvdb/fields/SampledGrids.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/RunOnDevice.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TreeEstimate.h"
#include "tetvdb/voxelize/ViewOfMesh.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <atomic>
#include <tbb/task_arena.h>
#include <type_traits>
#include <utility>
#include <variant>

namespace tetvdb {
namespace {

template <typename T>
constexpr nano::NumberType numberType() {
  if constexpr (std::is_same_v<T, float>)
    return nano::NumberType::Float;
  else if constexpr (std::is_same_v<T, double>)
    return nano::NumberType::Double;
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return nano::NumberType::Int32;
  else
    return nano::NumberType::Int64;
}

nano::ArrayView viewOf(const Attribute& array) {
  nano::ArrayView view;
  view.components = array.components;
  view.elements = array.size();
  std::visit(
      [&](const auto& values) {
        view.values = values.data();
        view.type = numberType<typename std::decay_t<decltype(values)>::value_type>();
      },
      array.values);
  return view;
}

// Whether shape functions of cells other than linear tets are required.
bool needsShapes(const TetMesh& mesh, const std::vector<Field>& fields) {
  return !mesh.curved.empty() && std::any_of(fields.begin(), fields.end(), [](const Field& field) {
    return field.on == Attribute::On::Points && field.kind != FieldKind::Integer;
  });
}

// Receives leaves of values and adds them to the trees.
class TreeMaker : public nano::LeafReceiver {
public:
  TreeMaker(FieldGrids& grids, const FieldBytes& bytes, const SampleOptions& options,
            StageTimer& timer)
      : grids_(grids), bytes_(bytes), timer_(timer) {
    limits_.maxMemory = options.maxMemory;
  }

  void expect(std::uint64_t leaves) override {
    const double all = static_cast<double>(leaves_ += leaves);
    requireMemory(all * bytes_.leaf + all / 4096 * bytes_.lowerNode, limits_);
  }

  void take(const nano::LeafBatch& batch) override {
    if (!begun_.exchange(true))
      timer_.part("values");
    arena_.execute([&] { grids_.take(batch); });
  }

private:
  FieldGrids& grids_;
  FieldBytes bytes_;
  StageTimer& timer_;
  VoxelizeOptions limits_;
  std::atomic<std::uint64_t> leaves_{0};
  std::atomic<bool> begun_{false};
  tbb::task_arena arena_{tbb::task_arena::attach()}; // the caller's arena, also for a device's
                                                     // thread
};

// Receives whole grids.
class GridTaker : public nano::GridReceiver {
public:
  GridTaker(std::vector<NanoBytes>& grids, const SampleOptions& options) : grids_(grids) {
    limits_.maxMemory = options.maxMemory;
  }

  unsigned char* place(const nano::GridCounts& counts) override {
    bytes_ += static_cast<double>(counts.bytes);
    requireMemory(bytes_, limits_);
    const auto [memory, grid] = newNanoBytes(counts.bytes);
    grids_.push_back(grid);
    counts_.leftOut.push_back(counts.leftOut);
    return memory;
  }

  const SampledCounts& counts() const { return counts_; }

private:
  std::vector<NanoBytes>& grids_;
  VoxelizeOptions limits_;
  double bytes_ = 0;
  SampledCounts counts_;
};

SnapCounts snapCountsOf(const nano::Counts& found) {
  SnapCounts counts;
  counts.flipped = found.flipped;
  counts.dropped = found.dropped;
  return counts;
}

nano::MeshView withoutValues(const TetMesh& mesh) {
  nano::MeshView view = viewOf(mesh);
  view.values = nullptr;
  return view;
}

DeviceQuestion questionOf(const TetMesh& mesh, const GridTransform& transform,
                          const std::vector<Field>& fields) {
  DeviceQuestion question;
  if (needsShapes(mesh, fields))
    question.unable = "values by the shape functions of cells are computed on the CPU";
  question.cost = [&] {
    double numbers = 0;
    for (const Field& field : fields)
      numbers += field.width();
    return estimateFieldCost(mesh, transform, numbers);
  };
  return question;
}

SnapCounts sampleOn(DeviceSet& devices, const TetMesh& mesh, const GridTransform& transform,
                    const std::vector<Field>& fields, const SampleOptions& options,
                    const PackOptions* pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                    Volume& volume, StageTimer& timer, Report& report, Progress& progress) {
  timer.part("on the device");
  const SnappedMesh none; // the device has its own
  SampledGrids grids(mesh, none, transform, fields, pack, packed);
  TreeMaker maker(grids.grids(), fieldBytes(fields, pack), options, timer);
  const nano::Counts found =
      devices.sample(withoutValues(mesh), fieldJobFor(mesh, transform, fields), maker, progress);
  grids.requireAny(options);
  timer.part("tree");
  const openvdb::GridPtrVec made = grids.finish(transform, report);
  if (pack == nullptr)
    volume.grids().all.insert(volume.grids().all.end(), made.begin(), made.end());
  return snapCountsOf(found);
}

} // namespace

nano::FieldJob fieldJobFor(const TetMesh& mesh, const GridTransform& transform,
                           const std::vector<Field>& fields) {
  nano::FieldJob job;
  for (std::size_t k = 0; k < 3; ++k) {
    job.voxelSize[k] = transform.voxelSize[k];
    job.origin[k] = transform.origin[k];
  }
  std::vector<const Attribute*> arrays;
  for (const Field& field : fields) {
    nano::FieldView view;
    view.rule = field.rule();
    view.onCells = field.on == Attribute::On::Cells;
    view.name = field.name;
    view.background = field.background;
    for (std::size_t k = 0; k < field.sources.size(); ++k) {
      const auto found = std::find(arrays.begin(), arrays.end(), field.sources[k].array);
      view.sources[k] = {static_cast<std::uint32_t>(found - arrays.begin()),
                         field.sources[k].component};
      if (found == arrays.end())
        arrays.push_back(field.sources[k].array);
    }
    job.fields.push_back(view);
  }
  for (const Attribute* array : arrays)
    job.arrays.push_back(viewOf(*array));
  if (!mesh.cellOfTet.empty())
    job.cellOfTet = mesh.cellOfTet.data();
  return job;
}

SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        const PackOptions* pack, const DeviceChoice& choice, DeviceUsed& used,
                        std::vector<std::unique_ptr<PackedGrid>>& packed, Volume& volume,
                        Report& report, Progress& progress) {
  const auto onCpu = [&] {
    return pack != nullptr
               ? packFields(mesh, transform, fields, options, *pack, packed, report, progress)
               : sampleFields(mesh, transform, fields, options, volume, report, progress);
  };
  used = {};
  if (mesh.tets.empty())
    return onCpu();
  return runOnDevice(
      choice, questionOf(mesh, transform, fields), used, report,
      [&](const auto& start) {
        progress.stage("fields");
        initializeOpenVDB();
        packed.clear();
        StageTimer timer(report, "fields");
        timer.part("start");
        const BorrowedDevices devices = start();
        return sampleOn(*devices, mesh, transform, fields, options, pack, packed, volume, timer,
                        report, progress);
      },
      onCpu);
}

bool makesNanoGrids(const TetMesh& mesh, const std::vector<Field>& fields) {
  return !mesh.tets.empty() && !needsShapes(mesh, fields);
}

SnapCounts sampleNanoGrids(const TetMesh& mesh, const GridTransform& transform,
                           const std::vector<Field>& fields, const SampleOptions& options,
                           const DeviceChoice& choice, DeviceUsed& used,
                           std::vector<NanoBytes>& grids, const std::function<Volume&()>& volume,
                           Report& report, Progress& progress) {
  used = {};
  std::vector<NanoBytes> made;
  const SnapCounts counts = runOnDevice(
      choice, questionOf(mesh, transform, fields), used, report,
      [&](const auto& start) {
        progress.stage("fields");
        StageTimer timer(report, "fields");
        timer.part("start");
        const BorrowedDevices devices = start();
        timer.part("on the device");
        try {
          GridTaker taker(made, options);
          const nano::Counts found = devices->sampleGrids(
              withoutValues(mesh), fieldJobFor(mesh, transform, fields), taker, progress);
          if (!options.allowEmpty && describeNano(made.front().data.get()).activeVoxels == 0 &&
              taker.counts().leftOut.front() == 0)
            refuseNoVoxels();
          taker.counts().warn(fields, report);
          return snapCountsOf(found);
        } catch (const Error& e) {
          if (e.status() != Status::Limit)
            throw;
        }
        // Batches of leaves may fit.
        made.clear();
        std::vector<std::unique_ptr<PackedGrid>> none;
        initializeOpenVDB();
        return sampleOn(*devices, mesh, transform, fields, options, nullptr, none, volume(), timer,
                        report, progress);
      },
      [&] {
        made.clear();
        return sampleFields(mesh, transform, fields, options, volume(), report, progress);
      });
  grids.insert(grids.end(), made.begin(), made.end());
  return counts;
}

} // namespace tetvdb
