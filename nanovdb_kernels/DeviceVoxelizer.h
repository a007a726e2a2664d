// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedra and triangle meshes into NanoVDB grids on a GPU: plain arrays in, a NanoVDB
// buffer out. The grid is bit for bit the one that voxelize/Voxelize.h and VoxelizeTriangles.h make
// on the CPU. No type of CUDA or NanoVDB is in here.
//
//   tetvdb::nano::DeviceVoxelizer voxelizer(0);
//   tetvdb::nano::Job job;
//   job.type = tetvdb::nano::GridType::Mask;
//   job.voxelSize[0] = job.voxelSize[1] = job.voxelSize[2] = 0.01;
//   tetvdb::nano::Result result = voxelizer.run({points, pointCount, tets, tetCount}, job);
//   // result.bytes: a NanoVDB grid
#pragma once

#include "CoverageJob.h"
#include "DeviceArray.h"
#include "DistanceJob.h"
#include "FieldJob.h"
#include "HolesView.h"
#include "LevelSetJob.h"
#include "tetvdb/fields/CoverageSum.h"
#include "tetvdb/geometry/FillRule.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {
class Progress; // core/Progress.h
}

namespace tetvdb::nano {

/// A mesh of tets or of triangles in host memory, or in the device's (Job::resident).
struct MeshView {
  const double* points = nullptr; ///< x, y, z each, world units
  std::uint64_t pointCount = 0;
  const std::uint32_t* tets = nullptr; ///< four indices each; on the device aligned to 16 bytes
  std::uint64_t tetCount = 0;
  const std::int32_t* values = nullptr;     ///< of every tet, for GridType::Owner; null: its number
  const std::uint32_t* triangles = nullptr; ///< three indices each; null: the mesh is one of tets
  std::uint64_t triangleCount = 0;
  /// Of triangles that do not close what their winding number takes besides, in host memory; null
  /// where they close. Ignored for FillRule::Odd.
  const HolesView* holes = nullptr;
};

enum class GridType : std::uint8_t {
  Mask,  ///< NanoVDB's ValueMask: active voxels, no values; 96 bytes a leaf
  Bool,  ///< bool, true inside
  Fog,   ///< float, 1 inside, 0 outside, class fog volume
  Owner, ///< int32: the value of the tet that owns the voxel (where tets overlap, the one of lowest
         ///< number), background -1
};

/// How occupancy is found; the grid is the same.
enum class Method : std::uint8_t {
  Auto,     ///< whichever a cost estimate finds faster
  Boundary, ///< signed crossings of the boundary faces, or of all triangles
  Tets,     ///< every tet rasterised into a dense array of leaf masks; for small grids
  Dense     ///< signed crossings of all triangles, closed ones, in a dense array; for small grids
};

struct Job {
  GridType type = GridType::Fog;
  Method method = Method::Auto;
  FillRule rule = FillRule::Positive; ///< winding numbers that are inside; of triangles
  double voxelSize[3] = {1, 1, 1};    ///< world units
  double origin[3] = {0, 0, 0};       ///< world units: the centre of voxel (0, 0, 0)
  std::string name = "density";       ///< at most 255 bytes
  bool resident = false;              ///< the mesh's arrays are in the device's memory
  bool download = true;               ///< false: the buffer stays on the device
  bool oneColumn = false;             ///< nothing is made but `column`; of one device alone
  std::int32_t column[2] = {0, 0};    ///< x and y of a column of root tiles, in 4096 voxels
};

struct Counts {
  std::uint64_t flipped = 0;       ///< tets of negative volume, taken as reversed
  std::uint64_t dropped = 0;       ///< tets without volume on the lattice
  std::uint64_t boundaryFaces = 0; ///< 0 where the boundary was not needed
  std::uint64_t openEdges = 0;     ///< of triangles: edges along which they do not cancel
  std::uint64_t oddEdges = 0;      ///< of triangles: edges of an odd number of them
  std::uint64_t leaves = 0, lowerNodes = 0, upperNodes = 0, rootTiles = 0;
  std::uint64_t bufferBytes = 0;
  std::uint64_t insideVoxels = 0; ///< of level sets
  CoverageSum coverage;           ///< of coverage
  Method method = Method::Tets;   ///< the one taken
};

/// Valid until the voxelizer that made it runs again or is destroyed. Of triangles that do not
/// close (openEdges, for FillRule::Odd oddEdges) nothing is made without MeshView::holes: both
/// pointers are null.
struct Result {
  const unsigned char* bytes =
      nullptr; ///< the grid in host memory, aligned to 64 bytes; null where not downloaded
  const unsigned char* device = nullptr; ///< the grid in the device's memory; null for the twin
  Counts counts;
};

/// Seconds of the last run, by device events; uploading overlaps building.
struct Times {
  double upload = 0, build = 0, download = 0;
  std::vector<std::pair<std::string, double>> parts; ///< of `build`, by name
};

/// Voxels min .. min + size - 1.
struct VoxelRange {
  std::int32_t min[3];
  std::uint32_t size[3];

