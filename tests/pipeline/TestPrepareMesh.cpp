// SPDX-License-Identifier: Apache-2.0
//
// A mesh that is prepared gives the bytes of the mesh in memory.
#include "StreamFixture.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"
#include "tetvdb/pipeline/prepared/PreparedIndex.h"
#include "tetvdb/pipeline/prepared/TetBuckets.h"
#include "tetvdb/voxelize/SnappedMesh.h"
#include "tetvdb/voxelize/TetNodes.h"

#include <set>

namespace {

using namespace tetvdb;

// With arrays on points and cells, of several types and with a value that is not finite.
TetMesh withArrays(TetMesh mesh) {
  meshes::Random random(7);
  std::vector<float> heat(mesh.points.size()), speed(3 * mesh.points.size());
  std::vector<double> stress(mesh.tetCount());
  std::vector<std::int32_t> count(mesh.tetCount()), material(mesh.tetCount());
  for (float& v : heat)
    v = static_cast<float>(random.between(-3, 9));
  for (float& v : speed)
    v = static_cast<float>(random.between(-1, 1));
  for (double& v : stress)
    v = random.between(0, 1e6);
  for (std::size_t t = 0; t < count.size(); ++t) {
    count[t] = static_cast<std::int32_t>(random.below(1000));
    material[t] = static_cast<std::int32_t>(t / 50 % 4);
  }
  heat[heat.size() / 2] = std::nanf("");
  using On = Attribute::On;
  mesh.attributes = {{"heat", On::Points, 1, heat},
                     {"speed", On::Points, 3, speed},
                     {"stress", On::Cells, 1, stress},
                     {"count", On::Cells, 1, count},
                     {"material", On::Cells, 1, material}};
  return mesh;
}

// About `length` voxels long, turned, with its numbers in no order.
TetMesh bar(int cells, double length, double width, const Vec3d& shift) {
  TetMesh mesh = meshes::mapped(meshes::kuhnGrid(cells, 2, 2), [&](const Vec3d& p) {
    const double x = p[0] / cells * length, y = p[1] * width / 2, z = p[2] * width / 2;
    return Vec3d{x * 0.8 - y * 0.6 + shift[0], x * 0.48 + y * 0.64 - z * 0.6 + shift[1],
                 x * 0.36 + y * 0.48 + z * 0.8 + shift[2]};
  });
  return withArrays(meshes::shuffled(mesh, 3));
}

VoxelizeJob fieldsOf(VoxelizeJob job, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    job.fields.requests.push_back({"", name, FieldPart::Whole, ""});
  return job;
}

class PrepareMesh : public StreamFixture {
protected:
  std::string prepare(const VoxelizeJob& job) {
    Report report;
    made_ = prepareMesh(job, folder_ / "parts", report, progress_);
    return folder_ / "parts";
  }
  static VoxelizeJob ofParts(VoxelizeJob job, const std::string& folder) {
    job.inputs = {folder};
    job.voxelize.voxelSize = job.voxelize.origin = {0, 0, 0};
    job.up = UpAxis::Z;
    return job;
  }

  void expectSamePrepared(VoxelizeJob job, const std::string& what) {
    job.streaming = Streaming::Never;
    Report report;
    const VoxelizeResult whole = run(job, report, progress_);
    const std::string expected = fileBytes(job.output);
    job.streaming = Streaming::Auto;
    VoxelizeJob limited = job;
    limited.maxMemory = residentBytes() + limit_;
    const VoxelizeJob parts = ofParts(job, prepare(limited));
    for (const int threads : test::threadCounts({1, 3})) {
      VoxelizeJob one = parts;
      one.threads = threads;
      Report told;
      const VoxelizeResult result = run(one, told, progress_);
      EXPECT_TRUE(fileBytes(one.output) == expected) << what << ", " << threads << " threads";
      EXPECT_EQ(result.tets, whole.tets);
      EXPECT_EQ(result.counts.flipped, whole.counts.flipped);
      EXPECT_EQ(result.counts.dropped, whole.counts.dropped);
      EXPECT_NEAR(result.volume, whole.volume, 1e-12 * whole.volume);
    }
    EXPECT_TRUE(merged(makeParts(parts, 3), 5) == expected) << what;
  }

