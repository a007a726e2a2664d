// SPDX-License-Identifier: Apache-2.0
#include "LevelSetOnDevice.h"

#include "Measure.h"
#include "tetvdb/fields/DistanceOnDevice.h"
#include "tetvdb/fields/ShapeGrids.h"
#include "tetvdb/volume/Grids.h"
#include "tetvdb/voxelize/SoupChain.h"
#include "tetvdb/voxelize/ViewOfMesh.h"
#include "tetvdb/voxelize/VoxelizeOnDevice.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <type_traits>

namespace tetvdb::bench {
namespace {

constexpr double kHalfWidth = 3;

struct CountedBatches : nano::DistanceReceiver {
  void take(const nano::DistanceBatch&) override {}
};

// The device alone.
void measureDistances(nano::DeviceVoxelizer& device, const nano::Speeds& speeds,
                      const SnappedMesh& mesh, const Boundary& faces, const std::string& what,
                      int times) {
  Progress progress;
  const double start = now();
  const DistanceBand band(mesh, faces, kHalfWidth, progress);
  const double placing = now() - start;
  PinnedCopies pinned;
  nano::DistanceJob job = distanceJobFor(band);
  job.faces.points = static_cast<const LatticePoint*>(
      pinned.add(job.faces.points, job.faces.pointCount * sizeof(LatticePoint)));
  job.faces.faces =
      static_cast<const std::uint32_t*>(pinned.add(job.faces.faces, job.faces.faceCount * 16));
  job.nodeFaces = static_cast<const NodeFace*>(
      pinned.add(job.nodeFaces, band.nodeFaces().size() * sizeof(NodeFace)));
  std::uint64_t leaves = 0;
  CountedBatches nobody;
  const Measured measured = measure(device, times, [&] { leaves = device.distances(job, nobody); });
  // Of a leaf come down 512 distances; within the device they are written, and read once.
  const double down = static_cast<double>(leaves) * 2048;
  const double bus = pinned.bytes() / speeds.up + down / speeds.down;
  const double within = 2 * (pinned.bytes() + down) / speeds.within;
  print(what + ", device alone", measured, bus,
        fmt::format(
            "{} faces, {} nodes, {} leaves, {:.0f} MB up, {:.0f} MB down; {:.2f} ms within; "
            "faces to nodes on the CPU {:.1f} ms; device memory {:.2f} GB",
            faces.faces.size(), band.nodes().size(), leaves, pinned.bytes() * 1e-6, down * 1e-6,
            within * 1e3, placing * 1e3, static_cast<double>(device.deviceBytes()) * 1e-9));
}

// From a mesh to a grid of NanoVDB in host memory; `view` in host memory.
void measureGrid(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, nano::MeshView view,
                 const GridTransform& transform, const std::string& what, int times) {
  PinnedCopies pinned;
  const auto copy = [&](auto*& array, std::size_t bytes) {
    using Array = std::remove_reference_t<decltype(array)>;
    if (array != nullptr)
      array = static_cast<Array>(pinned.add(array, bytes));
  };
  copy(view.points, view.pointCount * 3 * sizeof(double));
  copy(view.tets, view.tetCount * 4 * sizeof(std::uint32_t));
  copy(view.triangles, view.triangleCount * 3 * sizeof(std::uint32_t));
  const nano::LevelSetJob job = levelSetJobFor(transform, kHalfWidth);
  nano::Counts counts;
  const Measured measured =
      measure(device, times, [&] { counts = device.levelSet(view, job).counts; });
  // The grid is written, and read once.
  const auto bytes = static_cast<double>(counts.bufferBytes);
  print(what + ", mesh to NanoVDB's buffer", measured,
        pinned.bytes() / speeds.up + bytes / speeds.down,
        fmt::format("{} leaves, {:.0f} MB up, {:.0f} MB down; {:.2f} ms within; device memory "
                    "{:.2f} GB",
                    counts.leaves, pinned.bytes() * 1e-6, bytes * 1e-6,
                    2 * (pinned.bytes() + bytes) / speeds.within * 1e3,
                    static_cast<double>(device.deviceBytes()) * 1e-9));
}

VoxelizeOptions maskAt(const GridTransform& transform) {
  VoxelizeOptions options;
  options.grids = {GridKind::Mask};
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  return options;
}

// From a mesh and its mask to the tree.
void compareTrees(Voxelization made, const SnappedMesh& mesh, const Boundary& faces,
                  const std::string& what, int times,
                  const std::function<void(const ShapeOptions&, Voxelization&)>& add) {
  besideCpu(what + ", mesh and mask to OpenVDB's tree",
            estimateBandCost(estimateBandLeaves(mesh, faces, kHalfWidth),
                             static_cast<double>(faces.faces.size())),
            std::max(times / 4, 3), [&](const DeviceChoice& choice) {
              ShapeOptions shapes;
              shapes.grids = {GridKind::Surface};
              shapes.halfWidth = kHalfWidth;
              shapes.device = choice;
              add(shapes, made);
              made.volume.grids().all.pop_back();
            });
}

} // namespace

void levelSetTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds, const TetMesh& ball,
                   const std::string& name, int resolution, int times) {
  const std::string what = fmt::format("level set of {} at {}^3", name, resolution);
  const GridTransform transform = transformAt(resolution);
  Report report;
  Progress progress;
  const SnappedMesh mesh = snapMesh(ball, transform, progress);
  const Boundary faces = boundaryFaces(mesh, progress);
  measureDistances(device, speeds, mesh, faces, what, times);
  measureGrid(device, speeds, viewOf(ball), transform, what, times);
  compareTrees(voxelize(ball, maskAt(transform), report, progress), mesh, faces, what, times,
               [&](const ShapeOptions& shapes, Voxelization& made) {
                 addShapeGrids(ball, shapes, made, report, progress);
               });
}

void levelSetTable(nano::DeviceVoxelizer& device, const nano::Speeds& speeds,
                   const TriangleMesh& ball, const std::string& name, int resolution, int times) {
  const std::string what = fmt::format("level set of {} at {}^3", name, resolution);
  const GridTransform transform = transformAt(resolution);
  Report report;
  Progress progress;
  const SnappedMesh mesh = snapPoints(ball.points, transform, progress);
  const Boundary faces = soupFaces(ball, mesh);
  measureDistances(device, speeds, mesh, faces, what, times);
  measureGrid(device, speeds, viewOf(ball), transform, what, times);
  compareTrees(voxelize(ball, SolidOptions(), maskAt(transform), report, progress), mesh, faces,
               what, times, [&](const ShapeOptions& shapes, Voxelization& made) {
                 addShapeGrids(ball, SolidOptions(), shapes, made, report, progress);
               });
}

} // namespace tetvdb::bench
