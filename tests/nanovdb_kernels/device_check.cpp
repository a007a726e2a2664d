// SPDX-License-Identifier: Apache-2.0
//
// Runs on a machine with a GPU: grids from the device, of arrays and level sets too, against those
// of the CPU, by hash, and against the host's twin, byte for byte; and what the device refuses.
// Arguments: mesh files or folders of them; --small leaves out what is slow under
// compute-sanitizer. Exit status 1 if anything differs.
#include "CoverageCases.h"
#include "FieldCases.h"
#include "Grids.h"
#include "LevelSetCases.h"
#include "Meshes.h"
#include "OpenSoupCases.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace tetvdb;
using nano::GridType;
using nano::Method;

int checks = 0, failures = 0;

void expect(bool good, const std::string& what) {
  ++checks;
  if (good)
    return;
  ++failures;
  std::printf("DIFFERS: %s\n", what.c_str());
}

void compare(nano::DeviceVoxelizer& device, const std::string& name, const TetMesh& mesh,
             const GridTransform& transform, bool twinToo) {
  struct Case {
    const char* name;
    GridType type;
    Method method;
    GridKind kind;
  };
  for (const Case& c : {Case{"mask by boundary", GridType::Mask, Method::Boundary, GridKind::Mask},
                        Case{"mask by tets", GridType::Mask, Method::Tets, GridKind::Mask},
                        Case{"bool", GridType::Bool, Method::Auto, GridKind::Mask},
                        Case{"fog", GridType::Fog, Method::Boundary, GridKind::Density},
                        Case{"owner", GridType::Owner, Method::Auto, GridKind::TetId}}) {
    const nano::Job job = jobFor(c.type, c.method, transform);
    const std::string what = name + ", " + c.name;
    try {
      const nano::Result result = device.run(viewOf(mesh), job);
      expect(hashOf(result) == cpuHash(mesh, c.kind, transform), what + ": CPU");
      if (!twinToo)
        continue;
      nano::HostTwin twin;
      const nano::Result other = twin.run(viewOf(mesh), job);
      expect(sameBytes(other, result), what + ": twin");
    } catch (const std::exception& e) {
      expect(false, what + ": " + e.what());
    }
  }
}

// Values of arrays: the device's grids against those of the CPU.
template <typename Device>
void compareFields(Device& device, const std::string& name, const TetMesh& mesh,
                   const GridTransform& transform, const FieldOptions& wanted) {
  try {
    const SampledFields there =
        fieldsBy(mesh, transform, wanted,
                 [&](const nano::MeshView& view, const nano::FieldJob& job,
                     nano::LeafReceiver& receiver) { device.sample(view, job, receiver); });
    const SampledFields here = cpuFields(mesh, transform, wanted);
    expect(there.hash == here.hash, name + ", arrays");
    expect(there.complete, name + ", arrays: all leaves");
    expect(there.warnings.size() == here.warnings.size(), name + ", arrays: warnings");
  } catch (const std::exception& e) {
    expect(false, name + ", arrays: " + e.what());
  }
}

// Whole grids of numbers: the device's against those of the CPU, and byte for byte against its
// twin's.
template <typename Device>
void compareNanoFields(Device& device, const std::string& name, const TetMesh& mesh,
                       const GridTransform& transform, const FieldOptions& wanted) {
  try {
    CollectedGrids made, twin;
    const SampledFields there = nanoFieldsBy(
        mesh, transform, wanted, made,
        [&](const nano::MeshView& view, const nano::FieldJob& job, nano::GridReceiver& receiver) {
          device.sampleGrids(view, job, receiver);
        });
    nanoFieldsBy(
        mesh, transform, wanted, twin,
        [&](const nano::MeshView& view, const nano::FieldJob& job, nano::GridReceiver& receiver) {
          nano::HostTwin().sampleGrids(view, job, receiver);
        });
    const SampledFields here = cpuFields(mesh, transform, wanted);
    expect(there.hash == here.hash, name + ", grids of arrays");
    expect(there.warnings.size() == here.warnings.size(), name + ", grids of arrays: warnings");
    bool same = made.grids.size() == twin.grids.size();
    for (std::size_t i = 0; same && i < made.grids.size(); ++i)
      same =
          made.grids[i].size == twin.grids[i].size &&
          std::memcmp(made.grids[i].data.get(), twin.grids[i].data.get(), made.grids[i].size) == 0;
    expect(same, name + ", grids of arrays: the twin's bytes");
  } catch (const std::exception& e) {
    expect(false, name + ", grids of arrays: " + e.what());
  }
}

