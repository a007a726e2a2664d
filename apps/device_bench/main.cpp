// SPDX-License-Identifier: Apache-2.0
//
// How long jobs take on the GPU, with the floor beside it: the time that the fewest transfers would
// take at the speeds measured in the same run. Medians of several runs after warming up.
#include "FieldsOnDevice.h"
#include "LevelSetOnDevice.h"
#include "Measure.h"
#include "Meshes.h"
#include "PaperOnDevice.h"
#include "SoupsOnDevice.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/Voxelize.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace tetvdb;
using bench::median;
using bench::now;
using nano::GridType;
using nano::Method;

constexpr int repeats = 20;

// A mesh in pinned memory.
struct Pinned {
  explicit Pinned(const TetMesh& mesh) {
    const std::size_t points = mesh.points.size() * 24, tets = mesh.tets.size() * 4;
    memory = nano::allocatePinned(points + tets);
    std::memcpy(memory, mesh.points.data(), points);
    std::memcpy(static_cast<char*>(memory) + points, mesh.tets.data(), tets);
    view = {static_cast<const double*>(memory), mesh.points.size(),
            reinterpret_cast<const std::uint32_t*>(static_cast<char*>(memory) + points),
            mesh.tetCount(), nullptr};
  }
  ~Pinned() { nano::freePinned(memory); }
  Pinned(const Pinned&) = delete;
  Pinned& operator=(const Pinned&) = delete;
  double bytes() const { return double(view.pointCount) * 24 + double(view.tetCount) * 16; }

  void* memory;
  nano::MeshView view;
};

nano::Job jobAt(int resolution, GridType type, Method method = Method::Auto) {
  nano::Job job;
  job.type = type;
  job.method = method;
  // Balls have radius 1.
  const GridTransform transform = bench::transformAt(resolution);
  std::copy(transform.voxelSize.begin(), transform.voxelSize.end(), job.voxelSize);
  std::copy(transform.origin.begin(), transform.origin.end(), job.origin);
  job.name = "grid";
  return job;
}

// A job of the device's, measured; and what came of it.
struct GridMeasured : bench::Measured {
  nano::Counts counts;
};

GridMeasured measure(nano::DeviceVoxelizer& device, const nano::MeshView& mesh,
                     const nano::Job& job, int times) {
  GridMeasured m;
  static_cast<bench::Measured&>(m) =
      bench::measure(device, times, [&] { m.counts = device.run(mesh, job).counts; });
  return m;
}

void print(const std::string& name, const GridMeasured& m, double floorSeconds) {
  bench::print(name, m, floorSeconds,
               fmt::format("leaves {} lower {} MB {:.1f} faces {} {}", m.counts.leaves,
                           m.counts.lowerNodes, double(m.counts.bufferBytes) * 1e-6,
                           m.counts.boundaryFaces,
                           m.counts.method == Method::Boundary ? "boundary" : "tets"));
}

VoxelizeOptions optionsAt(int resolution, GridKind kind) {
  VoxelizeOptions options;
  options.grids = {kind};
  const GridTransform transform = bench::transformAt(resolution);
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  return options;
}

// Bytes a second: to the device, from it, and within (read and write counted).
nano::Speeds speeds;

double deviceFloor(double bytes) {
  return bytes / speeds.within;
}

void paperTable(nano::DeviceVoxelizer& device, const std::string& name, const Pinned& mesh) {
  const nano::MeshView resident = device.keep(mesh.view);
  for (Method method : {Method::Tets, Method::Boundary}) {
    nano::Job job = jobAt(256, GridType::Mask, method);
    const char* by = method == Method::Tets ? ", by tets" : ", by boundary";
    job.download = false;
    const GridMeasured up = measure(device, mesh.view, job, repeats);
    const double within = deviceFloor(mesh.bytes() + double(up.counts.bufferBytes));
    print(name + " at 256^3 from pinned" + by, up, mesh.bytes() / speeds.up + within);
    job.resident = true;
    print(name + " at 256^3 resident" + by, measure(device, resident, job, repeats), within);
  }
  nano::Job down = jobAt(256, GridType::Mask);
  const GridMeasured all = measure(device, mesh.view, down, repeats);
  print(name + " at 256^3, grid to the host", all,
        mesh.bytes() / speeds.up + double(all.counts.bufferBytes) / speeds.down);
  std::vector<double> total, kernel, allocation;
  bench::PaperTimes t;
  for (int i = 0; i < repeats / 4 + 2; ++i) {
    t = bench::paperOnDevice(mesh.view, down.origin, down.voxelSize[0], 258);
    total.push_back(t.total);
    kernel.push_back(t.kernel);
    allocation.push_back(t.allocation);
  }
  std::printf("%-44s %9.3f ms  kernel %.3f allocation %.3f | voxels %llu\n",
              (name + " at 256^3, the paper's way").c_str(), median(total) * 1e3,
              median(kernel) * 1e3, median(allocation) * 1e3,
              static_cast<unsigned long long>(t.voxels));
  std::fflush(stdout);
}