  PreparedMesh made_;
};

TEST_F(PrepareMesh, GridsOfEveryKind) {
  limit_ = std::size_t(256) << 20;
  VoxelizeJob wanted = job(bar(40, 300, 30, {-150, -20, -70}));
  for (const std::vector<GridKind>& kinds :
       std::vector<std::vector<GridKind>>{{GridKind::Mask},
                                          {GridKind::Density, GridKind::Mask},
                                          {GridKind::TetId},
                                          {GridKind::Mask, GridKind::Material, GridKind::TetId},
                                          {GridKind::Surface},
                                          {GridKind::Coverage, GridKind::Fog, GridKind::TetId}}) {
    wanted.grids = kinds;
    expectSamePrepared(wanted, std::string(infoOf(kinds.front()).name));
  }
}

TEST_F(PrepareMesh, ArraysAsGrids) {
  limit_ = std::size_t(256) << 20;
  VoxelizeJob wanted = job(bar(30, 250, 40, {-100, -20, -70}));
  wanted.grids = {GridKind::Density};
  expectSamePrepared(fieldsOf(wanted, {"heat", "stress"}), "scalars");
  wanted.grids.clear();
  VoxelizeJob mapped = fieldsOf(wanted, {"speed", "count", "heat"});
  mapped.fields.remap = {{"heat", 0, 1}};
  mapped.fields.clamp = {{"speed", 0, 0.5}};
  mapped.up = UpAxis::Y;
  expectSamePrepared(mapped, "mapped");
  wanted.fields.all = true;
  wanted.half = true;
  wanted.fields.remap = {{"stress", 0, 1}};
  expectSamePrepared(wanted, "all");
}

TEST_F(PrepareMesh, SeveralCubes) {
  limit_ = std::size_t(256) << 20;
  VoxelizeJob wanted = job(bar(60, 9000, 30, {-4500, -2900, -1700}));
  wanted.grids = {GridKind::TetId, GridKind::Mask};
  expectSamePrepared(fieldsOf(wanted, {"heat"}), "owners");
  EXPECT_GE(made_.buckets, 4u);
  wanted.grids = {GridKind::Mask};
  expectSamePrepared(wanted, "mask");
}

TEST_F(PrepareMesh, SoupsOfFlippedFlatAndOverlappingTets) {
  limit_ = std::size_t(256) << 20;
  TetMesh mesh = meshes::soup(400, 150, 60, 9);
  mesh.cellCount = mesh.tetCount();
  VoxelizeJob wanted = job(withArrays(mesh));
  wanted.grids = {GridKind::TetId, GridKind::Mask};
  expectSamePrepared(fieldsOf(wanted, {"speed"}), "owners");
  wanted.grids = {GridKind::Density};
  wanted.fields = {};
  expectSamePrepared(wanted, "density");
}

// The tets of each box are those that a box by itself would find.
TEST_F(PrepareMesh, BucketsHoldTheTetsThatMeetThem) {
  const TetMesh mesh = withArrays(meshes::shuffled(meshes::ball(10, 400, {-30, 50, 10}), 4));
  const GridTransform transform{{1, 1, 1}, {0, 0, 0}};
  SpooledMesh spooled(folder_.path().string());
  spooled.points.append(mesh.points);
  spooled.tets.append(mesh.tets);
  for (const Attribute& array : mesh.attributes) {
    const auto [bytes, size] = bytesOf(array.values);
    spooled.add(array.name, array.on, array.components, array.values.index())
        ->values->append(bytes, size);
  }
  spooled.finish();
  const TetBuckets buckets(spooled, transform, 300, folder_.path().string(), 1 << 12, 0, progress_);
  EXPECT_GT(buckets.boxes().size(), 20u);
  std::vector<std::set<std::uint32_t>> expected(buckets.boxes().size());
  for (std::uint32_t t = 0; t < mesh.tetCount(); ++t) {
    Vec3d low = mesh.points[mesh.tets[4 * t]], high = low;
    for (std::size_t c = 1; c < 4; ++c)
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], mesh.points[mesh.tets[4 * t + c]][k]);
        high[k] = std::max(high[k], mesh.points[mesh.tets[4 * t + c]][k]);
      }
    for (std::size_t b = 0; b < expected.size(); ++b) {
      const NodeBox& box = buckets.boxes()[b].box;
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k)
        meets = meets && std::max(std::ceil(low[k]), 128.0 * box.low[k]) <=
                             std::min(std::floor(high[k]), 128.0 * box.high[k] - 1);
      if (meets)
        expected[b].insert(t);
    }
  }
  for (std::size_t b = 0; b < expected.size(); ++b) {
    const BucketTets own = buckets.tets(b);
    ASSERT_EQ(std::set<std::uint32_t>(own.numbers.begin(), own.numbers.end()), expected[b]);
    ASSERT_TRUE(std::is_sorted(own.numbers.begin(), own.numbers.end()));
    for (std::size_t i = 0; i < own.numbers.size(); ++i)
      for (std::size_t c = 0; c < 4; ++c) {
        const std::uint32_t here = own.mesh.tets[4 * i + c];
        const std::uint32_t there = mesh.tets[4 * own.numbers[i] + c];
        ASSERT_EQ(own.mesh.points[here], mesh.points[there]);
        const double a = own.mesh.attributes[1].number(here, 2);
        ASSERT_EQ(a, mesh.attributes[1].number(there, 2));
        ASSERT_EQ(own.mesh.attributes[3].number(i), mesh.attributes[3].number(own.numbers[i]));
      }
  }
}

// A box of nodes with many tets is cut: the file's bytes stay.
TEST_F(PrepareMesh, ManyBucketsInACube) {
#ifdef TETVDB_SANITIZED
  GTEST_SKIP() << "the limit cannot be low: shadow memory counts";
#endif
  limit_ = std::size_t(24) << 20;
  TetMesh mesh = meshes::jittered(meshes::kuhnGrid(36, 24, 24), 0.2, 5);
  VoxelizeJob wanted = job(withArrays(meshes::shuffled(
      meshes::mapped(mesh,
                     [](const Vec3d& p) {
                       return Vec3d{p[0] * 30 + 100, p[1] * 5 + 100, p[2] * 5 + 100};
                     }),
      8)));
  wanted.grids = {GridKind::TetId};
  expectSamePrepared(wanted, "cut");
  EXPECT_GE(made_.buckets, 2u);
  EXPECT_GT(made_.storedTets, made_.input.tets);
  EXPECT_LT(made_.mostTets, made_.input.tets);
}