template <typename Device>
void madeArrays(Device& device, bool small) {
  using namespace meshes;
  const auto check = [&](const std::string& name, const TetMesh& mesh,
                         const GridTransform& transform = {}) {
    compareFields(device, name, withArrays(mesh, 5), transform, allFields());
    compareNanoFields(device, name, withArrays(mesh, 5), transform, allFields());
  };
  for (int cell : {1, 3, 8})
    check("lattice of ties", scaled(kuhnGrid(3, 3, 3), cell));
  check("negative, anisotropic", scaled(kuhnGrid(3, 4, 5), 7.3, {-20.1, -5000.7, 3.3}),
        {{0.9, 1.1, 1.7}, {0.25, -3, 8}});
  check("overlaps, flips, flat tets", soup(300, 40, 9, 1, 5));
  check("cells of six tets", withCellsOfSix(scaled(jittered(kuhnGrid(3, 3, 3), 0.2, 9), 6)));
  check("nothing inside", scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5}));
  for (const double thin : {1e-3, 1e-5, 4e-6})
    check("slivers",
          mapped(jittered(kuhnGrid(4, 4, small ? 40 : 400), 0.2, 3), [=](const Vec3d& p) {
            return Vec3d{p[0] * 11, p[1] * 9 + 3, p[2] * thin * 9 + 4 - thin};
          }));
  for (std::uint64_t seed = 0; seed < (small ? 3u : 40u); ++seed) {
    TetMesh mesh = soup(1 + seed * 7 % 40, seed % 3 == 0 ? 1 : 20 * double(seed % 3),
                        seed % 2 == 0 ? 2 : 25, seed, 2);
    if (seed % 4 > 1)
      mesh = rounded(std::move(mesh), seed % 8 > 3 ? 1 : 0.125);
    check("soup " + std::to_string(seed), mesh);
  }
  check("soup around the origin", mapped(soup(60, 120, 25, 3, 2), [](const Vec3d& p) {
          return Vec3d{p[0] - 60, p[1] - 60, p[2] - 60};
        }));
  if (small)
    return;
  check("tets that fill nodes", scaled(kuhnGrid(1, 1, 1), 420, {-40, -30, -20}));
  check("ball", ball(8, 130, {3, -70, 100}));
  check("shuffled ball", shuffled(ball(20, 60, {3, -70, 100}), 9));
}

// Level sets: with the device's distances against the CPU's.
template <typename Device>
void compareBands(Device& device, const std::string& name, const BandCase& band) {
  const auto distances = [&](const nano::DistanceJob& job, nano::DistanceReceiver& receiver) {
    if (job.nodeCount != 0)
      device.distances(job, receiver);
  };
  try {
    expect(levelSetHash(band, rasterizerBy(distances)) == levelSetHash(band, rasterizeBand),
           name + ", level set");
  } catch (const std::exception& e) {
    expect(false, name + ", level set: " + e.what());
  }
}

// Level sets made on the device: the CPU's grid, and its twin's bytes. `band`: of `mesh`.
template <typename Device, typename Mesh>
void compareLevelSets(Device& device, const std::string& name, const Mesh& mesh,
                      const BandCase& band, FillRule rule, bool twinToo) {
  const std::string what = name + ", level set on the device";
  try {
    nano::LevelSetJob job = levelSetJobFor(band.transform, band.halfWidth);
    job.rule = rule;
    const nano::Result made = device.levelSet(viewOf(mesh), job);
    expect(made.bytes != nullptr && hashOf(made) == levelSetHash(band, rasterizeBand), what);
    expect(made.counts.insideVoxels == band.inside->activeVoxelCount(), what + ": inside");
    nano::HostTwin twin;
    if (twinToo)
      expect(sameBytes(twin.levelSet(viewOf(mesh), job), made), what + ": twin");
    const nano::Result fog = device.levelSet(viewOf(mesh), fogJobOf(job));
    expect(fog.bytes != nullptr && hashOf(fog) == fogHash(band), what + ": fog");
    if (twinToo)
      expect(sameBytes(twin.levelSet(viewOf(mesh), fogJobOf(job)), fog), what + ": fog's twin");
  } catch (const std::exception& e) {
    expect(false, what + ": " + e.what());
  }
}