void large(const Pinned& ball, int resolution, GridType type, int times, const std::string& name) {
  nano::DeviceVoxelizer device; // of its own: no memory shaped by other models
  const nano::MeshView resident = device.keep(ball.view);
  nano::Job job = jobAt(resolution, type);
  job.resident = true;
  job.download = false;
  try {
    const GridMeasured m = measure(device, resident, job, times);
    print(name + " at " + std::to_string(resolution) + "^3 resident", m,
          deviceFloor(ball.bytes() + double(m.counts.bufferBytes)));
    std::printf("  device memory %.1f GB\n", double(device.deviceBytes()) * 1e-9);
  } catch (const Error& e) {
    std::printf("%s at %d^3: %s\n", name.c_str(), resolution, e.what());
  }
}

// The same by all devices of the host, sharing the grid; the longest build counts.
void shared(const TetMesh& ball, int resolution, int times, int count) {
  std::vector<int> numbers;
  for (int k = 0; k < count; ++k)
    numbers.push_back(k);
  nano::Job job = jobAt(resolution, GridType::Mask);
  job.resident = true;
  job.download = false;
  try {
    nano::SharedVoxelizer devices(numbers);
    const Pinned pinned(ball);
    devices.keep(pinned.view);
    std::vector<double> wall, slowest;
    nano::Counts counts;
    for (int i = 0; i < times + 1; ++i) {
      const double start = now();
      counts = devices.run(pinned.view, job).counts;
      const double seconds = now() - start;
      double build = 0;
      for (const nano::Times& t : devices.times())
        build = std::max(build, t.build);
      if (i == 0)
        continue;
      wall.push_back(seconds);
      slowest.push_back(build);
    }
    std::printf(
        "mask of %zu tets at %d^3 by %d device(s): %.1f ms, longest build %.1f ms, %.1f GB, "
        "leaves",
        ball.tetCount(), resolution, count, median(wall) * 1e3, median(slowest) * 1e3,
        double(counts.bufferBytes) * 1e-9);
    for (std::uint64_t leaves : devices.leaves())
      std::printf(" %llu", static_cast<unsigned long long>(leaves));
    std::printf("\n");
  } catch (const Error& e) {
    std::printf("mask at %d^3 by %d device(s): %s\n", resolution, count, e.what());
  }
  std::fflush(stdout);
}

// What --device auto goes by, beside what jobs of the program take.
void automatic(const TetMesh& ball, const char* name, int resolution, GridKind kind) {
  const VoxelizeOptions options = optionsAt(resolution, kind);
  bench::besideCpu(fmt::format("{}, {} at {}^3", name, infoOf(kind).name, resolution),
                   estimateCost(boxOfUsed(ball.points, ball.tets), ball.tetCount(),
                                chooseTransform(ball, options), options),
                   3, [&](const DeviceChoice& choice) {
                     DeviceUsed used;
                     Report report;
                     Progress progress;
                     voxelize(ball, options, choice, used, nullptr, report, progress);
                   });
}

void automatic(const TriangleMesh& sphere, const char* name, int resolution, GridKind kind) {
  const VoxelizeOptions options = optionsAt(resolution, kind);
  bench::besideCpu(fmt::format("{}, {} at {}^3", name, infoOf(kind).name, resolution),
                   estimateCost(sphere, chooseTransform(sphere, options), options), 3,
                   [&](const DeviceChoice& choice) {
                     DeviceUsed used;
                     Report report;
                     Progress progress;
                     voxelize(sphere, SolidOptions(), options, choice, used, nullptr, report,
                              progress);
                   });
}

