// SPDX-License-Identifier: Apache-2.0
#include "BandLeaves.h"
#include "CoverageGrid.h"
#include "ExpandGrid.h"
#include "HostBackend.h"
#include "LevelSetGrid.h"
#include "SampleGrids.h"
#include "SharedGrid.h"

namespace tetvdb::nano {

void writeSharedHead(const KeySpace& space, Kind kind, const GridValues& values,
                     const nanovdb::GridData& header, const SharedLayout& layout,
                     const std::vector<RootsOfShare>& shares, u8* grid) {
  RootsOfShare all;
  u64 uppers = 0, tiles = 0;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    for (RootEntry entry : shares[k].entries) {
      entry.upper += uppers;
      entry.rank += tiles;
      all.entries.push_back(entry);
    }
    all.voxels.insert(all.voxels.end(), shares[k].voxels.begin(), shares[k].voxels.end());
    all.moments.insert(all.moments.end(), shares[k].moments.begin(), shares[k].moments.end());
    for (int t = 0; t < 4; ++t)
      all.totals[t] += shares[k].totals[t];
    uppers += layout.shares[k].uppers;
    tiles += layout.shares[k].rootTiles;
  }
  HostBackend host;
  GridWriter<HostBackend>(host, space, kind, values)
      .writeHead(grid, layout.whole, header,
                 {all.entries.data(), all.entries.size(), all.voxels.data(), all.moments.data(),
                  all.totals});
}

struct HostTwin::State {
  HostBackend backend; // of one share, and of a shared grid's buffer
  std::vector<std::unique_ptr<HostBackend>> shares;
};

HostTwin::HostTwin() : state_(std::make_unique<State>()) {}
HostTwin::~HostTwin() = default;

Counts HostTwin::sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                        int shares) {
  Counts counts;
  u64 leaves = 0;
  const Job owners = ownersOf(job);
  for (int k = 0; k < shares; ++k) {
    HostBackend& backend = state_->backend;
    backend.release();
    Pipeline<HostBackend> pipeline(backend, mesh, owners, ShareOf{k, shares});
    pipeline.buildOwners();
    const SourceFields fields =
        placeFields(backend, job, mesh.tetCount, [](const void* from, u64) { return from; });
    LeafSampler<HostBackend>(backend, pipeline, mesh, job, fields).run(receiver);
    counts = pipeline.countsOf({}, 0);
    leaves += pipeline.leaves().count;
  }
  counts.leaves = leaves;
  return counts;
}

Counts HostTwin::sampleGrids(const MeshView& mesh, const FieldJob& job, GridReceiver& receiver) {
  HostBackend& backend = state_->backend;
  backend.release();
  const Job owners = ownersOf(job);
  Pipeline<HostBackend> pipeline(backend, mesh, owners);
  pipeline.buildOwners();
  const Counts counts = pipeline.countsOf({}, 0);
  const SourceFields fields =
      placeFields(backend, job, mesh.tetCount, [](const void* from, u64) { return from; });
  GridSampler<HostBackend>(backend, pipeline, mesh, job, fields)
      .run([&](const GridCounts& made, const u8* buffer) {
        std::memcpy(receiver.place(made), buffer, made.bytes);
      });
  return counts;
}

u64 HostTwin::distances(const DistanceJob& job, DistanceReceiver& receiver, int shares) {
  u64 leaves = 0;
  for (int k = 0; k < shares; ++k) {
    HostBackend& backend = state_->backend;
    backend.release();
    const NodeShare share = shareOfNodes(job, k, shares);
    std::vector<u64> starts;
    const PlacedBand band =
        placeBand(job, share, starts, [](const void* from, u64) { return from; });
    leaves += BandLeaves<HostBackend>(backend, band, starts).run(share.begin, receiver);
  }
  return leaves;
}

Result HostTwin::coverage(const CoverageJob& job) {
  state_->backend.release();
  return CoverageGrid<HostBackend>(state_->backend, job, [](const void* from, u64) { return from; })
      .run();
}

void HostTwin::expandValues(const Result& result, const VoxelRange& range, float* to) {
  expandRows<float>(state_->backend, result.bytes, range, FloatValues{to});
}

Result HostTwin::levelSet(const MeshView& mesh, const LevelSetJob& job) {
  state_->backend.release();
  const Job mask = maskJobOf(job);
  return LevelSetGrid<HostBackend>(state_->backend, mesh, job, mask).run([] {});
}

void HostTwin::expand(const Result& result, GridType type, const VoxelRange& range,
                      unsigned char* to) {
  expandActive(state_->backend, kindOf(type), result.bytes, range, to);
}

Result HostTwin::run(const MeshView& mesh, const Job& job, int shares) {
  State& s = *state_;
  s.backend.release();
  if (shares == 1)
    return Pipeline<HostBackend>(s.backend, mesh, job).run();
  s.shares.clear();
  std::vector<Pipeline<HostBackend>> pipelines;
  std::vector<NodeCounts> counts;
  for (int k = 0; k < shares; ++k) {
    s.shares.push_back(std::make_unique<HostBackend>());
    pipelines.emplace_back(*s.shares.back(), mesh, job, ShareOf{k, shares});
    counts.push_back(pipelines.back().build());
  }
  if (!pipelines[0].closed()) {
    Result open;
    open.counts = pipelines[0].countsOf({}, 0);
    return open;
  }
  const SharedLayout layout(pipelines[0].kind(), counts);
  checkCount(layout.all.leaves);
  u8* grid = s.backend.output(layout.whole.size);
  std::vector<RootsOfShare> roots;
  for (std::size_t k = 0; k < pipelines.size(); ++k)
    roots.push_back(writeShare(*s.shares[k], pipelines[k], layout.shares[k], grid));
  writeSharedHead(pipelines[0].space(), pipelines[0].kind(), pipelines[0].values(),
                  pipelines[0].makeHeader(), layout, roots, grid);
  Result result;
  result.counts = pipelines[0].countsOf(layout.all, layout.whole.size);
  result.bytes = grid;
  return result;
}

} // namespace tetvdb::nano
