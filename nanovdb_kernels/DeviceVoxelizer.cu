// SPDX-License-Identifier: Apache-2.0
#include "BandLeaves.h"
#include "CoverageGrid.h"
#include "CudaBackend.h"
#include "ExpandGrid.h"
#include "HostMemory.h"
#include "LevelSetGrid.h"
#include "SampleGrids.h"
#include "SharedGrid.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <thread>

namespace tetvdb::nano {
namespace {

class Events {
public:
  Events() {
    for (cudaEvent_t& e : events_)
      check(cudaEventCreate(&e), "event");
  }
  ~Events() {
    for (cudaEvent_t e : events_)
      cudaEventDestroy(e);
  }
  void record(int i, cudaStream_t stream) { check(cudaEventRecord(events_[i], stream), "event"); }
  double seconds(int from, int to) const {
    float ms = 0;
    check(cudaEventElapsedTime(&ms, events_[from], events_[to]), "event");
    return ms * 1e-3;
  }

private:
  cudaEvent_t events_[5] = {};
};

} // namespace

bool deviceSupport() {
  return true;
}

std::vector<std::string> listDevices(std::string& why) {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) {
    cudaGetLastError();
    why = cudaGetErrorString(status);
    return {};
  }
  std::vector<std::string> names;
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp properties{};
    if (cudaGetDeviceProperties(&properties, i) == cudaSuccess)
      names.push_back(properties.name);
  }
  if (names.empty())
    why = "no CUDA device";
  return names;
}

void* allocatePinned(std::size_t bytes) {
  void* p = nullptr;
  check(cudaHostAlloc(&p, bytes, cudaHostAllocDefault), "out of pinned memory");
  return p;
}

void freePinned(void* p) noexcept {
  cudaFreeHost(p);
}

namespace {

// A device with what is kept between runs.
struct Device {
  explicit Device(int number) : device(number) {
    std::string why;
    const auto names = listDevices(why);
    if (number < 0 || number >= static_cast<int>(names.size()))
      throw Error(Status::Device, "`device=cuda:" + std::to_string(number) + "`",
                  names.empty() ? why
                                : "there are only " + std::to_string(names.size()) + " devices",
                  "use `device=cpu`");
    check(cudaSetDevice(device), "device");
    backend = std::make_unique<CudaBackend>();
    check(cudaStreamCreateWithFlags(&upload, cudaStreamNonBlocking), "no stream");
    events = std::make_unique<Events>();
  }