// The paper's data set: many models, each uploaded, built and downloaded.
void dataSet(int models, int workers) {
  const TetMesh ball = meshes::ball(26, 1, {0, 0, 0});
  std::vector<std::unique_ptr<Pinned>> pinned;
  for (int i = 0; i < models; ++i) {
    meshes::Random random(static_cast<std::uint64_t>(i) + 1);
    const Vec3d size{random.between(0.6, 1), random.between(0.6, 1), random.between(0.6, 1)};
    const double bend = random.between(-0.3, 0.3);
    pinned.push_back(std::make_unique<Pinned>(meshes::mapped(ball, [&](const Vec3d& p) {
      return Vec3d{p[0] * size[0], p[1] * size[1], p[2] * size[2] * (1 + bend * p[0]) / 1.3};
    })));
  }
  std::vector<std::unique_ptr<nano::DeviceVoxelizer>> devices;
  for (int w = 0; w < workers; ++w)
    devices.push_back(std::make_unique<nano::DeviceVoxelizer>(0));
  const nano::Job job = jobAt(256, GridType::Mask);
  std::uint64_t bytes = 0;
  const auto run = [&](int count) {
    std::atomic<int> next{0};
    std::atomic<std::uint64_t> downloaded{0};
    std::vector<std::thread> threads;
    std::vector<std::vector<double>> each(devices.size());
    const double start = now();
    for (std::size_t w = 0; w < devices.size(); ++w)
      threads.emplace_back([&, w] {
        for (int i = next++; i < count; i = next++) {
          const double begin = now();
          downloaded += devices[w]->run(pinned[std::size_t(i)]->view, job).counts.bufferBytes;
          each[w].push_back(now() - begin);
        }
      });
    for (std::thread& t : threads)
      t.join();
    const double seconds = now() - start;
    bytes = downloaded;
    std::vector<double> all;
    for (const auto& e : each)
      all.insert(all.end(), e.begin(), e.end());
    return std::make_pair(seconds / count, median(all));
  };
  // The first model of each worker.
  std::uint64_t before = 0, after = 0;
  for (const auto& d : devices) {
    d->run(pinned[0]->view, job);
    before += d->allocations();
  }
  const auto [mean, midpoint] = run(models);
  for (const auto& d : devices)
    after += d->allocations();
  const double floorSeconds =
      std::max(pinned[0]->bytes() / speeds.up, double(bytes) / models / speeds.down);
  std::printf(
      "%d models of %zu tets, %d at a time: %.3f ms a model, %.3f ms latency (median), floor "
      "%.3f ms (%.1f %%), %.2f MB down each, allocations after the first %llu\n",
      models, ball.tetCount(), workers, mean * 1e3, midpoint * 1e3, floorSeconds * 1e3,
      100 * floorSeconds / mean, double(bytes) / models * 1e-6,
      static_cast<unsigned long long>(after - before));
  std::fflush(stdout);
}

// The CPU on the same machine.
void onCpu(const std::string& name, const TetMesh& mesh, int resolution, GridKind kind) {
  const VoxelizeOptions options = optionsAt(resolution, kind);
  std::vector<double> seconds;
  for (int i = 0; i < 5; ++i) {
    Report report;
    Progress progress;
    const double start = now();
    voxelize(mesh, options, report, progress);
    seconds.push_back(now() - start);
  }
  std::printf("%-44s %9.3f ms\n",
              (name + " at " + std::to_string(resolution) + "^3 on the CPU").c_str(),
              median(seconds) * 1e3);
  std::fflush(stdout);
}

constexpr const char* kHelp =
    R"(tetvdb_device_bench [CASE...]   measures jobs on the GPU; without cases all but "soups FILE"

paper, paper5, paper6, paper7   10^5, 10^6, 10^7 tets at 256^3, by each method and by the paper's
owners                          who owns each voxel, at 1024^3
fields                          arrays of tets sampled at voxels
levelset                        distances around tets and triangles
dataset                         1000 models of tets, 1 to 4 at a time
soups [FILE...]                 1000 closed triangle meshes, 1 to 8 at a time, against the CPU's
shared                          one grid by all GPUs of the host
auto                            what --device auto goes by
large                           up to 65536^3
)";

} // namespace