template <typename Device>
void madeBands(Device& device, bool small) {
  using namespace meshes;
  const auto check = [&](const std::string& name, const TetMesh& mesh, double halfWidth = 3,
                         double shell = 0) {
    const BandCase band = bandOf(mesh, {}, halfWidth, shell);
    compareBands(device, name, band);
    if (shell == 0)
      compareLevelSets(device, name, mesh, band, FillRule::Positive, small);
  };
  const auto turned = [](const Vec3d& p) {
    return Vec3d{0.8 * p[0] - 0.6 * p[1], 0.48 * p[0] + 0.64 * p[1] - 0.6 * p[2],
                 0.36 * p[0] + 0.48 * p[1] + 0.8 * p[2]};
  };
  for (int cell : {1, 3, 8})
    check("lattice of ties", scaled(kuhnGrid(3, 3, 3), cell));
  for (const double halfWidth : {1.0, 6.5, 30.0})
    check("half-widths", mapped(scaled(kuhnGrid(2, 2, 2), 17, {-20, -130, 3}), turned), halfWidth);
  check("shell", mapped(scaled(kuhnGrid(2, 2, 2), 17, {-20, -130, 3}), turned), 3, 4.75);
  check("overlaps, flips, flat tets", soup(300, 40, 9, 1, 5));
  check("many faces a leaf", scaled(jittered(kuhnGrid(9, 9, 9), 0.2, 9, true), 0.9));
  check("slivers", mapped(jittered(kuhnGrid(4, 4, 40), 0.2, 3), [](const Vec3d& p) {
          return Vec3d{p[0] * 11, p[1] * 9 + 3, p[2] * 1e-5 + 4};
        }));
  check("tiny and large", joined(soup(400, 100, 0.7, 7), soup(3, 100, 90, 8)));
  compareBands(device, "segments and points",
               bandOfFaces({{0.3, 0.2, 0.1}, {9.75, 4.25, -3.25}, {-6, 2, 3}, {12.5, 19, 12}},
                           {0, 1, 1, 2, 2, 2, 0, 3, 3}, 4));
  for (std::uint64_t seed = 0; seed < (small ? 3u : 40u); ++seed) {
    TetMesh mesh = soup(1 + seed * 7 % 40, seed % 3 == 0 ? 1 : 20 * double(seed % 3),
                        seed % 2 == 0 ? 2 : 25, seed, 2);
    if (seed % 4 > 1)
      mesh = rounded(std::move(mesh), seed % 8 > 3 ? 1 : 0.125);
    check("soup " + std::to_string(seed), mesh, seed % 5 == 0 ? 9 : 3);
  }
  if (small)
    return;
  check("giant faces", mapped(scaled(kuhnGrid(1, 1, 1), 900, {-40, -30, -20}), turned));
  check("ball in many batches", ball(30, 400, {1000, 5, -3000}));
  check("far more faces than voxels", ball(60, 30, {3, -70, 100}));
  check("a tile of the root", scaled(kuhnGrid(1, 1, 1), 4200, {-50, -60, -44}), 1);
  check("many nodes", mapped(kuhnGrid(1, 1, 1), [](const Vec3d& p) {
          return Vec3d{p[0] * 300000 - 60000, p[1] * 2 + p[0] * 40, p[2] * 2 - 1};
        }));
}

// Coverage against the CPU's, and the twin's bytes.
template <typename Device>
void madeCoverage(Device& device, bool small) {
  nano::HostTwin twin;
  for (const CoverageCase& c : coverageCases(small))
    try {
      const Covered there = coveredBy(c, [&](const nano::CoverageJob& job) {
        const nano::Result made = device.coverage(job);
        expect(sameBytes(twin.coverage(job), made), c.name + ", coverage: twin");
        return made;
      });
      expect(there == coveredByCpu(c), c.name + ", coverage");
    } catch (const std::exception& e) {
      expect(false, c.name + ", coverage: " + e.what());
    }
}

