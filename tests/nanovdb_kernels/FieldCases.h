// SPDX-License-Identifier: Apache-2.0
//
// Meshes with arrays of every kind, the grids that the device or its twin makes of them, and those
// of the CPU's sampleFields(), which shares the arithmetic of a voxel but not how voxels, owners
// and arrays are found.
#pragma once

#include "Grids.h"
#include "Meshes.h"
#include "tetvdb/fields/SampleOnDevice.h"
#include "tetvdb/fields/SampledGrids.h"
#include "tetvdb/voxelize/SnappedMesh.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

/// Arrays of all number types on points and cells, with values that have nothing to do with
/// positions; every hundredth of "holes" and of "patches" is no finite number.
inline TetMesh withArrays(TetMesh mesh, std::uint64_t seed) {
  meshes::Random random(seed);
  using On = Attribute::On;
  const auto attach = [&](const char* name, On on, std::uint32_t components, auto number,
                          double low, double high, bool holes = false) {
    using T = decltype(number);
    const std::size_t count = on == On::Points ? mesh.points.size() : mesh.cellCount;
    std::vector<T> values;
    for (std::size_t i = 0; i < count * components; ++i) {
      values.push_back(static_cast<T>(random.between(low, high)));
      if (holes && random.below(100) == 0)
        values.back() = static_cast<T>(i % 2 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                                  : std::numeric_limits<double>::infinity());
    }
    mesh.attributes.push_back({name, on, components, std::move(values)});
  };
  attach("temperature", On::Points, 1, float(), -40, 1200);
  attach("pressure", On::Points, 1, double(), 1e5, 3e7);
  attach("vel", On::Points, 3, float(), -3, 3);
  attach("label", On::Points, 1, std::int32_t(), -100, 1000);
  attach("serial", On::Points, 1, std::int64_t(), -1e9, 1e9);
  attach("holes", On::Points, 1, double(), 0, 1, true);
  attach("strain", On::Points, 6, double(), -1e-3, 1e-3);
  attach("kind", On::Cells, 1, std::int32_t(), 0, 5);
  attach("force", On::Cells, 3, double(), -9, 9);
  attach("stress", On::Cells, 6, float(), -2e8, 2e8);
  attach("patches", On::Cells, 1, float(), 2, 3, true);
  return mesh;
}

/// All arrays, invariants, and everything that is done to values before they are stored.
inline FieldOptions allFields() {
  FieldOptions options;
  for (const char* name : {"temperature", "pressure", "vel", "label", "serial", "holes", "strain",
                           "kind", "force", "stress", "patches"})
    options.requests.push_back({"", name, FieldPart::Whole, ""});
  options.requests.push_back({"speed", "vel", FieldPart::Magnitude, ""});
  options.requests.push_back({"vy", "vel", FieldPart::Component, "y"});
  options.requests.push_back({"mises", "stress", FieldPart::Mises, ""});
  options.requests.push_back({"middle", "strain", FieldPart::Principal2, ""});
  options.requests.push_back({"largest", "stress", FieldPart::Principal1, ""});
  options.requests.push_back({"trace", "strain", FieldPart::Trace, ""});
  options.requests.push_back({"det", "strain", FieldPart::Determinant, ""});
  options.requests.push_back({"hot", "temperature", FieldPart::Whole, ""});
  options.requests.push_back({"short", "force", FieldPart::Whole, ""});
  options.remap = {{"pressure", 0, 1}, {"kind", 1, 9}};
  options.clamp = {{"hot", 300, 900}, {"short", 0, 2}};
  options.background = {{"temperature", -1}};
  options.turnVectors = true;
  return options;
}

struct CollectedLeaves : nano::LeafReceiver {
  FieldGrids* grids = nullptr;
  std::mutex mutex;
  std::uint64_t expected = 0, taken = 0;
  int batches = 0;

  void expect(std::uint64_t leaves) override {
    const std::lock_guard<std::mutex> lock(mutex);
    expected += leaves;
  }
  void take(const nano::LeafBatch& batch) override {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      taken += batch.count;
      ++batches;
    }
    grids->take(batch);
  }
};

struct SampledFields {
  std::string hash;
  std::vector<Warning> warnings;
  bool complete = true; ///< all leaves came that were expected
  int batches = 0;
};

/// sample(mesh, job, receiver): the device's or its twin's.
template <typename Sample>
SampledFields fieldsBy(const TetMesh& mesh, const GridTransform& transform,
                       const FieldOptions& wanted, const Sample& sample) {
  Report report;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);
  std::vector<std::unique_ptr<PackedGrid>> none;
  const SnappedMesh nothing;
  SampledGrids grids(mesh, nothing, transform, fields, nullptr, none);
  CollectedLeaves leaves;
  leaves.grids = &grids.grids();
  const nano::MeshView view{mesh.points.empty() ? nullptr : mesh.points[0].data(),
                            mesh.points.size(), mesh.tets.data(), mesh.tetCount(), nullptr};
  sample(view, fieldJobFor(mesh, transform, fields), leaves);
  auto set = std::make_shared<GridSet>();
  set->all = grids.finish(transform, report);
  return {hash(Volume(std::move(set))), report.warnings, leaves.expected == leaves.taken,
          leaves.batches};
}

struct CollectedGrids : nano::GridReceiver {
  std::vector<NanoBytes> grids;
  SampledCounts counts;

  unsigned char* place(const nano::GridCounts& made) override {
    const auto [memory, grid] = newNanoBytes(made.bytes);
    grids.push_back(grid);
    counts.leftOut.push_back(made.leftOut);
    return memory;
  }
};

/// sample(mesh, job, receiver): the device's grids or its twin's.
template <typename Sample>
SampledFields nanoFieldsBy(const TetMesh& mesh, const GridTransform& transform,
                           const FieldOptions& wanted, CollectedGrids& collected,
                           const Sample& sample) {
  Report report;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);
  nano::MeshView view = viewOf(mesh);
  view.values = nullptr;
  sample(view, fieldJobFor(mesh, transform, fields), collected);
  auto set = std::make_shared<GridSet>();
  for (std::size_t i = 0; i < collected.grids.size(); ++i) {
    set->all.push_back(gridOfNano(collected.grids[i].data.get()));
    describeValues(fields[i], *set->all.back());
  }
  collected.counts.warn(fields, report);
  return {hash(Volume(std::move(set))), report.warnings, collected.grids.size() == fields.size(),
          0};
}

inline SampledFields cpuFields(const TetMesh& mesh, const GridTransform& transform,
                               const FieldOptions& wanted) {
  SampledFields result;
  Report report;
  Progress progress;
  const std::vector<Field> fields = resolveFields(mesh, wanted, report);
  SampleOptions options;
  options.allowEmpty = true;
  Volume volume;
  sampleFields(mesh, transform, fields, options, volume, report, progress);
  result.hash = hash(volume);
  result.warnings = report.warnings;
  return result;
}

/// A mesh of the given points and tets whose cells are six tets each.
inline TetMesh withCellsOfSix(TetMesh mesh) {
  mesh.cellOfTet.clear();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t)
    mesh.cellOfTet.push_back(static_cast<std::uint32_t>(t / 6));
  mesh.cellCount = (mesh.tetCount() + 5) / 6;
  return mesh;
}

} // namespace tetvdb