  // From pageable memory by way of pinned halves, so that copying in and copying over overlap.
  void copyUp(void* to, const void* from, u64 bytes) {
    if (bytes == 0)
      return;
    const cudaStream_t stream = upload;
    if (isPinned(from)) {
      check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream), "upload");
      return;
    }
    constexpr u64 kHalf = u64(4) << 20;
    unsigned char* staging = uploadStaging.atLeast(2 * kHalf);
    for (u64 done = 0; done < bytes; done += kHalf) {
      const int half = static_cast<int>(done / kHalf % 2);
      if (halfDone[half] == nullptr)
        check(cudaEventCreateWithFlags(&halfDone[half], cudaEventDisableTiming), "event");
      else
        check(cudaEventSynchronize(halfDone[half]), "upload");
      const u64 size = std::min(kHalf, bytes - done);
      unsigned char* place = staging + half * kHalf;
      std::memcpy(place, static_cast<const unsigned char*>(from) + done, size);
      check(cudaMemcpyAsync(static_cast<unsigned char*>(to) + done, place, size,
                            cudaMemcpyHostToDevice, stream),
            "upload");
      check(cudaEventRecord(halfDone[half], stream), "upload");
    }
  }

  void begin(const Progress* progress) {
    check(cudaSetDevice(device), "device");
    backend->release();
    backend->clearStages();
    backend->setProgress(progress);
    events->record(0, upload);
    events->record(4, backend->stream());
  }

  // Starts a run; returns where the mesh will be.
  MeshView begin(const MeshView& mesh, const Job& job, const Progress* progress) {
    begin(progress);
    // Parts of some megabytes: smaller ones are launches for little.
    const u64 cells = std::max(mesh.tetCount, mesh.triangleCount);
    const u64 parts = std::min<u64>(cells / 200000 + 1, CudaBackend::kParts);
    backend->setArriving(job.resident ? 0 : static_cast<int>(parts));
    const MeshView view = job.resident ? mesh : arrive(mesh);
    events->record(1, upload);
    return view;
  }

  // Uploads an array that is needed until the next run.
  const void* copied(const void* from, u64 bytes) {
    void* to = backend->alloc<u8>(bytes);
    copyUp(to, from, bytes);
    return to;
  }

  // After the last of a run whose results came down by the way.
  void finish() {
    events->record(2, backend->stream());
    backend->await();
    times = {events->seconds(0, 1), events->seconds(4, 2), 0, backend->stageSeconds()};
  }

  // After the last of a run whose result is a grid on the device.
  Result finish(Result result, bool downloads) {
    const cudaStream_t stream = backend->stream();
    result.device = result.bytes;
    result.bytes = nullptr;
    events->record(2, stream);
    if (downloads && result.device != nullptr) {
      unsigned char* host = download.atLeast(result.counts.bufferBytes);
      backend->fetch(host, result.device, result.counts.bufferBytes);
      result.bytes = host;
    }
    events->record(3, stream);
    backend->await();
    times = {events->seconds(0, 1), events->seconds(4, 2), events->seconds(2, 3),
             backend->stageSeconds()};
    return result;
  }

  // After a failure: nothing reads the caller's arrays any more.
  void settle() {
    cudaSetDevice(device);
    cudaStreamSynchronize(upload);
    backend->settle();
    cudaGetLastError();
  }

  // Where a dense array goes to, of elements of `size` bytes.
  u8* placeIn(const DeviceArray& to, u64 at, const VoxelRange& range, u64 size) {
    const u64 bytes = range.voxels() * size;
    if (to.device() != device || at % size != 0 || at > to.bytes() || bytes > to.bytes() - at)
      throw Error(Status::Usage, "", "the array is too small or another device's");
    check(cudaSetDevice(device), "device");
    return static_cast<u8*>(to.data()) + at;
  }

  // f(); settles if it fails.
  template <typename F>
  auto settled(const F& f) {
    try {
      return f();
    } catch (...) {
      settle();
      throw;
    }
  }

  MeshView keep(const MeshView& mesh) {
    check(cudaSetDevice(device), "device");
    const auto place = [&](const void* from, u64 bytes) -> void* {
      if (from == nullptr)
        return nullptr;
      void* p = nullptr;
      check(cudaMalloc(&p, std::max<u64>(bytes, 1)), "out of memory");
      kept.push_back(p);
      copyUp(p, from, bytes);
      return p;
    };
    MeshView view = mesh;
    view.points = static_cast<const double*>(place(mesh.points, mesh.pointCount * 24));
    view.tets = static_cast<const std::uint32_t*>(place(mesh.tets, mesh.tetCount * 16));
    view.values = static_cast<const std::int32_t*>(place(mesh.values, mesh.tetCount * 4));
    view.triangles =
        static_cast<const std::uint32_t*>(place(mesh.triangles, mesh.triangleCount * 12));
    check(cudaStreamSynchronize(upload), "upload");
    return view;
  }

  // Starts the upload of a mesh, cells in parts, and returns where it will be.
  MeshView arrive(const MeshView& mesh) {
    MeshView view = mesh;
    double* points = backend->alloc<double>(3 * mesh.pointCount);
    view.points = points;
    copyUp(points, mesh.points, 24 * mesh.pointCount);
    backend->recordPoints(upload);
    if (mesh.values != nullptr) {
      std::int32_t* values = backend->alloc<std::int32_t>(mesh.tetCount);
      view.values = values;
      copyUp(values, mesh.values, 4 * mesh.tetCount);
    }
    if (mesh.triangles != nullptr)
      view.triangles = arriveCells(mesh.triangles, 3, mesh.triangleCount);
    else
      view.tets = arriveCells(mesh.tets, 4, mesh.tetCount);
    return view;
  }
  const u32* arriveCells(const u32* cells, u64 corners, u64 count) {
    u32* there = backend->alloc<u32>(corners * count);
    const u64 parts = static_cast<u64>(backend->parts());
    for (u64 part = 0; part < parts; ++part) {
      const u64 first = corners * (count * part / parts),
                end = corners * (count * (part + 1) / parts);
      copyUp(there + first, cells + first, (end - first) * sizeof(u32));
      backend->recordCells(static_cast<int>(part), upload);
    }
    return there;
  }

  // Samples this device's share of a job.
  Counts sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                const Progress* progress, ShareOf share) {
    return sampleBy(mesh, job, progress, share, [&](auto& pipeline, const auto&... owners) {
      LeafSampler<CudaBackend>(*backend, pipeline, owners...).run(receiver);
    });
  }

  Counts sampleGrids(const MeshView& mesh, const FieldJob& job, GridReceiver& receiver,
                     const Progress* progress) {
    return sampleBy(mesh, job, progress, {}, [&](auto& pipeline, const auto&... owners) {
      GridSampler<CudaBackend>(*backend, pipeline, owners...)
          .run([&](const GridCounts& made, const u8* buffer) {
            backend->stage("download");
            backend->fetch(receiver.place(made), buffer, made.bytes);
            backend->await();
          });
    });
  }

  // sampler(pipeline, mesh, job, arrays), of what is on the device.
  template <typename Sampler>
  Counts sampleBy(const MeshView& mesh, const FieldJob& job, const Progress* progress,
                  ShareOf share, const Sampler& sampler) {
    const Job owners = ownersOf(job);
    const MeshView view = begin(mesh, owners, progress);
    const SourceFields fields =
        placeFields(*backend, job, mesh.tetCount,
                    [&](const void* from, u64 bytes) { return copied(from, bytes); });
    backend->recordFields(upload);
    events->record(1, upload);
    Pipeline<CudaBackend> pipeline(*backend, view, owners, share);
    pipeline.buildOwners();
    backend->awaitFields();
    Counts counts = pipeline.countsOf({}, 0);
    counts.leaves = pipeline.leaves().count;
    sampler(pipeline, view, job, fields);
    finish();
    return counts;
  }

  // This device's share of a band's nodes.
  u64 distances(const DistanceJob& job, DistanceReceiver& receiver, const Progress* progress,
                const NodeShare& share) {
    begin(progress);
    std::vector<u64> starts;
    const PlacedBand band = placeBand(
        job, share, starts, [&](const void* from, u64 bytes) { return copied(from, bytes); });
    backend->recordFields(upload);
    events->record(1, upload);
    backend->awaitFields();
    const u64 leaves = BandLeaves<CudaBackend>(*backend, band, starts).run(share.begin, receiver);
    finish();
    return leaves;
  }

  Result coverage(const CoverageJob& job, const Progress* progress) {
    begin(progress);
    CoverageGrid<CudaBackend> grid(
        *backend, job, [&](const void* from, u64 bytes) { return copied(from, bytes); });
    backend->recordFields(upload);
    events->record(1, upload);
    backend->awaitFields();
    return finish(grid.run(), job.download);
  }

  Result levelSet(const MeshView& mesh, const LevelSetJob& job, const Progress* progress) {
    const Job mask = maskJobOf(job);
    MeshView shape = mesh;
    shape.values = nullptr;
    const MeshView view = begin(shape, mask, progress);
    LevelSetJob here = job;
    if (job.faces.points != nullptr) {
      here.faces.points = static_cast<const LatticePoint*>(
          copied(job.faces.points, job.faces.pointCount * sizeof(LatticePoint)));
      here.faces.faces =
          static_cast<const u32*>(copied(job.faces.faces, job.faces.faceCount * 4 * sizeof(u32)));
      events->record(1, upload);
    }
    backend->recordFields(upload);
    LevelSetGrid<CudaBackend> grid(*backend, view, here, mask);
    return finish(grid.run([this] { backend->awaitFields(); }), job.download);
  }

  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() {
    cudaSetDevice(device);
    for (cudaEvent_t e : halfDone)
      if (e != nullptr)
        cudaEventDestroy(e);
    for (void* p : kept)
      cudaFree(p);
    cudaStreamDestroy(upload);
  }

  int device;
  std::unique_ptr<CudaBackend> backend;
  std::unique_ptr<Events> events;
  cudaStream_t upload = nullptr;
  PinnedMemory uploadStaging;
  GridMemory download;
  cudaEvent_t halfDone[2] = {};
  std::vector<void*> kept;
  Times times;
};

} // namespace