void madeMeshes(nano::DeviceVoxelizer& device, bool small) {
  using namespace meshes;
  const auto check = [&](const std::string& name, const TetMesh& mesh,
                         const GridTransform& transform = {}) {
    compare(device, name, mesh, transform, true);
  };
  for (int cell : {1, 3, 8})
    check("lattice of ties", scaled(kuhnGrid(3, 3, 3), cell));
  check("negative, anisotropic", scaled(kuhnGrid(3, 4, 5), 7.3, {-20.1, -5000.7, 3.3}),
        {{0.9, 1.1, 1.7}, {0.25, -3, 8}});
  check("overlaps, flips, flat tets", soup(300, 40, 9, 1, 5));
  check("rounded soup", rounded(soup(300, 20, 5, 2, 5), 0.5));
  const TetMesh twice = jittered(kuhnGrid(4, 4, 4), 0.3, 3);
  check("duplicated tets", scaled(joined(twice, twice), 4));
  check("far below a voxel", scaled(jittered(kuhnGrid(12, 12, 12), 0.3, 4), 0.3));
  check("tiny and large", joined(soup(400, 100, 0.7, 7), soup(3, 100, 90, 8)));
  check("nothing inside", scaled(kuhnGrid(1, 1, 1), 0.1, {0.5, 0.5, 0.5}));
  for (std::uint64_t seed = 0; seed < (small ? 4u : 60u); ++seed) {
    TetMesh mesh = soup(1 + seed * 7 % 40, seed % 3 == 0 ? 1 : 20 * double(seed % 3),
                        seed % 2 == 0 ? 2 : 25, seed, 2);
    if (seed % 4 > 1)
      mesh = rounded(std::move(mesh), seed % 8 > 3 ? 1 : 0.125);
    check("soup " + std::to_string(seed), mesh);
  }
  if (small)
    return;
  check("giant soup", soup(4, 300, 200, 6));
  check("one cube", scaled(kuhnGrid(1, 1, 1), 300, {-40, -30, -20}));
  check("ball", ball(8, 60, {3, -70, 100}));
  check("shuffled ball", shuffled(ball(8, 60, {3, -70, 100}), 9));
  const TetMesh large = ball(30, 400, {1000, 5, -3000});
  compare(device, "larger ball", large, {}, false);
  const auto box = [](const Vec3d& size, const Vec3d& low) {
    return mapped(kuhnGrid(1, 1, 1), [=](const Vec3d& p) {
      return Vec3d{p[0] * size[0] + low[0], p[1] * size[1] + low[1], p[2] * size[2] + low[2]};
    });
  };
  nano::Job job;
  for (const TetMesh& mesh : {box({20, 12, 9000}, {3, 1, -4100}), box({200, 72, 1000}, {0, 0, 0}),
                              box({4504, 4400, 9000}, {-200, -104, -4500})})
    expect(hashOf(device.run(viewOf(mesh), job)) == cpuHash(mesh, GridKind::Density, {}),
           "tiles of every level");
  // The same bits again, also after other models have used the memory.
  const nano::Job mask;
  const std::string first = hashOf(device.run(viewOf(large), mask));
  device.run(viewOf(twice), mask);
  const std::uint64_t before = device.allocations();
  expect(hashOf(device.run(viewOf(large), mask)) == first, "once more");
  expect(device.allocations() == before, "no allocation for a model of the same size");
}