  std::uint64_t voxels() const { return std::uint64_t(size[0]) * size[1] * size[2]; }
};

/// Bytes a second.
struct Speeds {
  double up = 0, down = 0; ///< between pinned host memory and the device
  double within = 0;       ///< of the device's memory, reads and writes counted
};

/// The same steps from the same source, on one thread of the host: an oracle for tests, many times
/// slower than voxelize(). Throws as DeviceVoxelizer does, but for the device.
class HostTwin {
public:
  HostTwin();
  ~HostTwin();
  /// `shares`: as a SharedVoxelizer of so many devices does it.
  Result run(const MeshView& mesh, const Job& job, int shares = 1);
  void expand(const Result& result, GridType type, const VoxelRange& range, unsigned char* to);
  void expandValues(const Result& result, const VoxelRange& range, float* to);
  /// `shares`: likewise, one after another.
  Counts sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver, int shares = 1);
  Counts sampleGrids(const MeshView& mesh, const FieldJob& job, GridReceiver& receiver);
  std::uint64_t distances(const DistanceJob& job, DistanceReceiver& receiver, int shares = 1);
  Result coverage(const CoverageJob& job);
  Result levelSet(const MeshView& mesh, const LevelSetJob& job);

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Whether this build has device code at all.
bool deviceSupport();

/// Names of the devices that can be used, in CUDA's order; empty where there is none, the reason in
/// `why` (no driver, one that is too old, no device).
std::vector<std::string> listDevices(std::string& why);

/// Host memory that uploads are fastest from. Throws Error(Device, Limit).
void* allocatePinned(std::size_t bytes);
void freePinned(void* p) noexcept;

/// The column of root tiles (4096^2 voxels) is what several devices of a host share a grid by: each
/// takes the whole mesh and builds the columns of its share, of about the same work; the buffer is
/// the one that a single device makes, byte for byte. A grid within one column is one device's work
/// alone. As DeviceVoxelizer, but for:
class SharedVoxelizer {
public:
  /// Throws Error(Device) where a device is not there, Error(Usage) for none or one named twice.
  explicit SharedVoxelizer(const std::vector<int>& devices);
  ~SharedVoxelizer();
  SharedVoxelizer(const SharedVoxelizer&) = delete;
  SharedVoxelizer& operator=(const SharedVoxelizer&) = delete;

  /// Copies a mesh to all devices; jobs with `resident` take this one.
  void keep(const MeshView& mesh);

  /// With Job::download unset the shares stay on their devices and no buffer is made: for
  /// measuring.
  Result run(const MeshView& mesh, const Job& job, const Progress* progress = nullptr);

  /// `receiver` is called by several threads at once, each with nodes that are its device's alone.
  Counts sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                const Progress* progress = nullptr);

  /// Devices share the nodes; `receiver` is called by several threads at once.
  std::uint64_t distances(const DistanceJob& job, DistanceReceiver& receiver,
                          const Progress* progress = nullptr);

  /// The first device does all.
  Result coverage(const CoverageJob& job, const Progress* progress = nullptr);

  /// Likewise.
  Counts sampleGrids(const MeshView& mesh, const FieldJob& job, GridReceiver& receiver,
                     const Progress* progress = nullptr);

  /// Likewise.
  Result levelSet(const MeshView& mesh, const LevelSetJob& job, const Progress* progress = nullptr);

  /// Of the last run, by device; downloads are a part of `build` here.
  std::vector<Times> times() const;
  /// Leaves that each device made in the last run.
  std::vector<std::uint64_t> leaves() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Runs one model after another on one device. Memory on the device and pinned memory on the host
/// are kept from run to run and only grow, so that a second model of the same size allocates
/// nothing. Not for use by several threads at once; two objects are independent.
class DeviceVoxelizer {
public:
  /// Throws Error(Device) where the device is not there or its driver is too old.
  explicit DeviceVoxelizer(int device = 0);
  ~DeviceVoxelizer();
  DeviceVoxelizer(const DeviceVoxelizer&) = delete;
  DeviceVoxelizer& operator=(const DeviceVoxelizer&) = delete;