struct DeviceVoxelizer::State : Device {
  using Device::Device;
};

DeviceVoxelizer::DeviceVoxelizer(int device) : state_(std::make_unique<State>(device)) {}
DeviceVoxelizer::~DeviceVoxelizer() = default;

MeshView DeviceVoxelizer::keep(const MeshView& mesh) {
  return state_->keep(mesh);
}

Result DeviceVoxelizer::run(const MeshView& mesh, const Job& job, const Progress* progress) {
  State& s = *state_;
  return s.settled([&] {
    const MeshView view = s.begin(mesh, job, progress);
    return s.finish(Pipeline<CudaBackend>(*s.backend, view, job).run(), job.download);
  });
}

Result DeviceVoxelizer::levelSet(const MeshView& mesh, const LevelSetJob& job,
                                 const Progress* progress) {
  return state_->settled([&] { return state_->levelSet(mesh, job, progress); });
}

void DeviceVoxelizer::expand(const Result& result, GridType type, const VoxelRange& range,
                             DeviceArray& to, std::uint64_t at) {
  u8* const place = state_->placeIn(to, at, range, 1);
  expandActive(*state_->backend, kindOf(type), result.device, range, place);
  state_->backend->await();
}

void DeviceVoxelizer::expandValues(const Result& result, const VoxelRange& range, DeviceArray& to,
                                   std::uint64_t at) {
  auto* const place = reinterpret_cast<float*>(state_->placeIn(to, at, range, sizeof(float)));
  expandRows<float>(*state_->backend, result.device, range, FloatValues{place});
  state_->backend->await();
}