// Triangles: the device's grids against those of the CPU, and the twin's bytes.
template <typename Device>
void compareSoups(Device& device, const SoupCase& c, bool twinToo) {
  for (const FillRule rule : {FillRule::Positive, FillRule::NonZero, FillRule::Odd})
    for (const Method method : {Method::Boundary, Method::Dense, Method::Auto}) {
      if (method == Method::Dense && !c.dense)
        continue;
      nano::Job job = jobFor(GridType::Fog, method, c.transform);
      job.rule = rule;
      const std::string what = c.name + ", triangles, rule " + std::to_string(int(rule)) +
                               ", method " + std::to_string(int(method));
      try {
        const nano::Result result = device.run(viewOf(c.mesh), job);
        expect(result.bytes != nullptr &&
                   hashOf(result) == cpuHash(c.mesh, rule, GridKind::Density, c.transform),
               what + ": CPU");
        if (!twinToo || method == Method::Auto)
          continue;
        nano::HostTwin twin;
        expect(sameBytes(twin.run(viewOf(c.mesh), job), result), what + ": twin");
      } catch (const std::exception& e) {
        expect(false, what + ": " + e.what());
      }
    }
}

// Open triangles: likewise. What the host's twin is asked for too takes its time.
template <typename Device>
void compareOpenSoups(Device& device, const SoupCase& c, bool twinToo) {
  FilledSoup soup(c.mesh, c.transform);
  for (const FillRule rule : {FillRule::Positive, FillRule::NonZero}) {
    nano::Job job = jobFor(GridType::Fog, Method::Auto, c.transform);
    job.rule = rule;
    const std::string what = c.name + ", open triangles, rule " + std::to_string(int(rule));
    try {
      const nano::Result result = device.run(soup.view, job);
      expect(result.bytes != nullptr &&
                 hashOf(result) == cpuHash(c.mesh, rule, GridKind::Density, c.transform),
             what + ": CPU");
      if (!twinToo)
        continue;
      nano::HostTwin twin;
      expect(sameBytes(twin.run(soup.view, job), result), what + ": twin");
    } catch (const std::exception& e) {
      expect(false, what + ": " + e.what());
    }
  }
}

bool hasCubes(const SoupCase& c) {
  const Vec3d& size = c.transform.voxelSize;
  return size[0] == size[1] && size[1] == size[2];
}

void madeSoups(nano::DeviceVoxelizer& device, bool small) {
  for (const SoupCase& c : soupCases(small)) {
    compareSoups(device, c, small);
    for (const FillRule rule : {FillRule::Positive, FillRule::Odd})
      if (hasCubes(c))
        compareLevelSets(device, c.name, c.mesh, bandOf(c.mesh, rule, c.transform, 3), rule, small);
  }
  for (const SoupCase& c : openSoupCases(small))
    compareOpenSoups(device, c, true);
  const TriangleMesh sphere = meshes::sphere({0, 0, 0}, 20, 8);
  const TriangleMesh holed = meshes::without(sphere, [](std::size_t f) { return f == 3; });
  for (const Method method : {Method::Boundary, Method::Dense}) {
    const nano::Result open = device.run(viewOf(holed), jobFor(GridType::Mask, method, {}));
    expect(open.bytes == nullptr && open.counts.openEdges == 3, "an open soup");
  }
  TriangleMesh bad = sphere;
  bad.triangles[5] = 1u << 30;
  nano::Job job;
  try {
    device.run(viewOf(bad), job);
    expect(false, "a triangle with a bad index");
  } catch (const Error& e) {
    expect(e.status() == Status::Invalid, e.what());
  }
  compareSoups(device, {"after refusals", sphere}, true);
}

template <typename F>
bool refuses(Status status, const F& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.status() == status;
  }
  return false;
}

void refusals(nano::DeviceVoxelizer& device) {
  expect(refuses(Status::Device, [] { nano::DeviceVoxelizer none(99); }), "device 99");
  TetMesh mesh = meshes::kuhnGrid(1, 1, 1);
  nano::Job job;
  job.voxelSize[0] = 1e-7;
  expect(refuses(Status::Limit, [&] { device.run(viewOf(mesh), job); }), "a tet that is too long");
  mesh.tets[5] = 8;
  expect(refuses(Status::Invalid, [&] { device.run(viewOf(mesh), {}); }), "a bad index");
  mesh = meshes::kuhnGrid(1, 1, 1);
  mesh.points[3][1] = std::numeric_limits<double>::quiet_NaN();
  expect(refuses(Status::Limit, [&] { device.run(viewOf(mesh), {}); }), "not a number");
  // The device goes on after all that.
  compare(device, "after refusals", meshes::scaled(meshes::kuhnGrid(2, 2, 2), 5), {}, true);
}

