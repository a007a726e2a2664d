// SPDX-License-Identifier: Apache-2.0
#include "SoupsOnDevice.h"

#include "Measure.h"
#include "TriangleMeshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/volume/NanoGrids.h"
#include "tetvdb/voxelize/SoupBoundary.h"
#include "tetvdb/voxelize/ViewOfMesh.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <thread>
#include <utility>

namespace tetvdb::bench {
namespace {

constexpr int kResolution = 256;
constexpr std::size_t kMaxTriangles = 20000;

double bytesOf(const TriangleMesh& mesh) {
  return static_cast<double>(mesh.points.size()) * 24 +
         static_cast<double>(mesh.triangleCount()) * 12;
}

nano::Job maskJob(nano::Method method) {
  nano::Job job;
  job.type = nano::GridType::Mask;
  job.method = method;
  job.name = "mask";
  const GridTransform transform = transformAt(kResolution);
  std::copy(transform.voxelSize.begin(), transform.voxelSize.end(), job.voxelSize);
  std::copy(transform.origin.begin(), transform.origin.end(), job.origin);
  return job;
}

std::string cpuHash(const TriangleMesh& mesh) {
  VoxelizeOptions options;
  options.grids = {GridKind::Mask};
  const GridTransform transform = transformAt(kResolution);
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.allowEmpty = true;
  Report report;
  Progress progress;
  return hash(voxelize(mesh, SolidOptions(), options, report, progress).volume);
}

std::string hashOf(const nano::Result& result) {
  auto grids = std::make_shared<GridSet>();
  grids->all.push_back(gridOfNano(result.bytes));
  return hash(Volume(std::move(grids)));
}

// Scaled into the ball of radius 1 around the origin.
void normalize(TriangleMesh& mesh) {
  const WorldBox box = boxOfUsed(mesh.points, mesh.triangles);
  double radius = 0;
  for (Vec3d& p : mesh.points) {
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] -= (box.min[k] + box.max[k]) / 2;
      square += p[k] * p[k];
    }
    radius = std::max(radius, std::sqrt(square));
  }
  for (Vec3d& p : mesh.points)
    for (double& c : p)
      c /= radius;
}

std::vector<TriangleMesh> closedMeshes(const std::vector<std::string>& files) {
  std::vector<TriangleMesh> meshes;
  for (const std::string& file : files)
    try {
      Report report;
      Progress progress;
      TriangleMesh mesh = readTriangles(file, report, progress);
      cleanTriangles(mesh, {}, progress);
      if (mesh.triangles.empty() || mesh.triangleCount() > kMaxTriangles ||
          !soupBoundary(mesh, progress).edges.empty())
        continue;
      normalize(mesh);
      meshes.push_back(std::move(mesh));
    } catch (const Error&) {
      continue; // not a triangle mesh, or a broken one
    }
  if (meshes.empty())
    meshes = {meshes::sphere({0, 0, 0}, 1, 50), meshes::torus(0.7, 0.29, 200, 50)};
  return meshes;
}

TriangleMesh turned(const TriangleMesh& mesh, std::uint64_t seed) {
  meshes::Random random(seed);
  // A unit quaternion by chance.
  double q[4], square = 0;
  for (double& c : q) {
    c = random.between(-1, 1);
    square += c * c;
  }
  for (double& c : q)
    c /= std::sqrt(square);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return meshes::moved(mesh, [&](const Vec3d& p) {
    return Vec3d{
        (1 - 2 * (y * y + z * z)) * p[0] + 2 * (x * y - w * z) * p[1] + 2 * (x * z + w * y) * p[2],
        2 * (x * y + w * z) * p[0] + (1 - 2 * (x * x + z * z)) * p[1] + 2 * (y * z - w * x) * p[2],
        2 * (x * z - w * y) * p[0] + 2 * (y * z + w * x) * p[1] + (1 - 2 * (x * x + y * y)) * p[2]};
  });
}

} // namespace

void soupTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, int times) {
  const TriangleMesh sphere = meshes::sphere({0, 0, 0}, 1, 50);
  for (const nano::Method method : {nano::Method::Dense, nano::Method::Boundary}) {
    nano::Counts counts;
    const Measured measured = measure(
        device, times, [&] { counts = device.run(viewOf(sphere), maskJob(method)).counts; });
    print(fmt::format("{} triangles at {}^3, {}", sphere.triangleCount(), kResolution,
                      method == nano::Method::Dense ? "dense" : "sorted"),
          measured,
          bytesOf(sphere) / speeds.up + static_cast<double>(counts.bufferBytes) / speeds.down,
          fmt::format("leaves {} MB {:.2f}", counts.leaves,
                      static_cast<double>(counts.bufferBytes) * 1e-6));
  }
  // To a byte a voxel in the device's memory, as tensors are.
  nano::Job job = maskJob(nano::Method::Auto);
  job.download = false;
  nano::VoxelRange range{};
  for (std::size_t k = 0; k < 3; ++k) {
    range.min[k] = static_cast<std::int32_t>(std::floor((-1 - job.origin[k]) / job.voxelSize[k]));
    range.size[k] = kResolution;
  }
  nano::DeviceArray tensor(0, std::uint64_t(kResolution) * kResolution * kResolution);
  const Measured measured = measure(device, times, [&] {
    device.expand(device.run(viewOf(sphere), job), job.type, range, tensor);
  });
  print(fmt::format("{} triangles at {}^3, to a tensor", sphere.triangleCount(), kResolution),
        measured,
        bytesOf(sphere) / speeds.up + 2 * static_cast<double>(tensor.bytes()) / speeds.within, "");
}

int manySoups(const nano::Speeds& speeds, const std::vector<std::string>& files, int count) {
  const std::vector<TriangleMesh> sources = closedMeshes(files);
  std::vector<TriangleMesh> models;
  double triangles = 0, bytes = 0;
  for (int i = 0; i < count; ++i) {
    models.push_back(turned(sources[static_cast<std::size_t>(i) % sources.size()],
                            static_cast<std::uint64_t>(i) + 1));
    triangles += static_cast<double>(models.back().triangleCount());
    bytes += bytesOf(models.back());
  }
  const nano::Job job = maskJob(nano::Method::Auto);
  int differ = 0;
  {
    nano::DeviceVoxelizer device;
    double onCpu = 0;
    for (const TriangleMesh& model : models) {
      const double start = now();
      const std::string expected = cpuHash(model);
      onCpu += now() - start;
      const nano::Result made = device.run(viewOf(model), job);
      differ += made.bytes == nullptr || hashOf(made) != expected;
    }
    std::printf("%d models turned from %zu closed meshes, %.0f triangles each: %d differ from the "
                "CPU's grids; CPU with hash %.3f ms a model\n",
                count, sources.size(), triangles / count, differ, onCpu / count * 1e3);
  }
  for (const unsigned workers : {1u, 2u, 4u, 8u}) {
    std::vector<std::unique_ptr<nano::DeviceVoxelizer>> devices;
    for (unsigned w = 0; w < workers; ++w) {
      devices.push_back(std::make_unique<nano::DeviceVoxelizer>(0));
      for (const TriangleMesh& source : sources)
        devices.back()->run(viewOf(source), job);
    }
    std::uint64_t before = 0, after = 0;
    for (const auto& device : devices)
      before += device->allocations();
    std::atomic<std::size_t> next{0};
    std::atomic<std::uint64_t> downloaded{0};
    std::vector<std::thread> threads;
    const double start = now();
    for (unsigned w = 0; w < workers; ++w)
      threads.emplace_back([&, w] {
        for (std::size_t i = next++; i < models.size(); i = next++)
          downloaded += devices[w]->run(viewOf(models[i]), job).counts.bufferBytes;
      });
    for (std::thread& thread : threads)
      thread.join();
    const double each = (now() - start) / count;
    for (const auto& device : devices)
      after += device->allocations();
    const double floorSeconds =
        std::max(bytes / count / speeds.up, static_cast<double>(downloaded) / count / speeds.down);
    std::printf("%u at a time: %.3f ms a model, floor %.3f ms, %.2f MB down each, allocations "
                "after the first %llu\n",
                workers, each * 1e3, floorSeconds * 1e3,
                static_cast<double>(downloaded) / count * 1e-6,
                static_cast<unsigned long long>(after - before));
    std::fflush(stdout);
  }
  return differ;
}

} // namespace tetvdb::bench