int main(int argc, char** argv) {
  std::set<std::string> cases;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--help" || argument == "-h") {
      std::printf("%s", kHelp);
      return 0;
    }
    if (cases.count("soups") != 0)
      files.push_back(argument);
    else
      cases.insert(argument);
  }
  const auto wanted = [&](const char* name) { return cases.empty() || cases.count(name) != 0; };
  try {
    std::string why;
    const double begin = now();
    const auto devices = nano::listDevices(why);
    if (devices.empty()) {
      std::printf("no device: %s\n", why.c_str());
      return 6;
    }
    nano::DeviceVoxelizer device(0);
    const double ready = now();
    const TetMesh tiny = meshes::ball(3, 1, {0, 0, 0});
    device.run({tiny.points[0].data(), tiny.points.size(), tiny.tets.data(), tiny.tetCount()},
               jobAt(32, GridType::Fog));
    std::printf("CUDA's start %.3f s, a first model %.3f s more\n", ready - begin, now() - ready);
    speeds = device.measureSpeeds();
    std::printf("%s: up %.1f GB/s, down %.1f GB/s, within %.0f GB/s\n", devices[0].c_str(),
                speeds.up * 1e-9, speeds.down * 1e-9, speeds.within * 1e-9);
    const TetMesh ball5 = meshes::ball(26, 1, {0, 0, 0}), ball6 = meshes::ball(55, 1, {0, 0, 0});
    const Pinned pinned5(ball5), pinned6(ball6);
    const bool paper = wanted("paper");
    if (paper || wanted("paper5")) {
      paperTable(device, "10^5 tets", pinned5);
      onCpu("10^5 tets", ball5, 256, GridKind::Mask);
    }
    if (paper || wanted("paper6")) {
      paperTable(device, "10^6 tets", pinned6);
      onCpu("10^6 tets", ball6, 256, GridKind::Mask);
    }
    if (paper || wanted("paper7")) {
      const TetMesh ball7 = meshes::ball(118, 1, {0, 0, 0});
      paperTable(device, "10^7 tets", Pinned(ball7));
      onCpu("10^7 tets", ball7, 256, GridKind::Mask);
    }
    if (wanted("owners")) {
      large(pinned6, 1024, GridType::Owner, repeats, "owners of 10^6 tets");
      onCpu("owners of 10^6 tets", ball6, 1024, GridKind::TetId);
    }
    if (wanted("fields")) {
      bench::fieldsTable(device, speeds, ball6, "10^6 tets", 256, repeats);
      bench::fieldsTable(device, speeds, ball6, "10^6 tets", 512, 10);
      bench::fieldsTable(device, speeds, meshes::ball(118, 1, {0, 0, 0}), "10^7 tets", 256,
                         repeats);
    }
    if (wanted("levelset")) {
      bench::levelSetTable(device, speeds, ball6, "10^6 tets", 512, repeats);
      bench::levelSetTable(device, speeds, ball6, "10^6 tets", 1024, 10);
      bench::levelSetTable(device, speeds, ball5, "10^5 tets", 2048, 5);
      const TriangleMesh sphere = meshes::sphere({0, 0, 0}, 1, 289);
      bench::levelSetTable(device, speeds, sphere, "668,168 triangles", 512, repeats);
      bench::levelSetTable(device, speeds, sphere, "668,168 triangles", 1024, 10);
    }
    if (wanted("dataset"))
      for (int workers : {1, 2, 3, 4})
        dataSet(1000, workers);
    if (wanted("soups")) {
      bench::soupTable(device, speeds, repeats);
      if (bench::manySoups(speeds, files, 1000) != 0)
        return 1;
    }
    if (wanted("shared"))
      for (int resolution : {32768, 65536})
        for (int count = 1; count <= static_cast<int>(devices.size()); ++count)
          shared(ball5, resolution, resolution == 32768 ? 5 : 3, count);
    if (wanted("auto")) {
      const TriangleMesh sphere = meshes::sphere({0, 0, 0}, 1, 289);
      automatic(sphere, "668,168 triangles", 256, GridKind::Mask);
      automatic(sphere, "668,168 triangles", 1024, GridKind::Density);
      automatic(sphere, "668,168 triangles", 4096, GridKind::Mask);
      automatic(ball5, "10^5 tets", 256, GridKind::Density);
      automatic(ball5, "10^5 tets", 1024, GridKind::Density);
      automatic(ball5, "10^5 tets", 4096, GridKind::Mask);
      automatic(ball6, "10^6 tets", 256, GridKind::TetId);
      automatic(ball6, "10^6 tets", 1024, GridKind::Density);
      automatic(ball6, "10^6 tets", 1024, GridKind::TetId);
      const TetMesh ball7 = meshes::ball(118, 1, {0, 0, 0});
      automatic(ball7, "10^7 tets", 256, GridKind::Mask);
      automatic(ball7, "10^7 tets", 1024, GridKind::Density);
      automatic(ball7, "10^7 tets", 512, GridKind::TetId);
    }
    if (wanted("large")) {
      large(pinned5, 1024, GridType::Fog, repeats, "fog of 10^5 tets");
      large(pinned5, 4096, GridType::Mask, repeats, "mask of 10^5 tets");
      onCpu("mask of 10^5 tets", ball5, 4096, GridKind::Mask);
      large(pinned5, 32768, GridType::Mask, 5, "mask of 10^5 tets");
      large(pinned5, 65536, GridType::Mask, 3, "mask of 10^5 tets");
    }
  } catch (const std::exception& e) {
    std::printf("%s\n", e.what());
    return 1;
  }
  return 0;
}