// A job that takes some tenths of a second and its end by the clock; and one beyond all memory.
void stopping(nano::DeviceVoxelizer& device) {
  const TetMesh ball = meshes::ball(20, 1, {0, 0, 0});
  nano::Job job = jobFor(GridType::Mask, Method::Auto, {});
  job.download = false;
  const auto at = [&](double resolution) {
    for (double& size : job.voxelSize)
      size = 2 / resolution;
  };
  at(32768);
  device.run(viewOf(ball), job);
  for (const int milliseconds : {0, 1, 20, 50}) {
    Progress progress;
    const auto begin = Progress::Clock::now();
    progress.setDeadline(begin + std::chrono::milliseconds(milliseconds));
    expect(refuses(Status::Cancelled, [&] { device.run(viewOf(ball), job, &progress); }),
           "a deadline");
    const std::chrono::duration<double> late = Progress::Clock::now() - progress.deadline();
    std::printf("deadline of %d ms: %.1f ms late\n", milliseconds, late.count() * 1e3);
    expect(late.count() < 0.2, "a deadline is kept within 0.2 s");
  }
  Progress cancelled;
  cancelled.cancel();
  expect(refuses(Status::Cancelled, [&] { device.run(viewOf(ball), job, &cancelled); }), "cancel");
  at(524288);
  try {
    device.run(viewOf(ball), job);
    expect(false, "a grid beyond the device's memory");
  } catch (const Error& e) {
    expect(e.status() == Status::Limit, e.what());
    std::printf("%s\n", e.what());
  }
  // A level set ends between batches, and when what takes its leaves fails.
  const BandCase band = bandOf(meshes::ball(30, 400, {1000, 5, -3000}));
  Progress none;
  const DistanceBand placed(band.mesh, band.faces, band.halfWidth, none);
  CollectedBand found(placed);
  expect(refuses(Status::Cancelled,
                 [&] { device.distances(distanceJobFor(placed), found, &cancelled); }),
         "a level set cancelled");
  struct Refusing : nano::DistanceReceiver {
    int batches = 0;
    void take(const nano::DistanceBatch&) override {
      if (++batches == 2)
        throw Error(Status::Limit, "", "no room");
    }
  } refusing;
  expect(refuses(Status::Limit, [&] { device.distances(distanceJobFor(placed), refusing); }),
         "leaves refused");
  expect(refuses(Status::Cancelled,
                 [&] {
                   device.levelSet(viewOf(meshes::ball(30, 400, {})), levelSetJobFor({}, 3),
                                   &cancelled);
                 }),
         "a level set on the device cancelled");
  compareBands(device, "after stopping", band);
  compare(device, "after stopping", meshes::scaled(meshes::kuhnGrid(2, 2, 2), 5), {}, true);
}

// All devices together against the first: the same bytes.
void sharedGrids(nano::DeviceVoxelizer& device, int count, bool small) {
  std::vector<int> numbers;
  for (int k = 0; k < count; ++k)
    numbers.push_back(k);
  nano::SharedVoxelizer shared(numbers);
  madeArrays(shared, true);
  madeBands(shared, small);
  madeCoverage(shared, true);
  const auto check = [&](const std::string& name, const TetMesh& mesh,
                         std::initializer_list<GridType> types) {
    for (GridType type : types)
      for (Method method : {Method::Auto, Method::Boundary}) {
        const nano::Job job = jobFor(type, method, {});
        try {
          expect(sameBytes(shared.run(viewOf(mesh), job), device.run(viewOf(mesh), job)),
                 name + " by all devices");
        } catch (const std::exception& e) {
          expect(false, name + ": " + e.what());
        }
      }
  };
  for (const SoupCase& c : openSoupCases(true))
    compareOpenSoups(shared, c, false);
  const auto all = {GridType::Mask, GridType::Bool, GridType::Fog, GridType::Owner};
  check("soup around the origin",
        meshes::mapped(meshes::soup(60, 120, 25, 3, 2),
                       [](const Vec3d& p) {
                         return Vec3d{p[0] - 60, p[1] - 60, p[2] - 60};
                       }),
        all);
  check("within a root tile", meshes::ball(8, 60, {200, 200, 200}), all);
  if (small)
    return;
  check("box of tiles",
        meshes::mapped(meshes::kuhnGrid(1, 1, 1),
                       [](const Vec3d& p) {
                         return Vec3d{p[0] * 12300 - 4100, p[1] * 400 - 200, p[2] * 8200 - 4098};
                       }),
        {GridType::Mask, GridType::Fog});
  const TetMesh large = meshes::ball(12, 6500, {0.3, 100.7, -30});
  check("large ball", large, {GridType::Mask, GridType::Fog});
  check("ball of values", meshes::ball(12, 150, {0.3, 10.7, -30}), {GridType::Owner});
  std::printf("%d devices, leaves:", count);
  shared.run(viewOf(large), jobFor(GridType::Mask, Method::Auto, {}));
  for (std::uint64_t leaves : shared.leaves())
    std::printf(" %llu", static_cast<unsigned long long>(leaves));
  std::printf("\n");
}

