// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SampleOnDevice.h"

#include "tetvdb/fields/SampledGrids.h"
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

SnapCounts sampleOn(DeviceSet& devices, const TetMesh& mesh, const GridTransform& transform,
                    const std::vector<Field>& fields, const SampleOptions& options,
                    const PackOptions* pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                    Volume& volume, StageTimer& timer, Report& report, Progress& progress) {
  timer.part("on the device");
  const SnappedMesh none; // the device has its own
  SampledGrids grids(mesh, none, transform, fields, pack, packed);
  TreeMaker maker(grids.grids(), fieldBytes(fields, pack), options, timer);
  nano::MeshView view = viewOf(mesh);
  view.values = nullptr;
  const nano::Counts found =
      devices.sample(view, fieldJobFor(mesh, transform, fields), maker, progress);
  grids.requireAny(options);
  timer.part("tree");
  const openvdb::GridPtrVec made = grids.finish(transform, report);
  if (pack == nullptr)
    volume.grids().all.insert(volume.grids().all.end(), made.begin(), made.end());
  SnapCounts counts;
  counts.flipped = found.flipped;
  counts.dropped = found.dropped;
  return counts;
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
  DeviceQuestion question;
  if (needsShapes(mesh, fields))
    question.unable = "values by the shape functions of cells are computed on the CPU";
  question.cost = [&] {
    double numbers = 0;
    for (const Field& field : fields)
      numbers += field.width();
    return estimateFieldCost(mesh, transform, numbers);
  };
  return runOnDevice(
      choice, question, used, report,
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

} // namespace tetvdb