  /// Copies a mesh to the device, for jobs with `resident`; kept as long as this object.
  MeshView keep(const MeshView& mesh);

  /// Throws Error(Invalid) for coordinates that are not finite and indices without a point,
  /// Error(Limit) for memory, 32-bit index space, a tet longer than 2^20 voxels, 2^32 nodes of a
  /// level or more and grids beyond 2^63 leaves across, Error(Device) where the device fails,
  /// Error(Cancelled) soon after `progress` says so.
  Result run(const MeshView& mesh, const Job& job, const Progress* progress = nullptr);

  /// The active voxels of the last result's grid, which may not have been downloaded, as bytes 0
  /// and 1, [x][y][z], into `to` from byte `at` on: a byte a voxel of `range`. Returns when they
  /// are there. `type`: that of the job. Throws Error(Usage) where they go beyond the end of `to`
  /// or that is another device's.
  void expand(const Result& result, GridType type, const VoxelRange& range, DeviceArray& to,
              std::uint64_t at = 0);

  /// The values of the last result of levelSet() or coverage() as floats, [x][y][z], likewise; `at`
  /// is a multiple of 4.
  void expandValues(const Result& result, const VoxelRange& range, DeviceArray& to,
                    std::uint64_t at = 0);

  /// Values of arrays at the voxels that tets own, where tets overlap of the one of lowest number;
  /// bit for bit those of fields/SampleFields.h. `receiver` gets them leaf by leaf, on the calling
  /// thread; what it throws ends the run. `mesh` is in host memory, without values. Of the counts
  /// only flipped, dropped and leaves are set. Indices of cells and points are trusted beyond those
  /// of the tets. Throws as run() does.
  Counts sample(const MeshView& mesh, const FieldJob& job, LeafReceiver& receiver,
                const Progress* progress = nullptr);

  /// The same values as grids of NanoVDB, without those that are not finite; each is brought to the
  /// memory that `receiver` gives before the next is made. Memory on the device, besides the
  /// arrays: three times the largest grid. Of the counts only flipped and dropped are set. Throws
  /// as sample() does.
  Counts sampleGrids(const MeshView& mesh, const FieldJob& job, GridReceiver& receiver,
                     const Progress* progress = nullptr);

  /// Squared distances in a band around faces; those within the radius are bit for bit those of
  /// fields/DistanceBand.h. `receiver` gets them in batches of 16 MB at most, on the calling
  /// thread;
  /// what it throws ends the run. Returns how many leaves there were. Memory on the device: the
  /// job's arrays, 300 MB, and 4 bytes for every leaf of a batch and face that comes near to it, at
  /// most 1 GB but for a node that alone has more. Indices of faces and points are trusted. Throws
  /// Error(Limit) for memory, Error(Device) and Error(Cancelled) as run() does.
  std::uint64_t distances(const DistanceJob& job, DistanceReceiver& receiver,
                          const Progress* progress = nullptr);

  /// The share of every voxel's cube that is inside closed faces, a fog of floats: values, active
  /// voxels and sums are bit for bit those of fields/Coverage.h, whose tree's nodes it has. Memory
  /// on the device: the job's arrays, 143 MB, 8 kB for every slab, and three times the leaves of
  /// the result (2 kB each). Indices of faces and points are trusted. Throws as distances() does,
  /// and std::logic_error for faces that do not close.
  Result coverage(const CoverageJob& job, const Progress* progress = nullptr);

  /// A float level set, negative inside: values and active voxels are bit for bit those of
  /// fields/LevelSet.h, whose tree's nodes it has. Of triangles that do not close nothing is made,
  /// as by run(). Memory on the device, besides that of run() for a mask: 16 to 40 bytes for every
  /// 128^3 node that a face comes near to, twice the leaves of the result (2 kB each), and that of
  /// distances(). Indices of job.faces are trusted. Throws as run() does, and Error(Usage) for a
  /// half-width that is not between 1 and 100 voxels and for MeshView::holes.
  Result levelSet(const MeshView& mesh, const LevelSetJob& job, const Progress* progress = nullptr);

  /// Measured by copying 256 MB a few times; takes some 0.1 s.
  Speeds measureSpeeds();

  /// Of the last run.
  Times times() const;
  /// Calls to the device's allocator since the object was made.
  std::uint64_t allocations() const;
  /// Bytes held on the device.
  std::uint64_t deviceBytes() const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tetvdb::nano