void corpusSoup(nano::DeviceVoxelizer& device, const std::string& path) {
  Report report;
  Progress progress;
  SoupCase c{path, readTriangles(path, report, progress)};
  cleanTriangles(c.mesh, {}, progress);
  if (c.mesh.triangles.empty())
    return;
  const bool open = !soupBoundary(c.mesh, progress).edges.empty();
  for (const int resolution : {64, 300, 700}) {
    VoxelizeOptions options;
    options.resolution = resolution;
    c.transform = chooseTransform(c.mesh, options);
    if (open)
      compareOpenSoups(device, c, false);
    else
      compareSoups(device, c, false);
    if (!open)
      compareLevelSets(device, path, c.mesh, bandOf(c.mesh, FillRule::Positive, c.transform, 3),
                       FillRule::Positive, false);
  }
}

void corpusFile(nano::DeviceVoxelizer& device, const std::string& path) {
  TetMesh mesh;
  try {
    Report report;
    Progress progress;
    if (holdsTriangles(path)) {
      corpusSoup(device, path);
      return;
    }
    mesh = readTets(path, {}, {}, nullptr, report, progress);
  } catch (const Error&) {
    return; // not a mesh of tets, or a broken one
  }
  if (mesh.tets.empty())
    return;
  for (int resolution : {64, 300}) {
    VoxelizeOptions options;
    options.resolution = resolution;
    compare(device, path + " at " + std::to_string(resolution), mesh,
            chooseTransform(mesh, options), false);
    const BandCase band = bandOf(mesh, chooseTransform(mesh, options));
    const std::string name = path + " at " + std::to_string(resolution);
    compareBands(device, name, band);
    compareLevelSets(device, name, mesh, band, FillRule::Positive, false);
    // Its own arrays where it has any.
    FieldOptions own;
    own.all = true;
    if (!mesh.curved.empty())
      continue;
    if (mesh.attributes.empty())
      compareFields(device, path, withArrays(mesh, 7), chooseTransform(mesh, options), allFields());
    else
      compareFields(device, path, mesh, chooseTransform(mesh, options), own);
  }
}

} // namespace

int main(int argc, char** argv) {
  bool small = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--small")
      small = true;
    else if (std::filesystem::is_directory(argv[i]))
      for (const auto& entry : std::filesystem::directory_iterator(argv[i]))
        files.push_back(entry.path().string());
    else
      files.push_back(argv[i]);
  }
  std::string why;
  const std::size_t devices = nano::listDevices(why).size();
  if (devices == 0) {
    std::printf("no device: %s\n", why.c_str());
    return 77;
  }
  nano::DeviceVoxelizer device(0);
  madeMeshes(device, small);
  madeArrays(device, small);
  madeBands(device, small);
  madeSoups(device, small);
  madeCoverage(device, small);
  if (!small) {
    refusals(device);
    stopping(device);
  }
  if (devices > 1)
    sharedGrids(device, static_cast<int>(devices), small);
  for (const std::string& file : files)
    corpusFile(device, file);
  std::printf("%d checks, %d failures\n", checks, failures);
  return failures == 0 ? 0 : 1;
}