Counts DeviceVoxelizer::sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                               const Progress* progress) {
  return state_->settled([&] { return state_->sample(mesh, job, receiver, progress, {}); });
}

Counts DeviceVoxelizer::sampleGrids(const MeshView& mesh, const FieldJob& job,
                                    GridReceiver& receiver, const Progress* progress) {
  return state_->settled([&] { return state_->sampleGrids(mesh, job, receiver, progress); });
}

u64 DeviceVoxelizer::distances(const DistanceJob& job, DistanceReceiver& receiver,
                               const Progress* progress) {
  return state_->settled(
      [&] { return state_->distances(job, receiver, progress, shareOfNodes(job, 0, 1)); });
}

Result DeviceVoxelizer::coverage(const CoverageJob& job, const Progress* progress) {
  return state_->settled([&] { return state_->coverage(job, progress); });
}

struct SharedVoxelizer::State {
  std::vector<std::unique_ptr<Device>> devices;
  std::vector<MeshView> kept; // by device
  std::vector<u64> leaves;
  GridMemory grid;

  // f(number) for all devices at once, a thread each; the first one's exception is thrown.
  template <typename F>
  void forDevices(const F& f) {
    std::vector<std::exception_ptr> failed(devices.size());
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < devices.size(); ++k)
      threads.emplace_back([&, k] {
        try {
          check(cudaSetDevice(devices[k]->device), "device");
          f(k);
        } catch (...) {
          devices[k]->settle();
          failed[k] = std::current_exception();
        }
      });
    for (std::thread& t : threads)
      t.join();
    for (const std::exception_ptr& e : failed)
      if (e != nullptr)
        std::rethrow_exception(e);
  }
};

