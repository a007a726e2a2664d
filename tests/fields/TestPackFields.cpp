// SPDX-License-Identifier: Apache-2.0
//
// Packed grids make the file that the same grids with their values make, byte for byte, and are
// described alike.
#include "FileBytes.h"
#include "Meshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <atomic>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>
#include <tbb/parallel_for.h>
#include <unistd.h>

namespace {

using namespace tetvdb;
namespace fs = std::filesystem;

using test::fileBytes;

class PackFields : public testing::Test {
protected:
  PackFields() : folder_(fs::temp_directory_path() / ("tetvdb_pack_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~PackFields() override { fs::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string folder() const { return folder_.string(); }

  // `seed` 0: one value throughout each array.
  static TetMesh mesh(std::uint64_t seed) {
    TetMesh mesh = meshes::scaled(meshes::jittered(meshes::kuhnGrid(5, 4, 6), 0.2, 3), 11.3);
    meshes::Random random(seed + 1);
    const auto value = [&](double max) { return seed == 0 ? max : random.between(-max, max); };
    std::vector<double> temperature;
    std::vector<float> velocity;
    std::vector<std::int32_t> kind;
    for (std::size_t i = 0; i < mesh.points.size(); ++i)
      temperature.push_back(value(900));
    for (std::size_t i = 0; i < 3 * mesh.cellCount; ++i)
      velocity.push_back(static_cast<float>(value(4)));
    for (std::size_t i = 0; i < mesh.cellCount; ++i)
      kind.push_back(seed == 0 ? 7 : static_cast<std::int32_t>(random.below(9)));
    mesh.attributes.push_back({"T", Attribute::On::Points, 1, std::move(temperature)});
    mesh.attributes.push_back({"vel", Attribute::On::Cells, 3, std::move(velocity)});
    mesh.attributes.push_back({"kind", Attribute::On::Cells, 1, std::move(kind)});
    return mesh;
  }

  // Writes `mesh` both ways and compares.
  void expectSame(const TetMesh& mesh, std::size_t inMemory, bool asHalf) const {
    FieldOptions wanted;
    wanted.all = true;
    if (mesh.attributes.front().name == "T")
      wanted.background = {{"T", -5}};
    Report report;
    Progress progress;
    const auto fields = resolveFields(mesh, wanted, report);
    const GridTransform transform{{1, 1, 1}, {0.3, 0, 0}};

    Volume whole;
    whole.metadata["source"] = "test";
    sampleFields(mesh, transform, fields, {}, whole, report, progress);
    for (const auto& grid : whole.grids().all) {
      if (asHalf && !grid->isType<openvdb::Int32Grid>())
        grid->setSaveFloatAsHalf(true);
      openFirstTile(*grid);
    }
    writeVolume(file("whole.vdb"), whole, progress);

    Volume none;
    none.metadata = whole.metadata;
    std::vector<std::unique_ptr<PackedGrid>> packed;
    const PackOptions pack{folder(), inMemory, asHalf};
    packFields(mesh, transform, fields, {}, pack, packed, report, progress);
    const std::vector<GridInfo> infos = describe(whole);
    ASSERT_EQ(packed.size(), infos.size());
    for (std::size_t i = 0; i < packed.size(); ++i) {
      openFirstTile(*packed[i]->grid);
      const GridInfo info = describe(*packed[i]);
      EXPECT_EQ(info.name, infos[i].name);
      EXPECT_EQ(info.activeVoxels, infos[i].activeVoxels);
      EXPECT_EQ(info.activeTiles, infos[i].activeTiles);
      EXPECT_EQ(info.leaves, infos[i].leaves);
      EXPECT_EQ(info.bytes, infos[i].bytes);
      EXPECT_EQ(info.minValue, infos[i].minValue);
      EXPECT_EQ(info.maxValue, infos[i].maxValue);
      EXPECT_EQ(info.boxMin, infos[i].boxMin);
      EXPECT_EQ(info.boxMax, infos[i].boxMax);
      EXPECT_EQ(info.metadata, infos[i].metadata);
    }
    writeVdb(file("packed.vdb"), none, packed, progress);
    EXPECT_EQ(fileBytes(file("packed.vdb")), fileBytes(file("whole.vdb")));
    EXPECT_EQ(hash(readVolume(file("packed.vdb"), progress)),
              hash(readVolume(file("whole.vdb"), progress)));
  }

private:
  fs::path folder_;
};

TEST_F(PackFields, SameBytes) {
  expectSame(mesh(1), std::size_t(32) << 20, false);
}

TEST_F(PackFields, SameBytesThroughTheTemporaryFile) {
  expectSame(mesh(1), 0, false);
}

TEST_F(PackFields, SameBytesAsHalf) {
  expectSame(mesh(2), 0, true);
}

TEST_F(PackFields, UniformLeavesAndTiles) {
  expectSame(mesh(0), 0, false);
}

// A box of 128^3 voxels with one value: a tile alone, which is opened.
TEST_F(PackFields, TilesAlone) {
  TetMesh box = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 128, {-0.2, -0.5, -0.5});
  box.attributes.push_back({"k", Attribute::On::Cells, 1, std::vector<double>(box.cellCount, 2.5)});
  expectSame(box, 0, false);
}

TEST_F(PackFields, VoxelsWithoutAFiniteValue) {
  TetMesh holes = mesh(3);
  auto& values = std::get<std::vector<double>>(holes.attributes[0].values);
  for (std::size_t i = 0; i < values.size(); i += 7)
    values[i] = std::numeric_limits<double>::quiet_NaN();
  expectSame(holes, 0, false);
}

TEST_F(PackFields, NothingIsLeftBeside) {
  expectSame(mesh(1), 0, false);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder()))
    ++files;
  EXPECT_EQ(files, 2u);
}

TEST_F(PackFields, StoreKeepsWhatManyThreadsAdd) {
  for (const std::size_t inMemory : {std::size_t(0), std::size_t(3) << 20}) {
    TailStore store(folder(), inMemory);
    constexpr std::size_t count = 20000;
    const auto text = [](std::size_t i) { return std::string(1 + i % 701, char('a' + i % 26)); };
    std::vector<std::uint64_t> at(count);
    tbb::parallel_for(std::size_t(0), count,
                      [&](std::size_t i) { at[i] = store.add(text(i).data(), text(i).size()); });
    std::atomic<std::size_t> wrong{0};
    tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
      std::string back(text(i).size(), '\0');
      store.read(at[i], back.data(), back.size());
      wrong += back != text(i) ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0u);
  }
}

TEST_F(PackFields, FolderThatDoesNotExist) {
  TailStore store(folder() + "/nowhere", 0);
  const std::string bytes(TailStore::kChunk, 'x');
  store.add(bytes.data(), bytes.size());
  try {
    store.add(bytes.data(), bytes.size());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Write);
  }
}

} // namespace