TEST_F(PrepareMesh, RefusesFilesThatAreMissingDamagedOrForeign) {
  VoxelizeJob wanted = job(bar(20, 200, 30, {0, 0, 0}));
  wanted.grids = {GridKind::TetId, GridKind::Surface};
  const std::string folder = prepare(wanted);
  const VoxelizeJob parts = ofParts(wanted, folder);
  const auto expectRefused = [&](const std::string& file) {
    Report report;
    try {
      run(parts, report, progress_);
      FAIL() << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid) << error.what();
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
    }
    EXPECT_FALSE(std::filesystem::exists(parts.output));
  };
  for (const std::string name : {"boundary.bin", "nodes.bin", "tets_0.bin", "prepared.json"}) {
    const std::string path = folder + "/" + name, whole = fileBytes(path);
    const auto put = [&](const std::string& bytes) {
      std::ofstream(path, std::ios::binary) << bytes;
    };
    put(whole.substr(0, whole.size() - 5));
    expectRefused(name);
    std::string damaged = whole;
    damaged[damaged.size() / 2] ^= 0x10;
    if (name != "prepared.json") {
      put(damaged);
      expectRefused(name);
      damaged = whole;
      damaged[0] ^= 1; // of another kind
      put(damaged);
      expectRefused(name);
      std::filesystem::remove(path);
      expectRefused(name);
    }
    put(whole);
  }
  Report report;
  run(parts, report, progress_);
}

// Whatever is in the index: an answer or an error, and nothing beyond the files.
TEST_F(PrepareMesh, MutatedIndices) {
  VoxelizeJob wanted = job(bar(6, 60, 30, {0, 0, 0}));
  wanted.grids = {GridKind::TetId};
  wanted.maxMemory = 0;
  const std::string folder = prepare(fieldsOf(wanted, {"heat"}));
  const std::string path = folder + "/prepared.json", whole = fileBytes(path);
  meshes::Random random(11);
  const std::string signs = "0123456789-.,{}[]\"en";
  for (int i = 0; i < 400; ++i) {
    std::string text = whole;
    for (std::size_t k = 0; k <= random.below(3); ++k)
      text[random.below(text.size())] = signs[random.below(signs.size())];
    std::ofstream(path, std::ios::binary) << text;
    VoxelizeJob parts = ofParts(wanted, folder);
    parts.maxMemory = residentBytes() + (std::size_t(128) << 20);
    try {
      describePrepared(folder);
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Invalid) << error.what();
      continue;
    }
    try {
      Report report;
      run(parts, report, progress_);
    } catch (const Error& error) {
      EXPECT_TRUE(error.status() == Status::Invalid || error.status() == Status::Limit ||
                  error.status() == Status::Usage)
          << error.what();
    }
  }
}

TEST_F(PrepareMesh, RefusesWhatTheFolderHasDecided) {
  VoxelizeJob wanted = job(bar(10, 100, 30, {0, 0, 0}));
  wanted.grids = {GridKind::Mask};
  VoxelizeJob parts = ofParts(wanted, prepare(wanted));
  const auto expectUsage = [&](const VoxelizeJob& job) {
    Report report;
    try {
      run(job, report, progress_);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), Status::Usage) << error.what();
    }
  };
  VoxelizeJob other = parts;
  other.voxelize.voxelSize = {1, 1, 1};
  expectUsage(other);
  other = parts;
  other.grids = {GridKind::TetId}; // was not asked for
  expectUsage(other);
  expectUsage(fieldsOf(parts, {"heat"}));
  other = parts;
  other.inputs.push_back(wanted.inputs.front());
  expectUsage(other);
  Report report;
  run(parts, report, progress_);
}

TEST_F(PrepareMesh, CancelledItLeavesNothing) {
  VoxelizeJob wanted = job(withArrays(meshes::ball(30, 300, {0, 0, 0})));
  wanted.grids = {GridKind::TetId};
  std::size_t checks = 0;
  const auto prepareUntil = [&](std::size_t last) {
    Progress progress;
    checks = 0;
    progress.onCheck([&] {
      if (++checks == last)
        progress.cancel();
    });
    Report report;
    wanted.threads = 1;
    prepareMesh(wanted, folder_ / "parts", report, progress);
  };
  prepareUntil(0);
  std::filesystem::remove_all(folder_ / "parts");
  const std::size_t all = checks;
  ASSERT_GT(all, 20u);
  for (const std::size_t last : {std::size_t(1), all / 4, all / 2, all * 3 / 4, all - 2}) {
    EXPECT_THROW(prepareUntil(last), Error);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()),
                            std::filesystem::directory_iterator()),
              1);
  }
}

} // namespace