SharedVoxelizer::SharedVoxelizer(const std::vector<int>& devices)
    : state_(std::make_unique<State>()) {
  if (devices.empty())
    throw Error(Status::Usage, "`device`", "no device is named");
  for (std::size_t k = 0; k < devices.size(); ++k) {
    if (std::find(devices.begin(), devices.begin() + static_cast<std::ptrdiff_t>(k), devices[k]) !=
        devices.begin() + static_cast<std::ptrdiff_t>(k))
      throw Error(Status::Usage, "`device`",
                  "device " + std::to_string(devices[k]) + " is named twice");
    state_->devices.push_back(std::make_unique<Device>(devices[k]));
  }
}
SharedVoxelizer::~SharedVoxelizer() = default;

void SharedVoxelizer::keep(const MeshView& mesh) {
  state_->kept.clear();
  for (const auto& device : state_->devices)
    state_->kept.push_back(device->keep(mesh));
}

Result SharedVoxelizer::run(const MeshView& mesh, const Job& job, const Progress* progress) {
  State& s = *state_;
  const std::size_t count = s.devices.size();
  std::vector<MeshView> views(count);
  std::vector<std::unique_ptr<Pipeline<CudaBackend>>> pipelines(count);
  std::vector<NodeCounts> nodes(count);
  s.forDevices([&](std::size_t k) {
    views[k] = s.devices[k]->begin(job.resident ? s.kept.at(k) : mesh, job, progress);
    pipelines[k] = std::make_unique<Pipeline<CudaBackend>>(
        *s.devices[k]->backend, views[k], job,
        ShareOf{static_cast<int>(k), static_cast<int>(count)});
    nodes[k] = pipelines[k]->build();
  });
  if (!pipelines[0]->closed()) {
    Result open;
    open.counts = pipelines[0]->countsOf({}, 0);
    return open;
  }
  const SharedLayout layout(pipelines[0]->kind(), nodes);
  checkCount(layout.all.leaves);
  u8* grid = job.download ? s.grid.atLeast(layout.whole.size) : nullptr;
  std::vector<RootsOfShare> roots(count);
  s.forDevices([&](std::size_t k) {
    Device& device = *s.devices[k];
    roots[k] = writeShare(*device.backend, *pipelines[k], layout.shares[k], grid);
    device.backend->stage("");
    device.events->record(2, device.backend->stream());
    device.backend->await();
    device.times = {device.events->seconds(0, 1), device.events->seconds(4, 2), 0,
                    device.backend->stageSeconds()};
  });
  if (grid != nullptr)
    writeSharedHead(pipelines[0]->space(), pipelines[0]->kind(), pipelines[0]->values(),
                    pipelines[0]->makeHeader(), layout, roots, grid);
  s.leaves.clear();
  for (const NodeCounts& n : nodes)
    s.leaves.push_back(n.leaves);
  Result result;
  result.counts = pipelines[0]->countsOf(layout.all, layout.whole.size);
  result.bytes = grid;
  return result;
}

Counts SharedVoxelizer::sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                               const Progress* progress) {
  State& s = *state_;
  std::vector<Counts> counts(s.devices.size());
  s.forDevices([&](std::size_t k) {
    counts[k] =
        s.devices[k]->sample(mesh, job, receiver, progress,
                             ShareOf{static_cast<int>(k), static_cast<int>(s.devices.size())});
  });
  s.leaves.clear();
  Counts all = counts[0];
  all.leaves = 0;
  for (const Counts& c : counts) {
    s.leaves.push_back(c.leaves);
    all.leaves += c.leaves;
  }
  return all;
}

Counts SharedVoxelizer::sampleGrids(const MeshView& mesh, const FieldJob& job,
                                    GridReceiver& receiver, const Progress* progress) {
  State& s = *state_;
  Device& first = *s.devices.front();
  const Counts counts =
      first.settled([&] { return first.sampleGrids(mesh, job, receiver, progress); });
  s.leaves.assign(s.devices.size(), 0);
  s.leaves.front() = counts.leaves;
  return counts;
}

u64 SharedVoxelizer::distances(const DistanceJob& job, DistanceReceiver& receiver,
                               const Progress* progress) {
  State& s = *state_;
  s.leaves.assign(s.devices.size(), 0);
  s.forDevices([&](std::size_t k) {
    const auto share = shareOfNodes(job, static_cast<int>(k), static_cast<int>(s.devices.size()));
    s.leaves[k] = s.devices[k]->distances(job, receiver, progress, share);
  });
  u64 all = 0;
  for (const u64 leaves : s.leaves)
    all += leaves;
  return all;
}

Result SharedVoxelizer::coverage(const CoverageJob& job, const Progress* progress) {
  State& s = *state_;
  Device& first = *s.devices.front();
  const Result result = first.settled([&] { return first.coverage(job, progress); });
  s.leaves.assign(s.devices.size(), 0);
  s.leaves.front() = result.counts.leaves;
  return result;
}

Result SharedVoxelizer::levelSet(const MeshView& mesh, const LevelSetJob& job,
                                 const Progress* progress) {
  State& s = *state_;
  Device& first = *s.devices.front();
  const Result result = first.settled(
      [&] { return first.levelSet(job.resident ? s.kept.front() : mesh, job, progress); });
  s.leaves.assign(s.devices.size(), 0);
  s.leaves.front() = result.counts.leaves;
  return result;
}

std::vector<Times> SharedVoxelizer::times() const {
  std::vector<Times> result;
  for (const auto& device : state_->devices)
    result.push_back(device->times);
  return result;
}

std::vector<std::uint64_t> SharedVoxelizer::leaves() const {
  return state_->leaves;
}

Speeds DeviceVoxelizer::measureSpeeds() {
  State& s = *state_;
  check(cudaSetDevice(s.device), "device");
  constexpr u64 kBytes = u64(256) << 20;
  PinnedMemory pinned;
  unsigned char* host = pinned.atLeast(kBytes);
  std::memset(host, 1, kBytes);
  s.backend->release();
  u8 *a = s.backend->alloc<u8>(kBytes), *b = s.backend->alloc<u8>(kBytes);
  const cudaStream_t stream = s.backend->stream();
  const auto seconds = [&](void* to, const void* from) {
    double best = 1e9;
    for (int i = 0; i < 6; ++i) {
      s.events->record(0, stream);
      check(cudaMemcpyAsync(to, from, kBytes, cudaMemcpyDefault, stream), "copy");
      s.events->record(1, stream);
      check(cudaStreamSynchronize(stream), "copy");
      best = std::min(best, s.events->seconds(0, 1));
    }
    return best;
  };
  Speeds speeds;
  speeds.up = static_cast<double>(kBytes) / seconds(a, host);
  speeds.within = 2 * static_cast<double>(kBytes) / seconds(b, a);
  speeds.down = static_cast<double>(kBytes) / seconds(host, b);
  return speeds;
}

Times DeviceVoxelizer::times() const {
  return state_->times;
}

std::uint64_t DeviceVoxelizer::allocations() const {
  return state_->backend->allocations() + state_->uploadStaging.calls() + state_->download.calls() +
         state_->kept.size();
}

std::uint64_t DeviceVoxelizer::deviceBytes() const {
  return state_->backend->held();
}

} // namespace tetvdb::nano
