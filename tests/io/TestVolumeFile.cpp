// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/io/File.h>
#include <openvdb/tree/LeafManager.h>
#include <random>
#include <sstream>
#include <sys/resource.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for each test, removed at its end.
class VolumeFile : public ::testing::Test {
protected:
  void SetUp() override { initializeOpenVDB(); }

  std::string path(const std::string& name) const { return folder / name; }
  std::size_t filesInFolder() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
  }

  TemporaryFolder folder;
  Progress progress;
};

using test::fileBytes;

void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
}

openvdb::math::Transform::Ptr anisotropic() {
  return makeTransform({{0.05, 0.1, 0.025}, {-3, 7.5, 1e-3}});
}

template <class GridT>
typename GridT::Ptr newGrid(const char* name, typename GridT::ValueType background,
                            openvdb::GridClass gridClass = openvdb::GRID_UNKNOWN) {
  auto grid = GridT::create(background);
  grid->setName(name);
  grid->setGridClass(gridClass);
  grid->setTransform(anisotropic());
  grid->setCreator("test");
  return grid;
}

/// A fog of ones with tiles on every level, half-full leaves, and a few odd values.
openvdb::FloatGrid::Ptr fog() {
  auto grid = newGrid<openvdb::FloatGrid>("density", 0.0F, openvdb::GRID_FOG_VOLUME);
  grid->sparseFill({openvdb::Coord(-300, -9, -70), openvdb::Coord(171, 140, 133)}, 1.0F, true);
  for (int i = 0; i < 3000; ++i)
    grid->tree().setValueOn(openvdb::Coord(i, (i * 7) % 501, -i), float(i % 3));
  grid->tree().addTile(3, openvdb::Coord(8192, 0, 0), 1.0F, true);
  grid->tree().addTile(3, openvdb::Coord(-8192, 0, 0), 2.5F, false);
  grid->tree().addTile(2, openvdb::Coord(256, 1024, 0), 1.0F, true);
  return grid;
}

/// Values that differ everywhere, inactive ones of both signs: nothing to share.
openvdb::FloatGrid::Ptr levelSet() {
  auto grid = newGrid<openvdb::FloatGrid>("surface", 3.0F, openvdb::GRID_LEVEL_SET);
  auto accessor = grid->getAccessor();
  for (int x = -30; x < 30; ++x)
    for (int y = -30; y < 30; ++y)
      for (int z = -30; z < 30; ++z) {
        const float d = std::sqrt(float(x * x + y * y + z * z)) - 20.0F;
        if (std::abs(d) < 3)
          accessor.setValue({x, y, z}, d);
        else if (d < 0)
          accessor.setValueOff({x, y, z}, -3.0F);
      }
  return grid;
}

openvdb::GridPtrVec manyGrids() {
  auto mask = newGrid<openvdb::BoolGrid>("mask", false);
  mask->sparseFill({openvdb::Coord(-20), openvdb::Coord(99)}, true, true);
  auto id = newGrid<openvdb::Int32Grid>("tet_id", -1);
  id->sparseFill({openvdb::Coord(0), openvdb::Coord(60)}, 7, true);
  for (int i = 0; i < 4000; ++i)
    id->tree().setValueOn({i % 90, i % 77, i % 13}, i);
  auto velocity = newGrid<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0));
  velocity->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, openvdb::Vec3s(1, 2, 3), true);
  velocity->tree().setValueOn({100, 2, 3}, openvdb::Vec3s(-1, 0, 5));
  auto wide = newGrid<openvdb::DoubleGrid>("wide", 0.25);
  wide->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, 1e300, true);
  auto count = newGrid<openvdb::Int64Grid>("count", 0);
  count->sparseFill({openvdb::Coord(-5), openvdb::Coord(30)}, std::int64_t(1) << 60, true);
  return {fog(), levelSet(), mask, id, velocity, wide, count};
}

Volume volumeOf(const openvdb::GridPtrVec& grids) {
  Volume volume;
  volume.grids().all = grids;
  return volume;
}

/// What openvdb::io::File makes of the same grids.
std::string bytesOfFile(const std::string& path, const openvdb::GridPtrVec& grids,
                        const openvdb::MetaMap& metadata = {}) {
  openvdb::io::File file(path);
  file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  file.write(grids, metadata);
  file.close();
  return fileBytes(path);
}

/// All but the UUID, which is random in one file and derived from the content in ours, and the file
/// version: OpenVDB 13 writes 225, which differs in a type of grid that ours do not have.
std::string comparable(std::string bytes) {
  if (bytes.size() > 57) {
    bytes.replace(8, 4, 4, '0');
    bytes.replace(21, 36, 36, '0');
  }
  return bytes;
}

template <class Action>
void expectError(Status status, const Action& action) {
  try {
    action();
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), status) << error.what();
  }
}

TEST_F(VolumeFile, SameBytesAsOpenVdbsOwnFile) {
  for (const auto& grid : manyGrids()) {
    const openvdb::GridPtrVec one{grid};
    writeVolume(path("a.vdb"), volumeOf(one), progress);
    EXPECT_EQ(fileBytes(path("a.vdb")).substr(8, 4), std::string("\xE0\0\0\0", 4)); // 224
    EXPECT_TRUE(comparable(fileBytes(path("a.vdb"))) == comparable(bytesOfFile(path("b.vdb"), one)))
        << grid->getName();
  }
}

TEST_F(VolumeFile, SameBytesForSeveralGridsHalfFloatsSharedTreesAndMetadata) {
  auto grids = manyGrids();
  grids[0]->setSaveFloatAsHalf(true);
  grids[1]->setSaveFloatAsHalf(true);
  grids.push_back(grids[3]->copyGrid());
  grids.back()->setName("shared");
  grids.back()->setTransform(grids[3]->transformPtr());
  grids.push_back(newGrid<openvdb::FloatGrid>("empty", 0.0F));
  grids.push_back(newGrid<openvdb::MaskGrid>("topology", false));
  Volume volume = volumeOf(grids);
  volume.metadata = {{"creator", "TetVDB"}, {"source", "a.vtu"}, {"units", "mm"}};
  openvdb::MetaMap metadata;
  for (const auto& [key, text] : volume.metadata)
    metadata.insertMeta(key, openvdb::StringMetadata(text));
  writeVolume(path("a.vdb"), volume, progress);
  EXPECT_TRUE(comparable(fileBytes(path("a.vdb"))) ==
              comparable(bytesOfFile(path("b.vdb"), grids, metadata)));
}

TEST_F(VolumeFile, EqualContentGivesEqualFiles) {
  writeVolume(path("a.vdb"), volumeOf(manyGrids()), progress);
  writeVolume(path("b.vdb"), volumeOf(manyGrids()), progress);
  EXPECT_TRUE(fileBytes(path("a.vdb")) == fileBytes(path("b.vdb")));
  writeVolume(path("a.nvdb"), volumeOf({fog(), levelSet()}), progress);
  writeVolume(path("b.nvdb"), volumeOf({fog(), levelSet()}), progress);
  EXPECT_TRUE(fileBytes(path("a.nvdb")) == fileBytes(path("b.nvdb")));
}

TEST_F(VolumeFile, RoundTripKeepsEverything) {
  for (const std::string file : {"a.vdb", "a.nvdb"}) {
    Volume volume = volumeOf(manyGrids());
    volume.metadata["source"] = "bracket.vtu";
    writeVolume(path(file), volume, progress);
    const Volume back = readVolume(path(file), progress);
    EXPECT_EQ(hash(back), hash(volume)) << file;
    if (file == "a.vdb") {
      EXPECT_EQ(back.metadata.at("source"), "bracket.vtu");
    }
    const auto comparison = compareVolumes(volume, back);
    EXPECT_TRUE(comparison.same() && comparison.sameHash) << file;
  }
}

TEST_F(VolumeFile, RoundTripOfGridsWithoutVoxels) {
  for (const std::string file : {"a.vdb", "a.nvdb"}) {
    auto tile = newGrid<openvdb::FloatGrid>("tile", 0.0F);
    tile->tree().addTile(3, openvdb::Coord(-4096, 0, 4096), 5.0F, true);
    const Volume volume = volumeOf({newGrid<openvdb::FloatGrid>("empty", -2.0F), tile});
    writeVolume(path(file), volume, progress);
    EXPECT_EQ(hash(readVolume(path(file), progress)), hash(volume)) << file;
  }
}

TEST_F(VolumeFile, StatisticsAndCreatorAreInTheFile) {
  auto grid = fog();
  grid->removeMeta("creator");
  writeVolume(path("a.vdb"), volumeOf({grid}), progress);
  openvdb::io::File file(path("a.vdb"));
  file.open();
  const auto read = file.readGridMetadata("density");
  EXPECT_EQ(read->getCreator().substr(0, 7), "TetVDB ");
  EXPECT_EQ(read->getGridClass(), openvdb::GRID_FOG_VOLUME);
  EXPECT_EQ(read->metaValue<openvdb::Int64>("file_voxel_count"),
            static_cast<openvdb::Int64>(grid->activeVoxelCount()));
  const auto box = grid->evalActiveVoxelBoundingBox();
  EXPECT_EQ(read->metaValue<openvdb::Vec3i>("file_bbox_min"), box.min().asVec3i());
  EXPECT_EQ(read->metaValue<openvdb::Vec3i>("file_bbox_max"), box.max().asVec3i());
  EXPECT_EQ(read->metaValue<std::string>("file_compression"), "blosc + active values");
  // The grid in memory stays as it was.
  EXPECT_FALSE((*grid)["file_voxel_count"]);
  EXPECT_EQ(grid->getCreator(), "");
}

/// What follows the entry for delayed loading, and the entry as OpenVDB understands it.
std::pair<std::string, std::string> aroundDelayedLoad(const std::string& path) {
  const std::string bytes = fileBytes(path), type = "__delayedload";
  const std::size_t at = bytes.find(type) + type.size();
  std::uint32_t size = 0;
  std::memcpy(&size, &bytes.at(at), sizeof size);
  const std::size_t end = at + sizeof size + size;
  openvdb::io::DelayedLoadMetadata entries;
  std::istringstream stream(bytes.substr(at, end - at), std::ios::binary);
  entries.read(stream);
  std::string text;
  for (std::size_t l = 0; l < 32768; ++l)
    text += std::to_string(entries.getMask(l)) + ' ' +
            std::to_string(entries.getCompressedSize(l)) + '\n';
  return {bytes.substr(end), text};
}

// More than waits in memory for the entry: it is not compressed, and all else is the same.
TEST_F(VolumeFile, ManyValuesAreNotKeptForTheEntryOfDelayedLoading) {
  const auto grid = newGrid<openvdb::FloatGrid>("noise", 0.0F);
  grid->denseFill({openvdb::Coord(0), openvdb::Coord(255)}, 1.0F, true);
  openvdb::tree::LeafManager<openvdb::FloatTree> manager(grid->tree());
  manager.foreach ([](openvdb::FloatTree::LeafNodeType& leaf, std::size_t l) {
    std::mt19937 random(static_cast<unsigned>(l));
    for (auto value = leaf.beginValueOn(); value; ++value) {
      const auto bits = static_cast<std::uint32_t>(random()) & ~0x40000000u; // a finite number's
      float noise;
      std::memcpy(&noise, &bits, sizeof noise);
      value.setValue(noise);
    }
    if (l % 3 == 0)
      leaf.setValueOff(static_cast<openvdb::Index>(l % 512), 0.0F);
  });
  ASSERT_EQ(grid->tree().leafCount(), 32768u);
  writeVolume(path("a.vdb"), volumeOf({grid}), progress);
  const std::string theirs = bytesOfFile(path("b.vdb"), {grid});
  const std::size_t ours = fs::file_size(path("a.vdb"));
  EXPECT_GT(ours, theirs.size() + 100000) << "the entry is not compressed";
  EXPECT_LT(ours, theirs.size() + 9 * 32768);
  const auto [rest, entries] = aroundDelayedLoad(path("a.vdb"));
  const auto [expectedRest, expectedEntries] = aroundDelayedLoad(path("b.vdb"));
  EXPECT_TRUE(entries == expectedEntries);
  EXPECT_GT(entries.size(), 32768u * 6);
  EXPECT_TRUE(rest == expectedRest);
  openvdb::io::File file(path("a.vdb"));
  file.setCopyMaxBytes(0);
  file.open(/*delayLoad=*/true);
  EXPECT_EQ(hash(volumeOf(*file.getGrids())), hash(volumeOf({grid})));
  EXPECT_EQ(hash(readVolume(path("a.vdb"), progress)), hash(volumeOf({grid})));
}

#ifdef OPENVDB_USE_DELAYED_LOADING // OpenVDB can be built without it
TEST_F(VolumeFile, DelayedLoadingFindsEveryLeaf) {
  const auto grids = manyGrids();
  writeVolume(path("a.vdb"), volumeOf(grids), progress);
  openvdb::io::File file(path("a.vdb"));
  file.setCopyMaxBytes(0);
  file.open(/*delayLoad=*/true);
  const Volume back = volumeOf(*file.getGrids());
  EXPECT_EQ(hash(back), hash(volumeOf(grids)));
}
#endif

TEST_F(VolumeFile, OffsetsLetReadersTakeOneGridOfMany) {
  const auto grids = manyGrids();
  writeVolume(path("a.vdb"), volumeOf(grids), progress);
  openvdb::io::File file(path("a.vdb"));
  file.open(false);
  for (const auto& grid : grids)
    EXPECT_EQ(hash(volumeOf({file.readGrid(grid->getName())})), hash(volumeOf({grid})));
}

TEST_F(VolumeFile, NamesAreUniqueAndExtensionsKnown) {
  const auto write = [&](const std::string& name, const openvdb::GridPtrVec& grids) {
    return [=] {
      Progress own;
      writeVolume(path(name), volumeOf(grids), own);
    };
  };
  expectError(Status::Usage, write("a.vdb", {fog(), fog()}));
  expectError(Status::Usage, write("a.nvdb", {fog(), fog()}));
  expectError(Status::Usage, write("a.vdb", {newGrid<openvdb::FloatGrid>("", 0.0F)}));
  expectError(Status::Usage, write("a.raw", {fog()}));
  expectError(Status::Usage,
              write("a.nvdb", {newGrid<openvdb::Vec3DGrid>("v", openvdb::Vec3d(0))}));
  expectError(Status::Write, write("no/such/folder/a.vdb", {fog()}));
  EXPECT_EQ(filesInFolder(), 0U);
}

TEST_F(VolumeFile, CancelLeavesNoFile) {
  progress.cancel();
  for (const char* file : {"a.vdb", "a.nvdb"})
    expectError(Status::Cancelled, [&] { writeVolume(path(file), volumeOf({fog()}), progress); });
  EXPECT_EQ(filesInFolder(), 0U);
}

TEST_F(VolumeFile, ProgressRunsFromZeroToOne) {
  double last = 0;
  progress.onReport([&](std::string_view, double fraction) {
    EXPECT_LE(fraction, 1.0 + 1e-9);
    last = std::max(last, fraction);
  });
  writeVolume(path("a.vdb"), volumeOf(manyGrids()), progress);
  EXPECT_GT(last, 0.0);
}

/// A limit on the size of files fails as a full disk does: write() writes less, then nothing.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST_F(VolumeFile, FullDiskIsAnErrorAndLeavesNoFile) {
  for (const std::string file : {"a.vdb", "a.nvdb"}) {
    const Volume volume = volumeOf({fog(), levelSet()});
    writeVolume(path("whole" + file), volume, progress);
    const auto size = fs::file_size(path("whole" + file));
    writeBytes(path(file), "an older file");
    for (const std::uintmax_t room : {std::uintmax_t(0), std::uintmax_t(100), size / 2, size - 1}) {
      const FileSizeLimit limit(room);
      expectError(Status::Write, [&] { writeVolume(path(file), volume, progress); });
    }
    EXPECT_EQ(fileBytes(path(file)), "an older file");
    fs::remove(path("whole" + file));
    fs::remove(path(file));
    EXPECT_EQ(filesInFolder(), 0U);
  }
}

TEST_F(VolumeFile, FilesThatAreNoVolumes) {
  const auto read = [&](const std::string& name) {
    return [=] {
      Progress own;
      readVolume(path(name), own);
    };
  };
  expectError(Status::Invalid, read("missing.vdb"));
  expectError(Status::Invalid, read(""));
  writeBytes(path("empty.vdb"), "");
  expectError(Status::Invalid, read("empty.vdb"));
  writeBytes(path("text.vdb"), "solid cube");
  expectError(Status::Invalid, read("text.vdb"));
  writeBytes(path("short.vdb"), " BDV");
  expectError(Status::Invalid, read("short.vdb"));
}

/// Reads `bytes`; true if that gave a volume, false if it gave an Error; anything else fails.
bool reads(const std::string& path, const std::string& bytes) {
  writeBytes(path, bytes);
  Progress progress;
  try {
    const Volume volume = readVolume(path, progress);
    describe(volume);
    return true;
  } catch (const Error&) {
    return false;
  }
}

TEST_F(VolumeFile, EveryCutFileIsAnError) {
  auto velocity = newGrid<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0));
  velocity->tree().setValueOn({100, 2, 3}, openvdb::Vec3s(-1, 0, 5));
  auto mask = newGrid<openvdb::BoolGrid>("mask", false);
  for (int i = 0; i < 40; ++i)
    mask->tree().setValueOn({i, 2, 3}, true);
  for (const std::string file : {"a.vdb", "a.nvdb"}) {
    for (const openvdb::GridPtrVec& grids :
         {openvdb::GridPtrVec{mask}, openvdb::GridPtrVec{velocity, mask}}) {
      writeVolume(path(file), volumeOf(grids), progress);
      const std::string whole = fileBytes(path(file));
      const std::size_t step = std::max<std::size_t>(1, whole.size() / 150);
      for (std::size_t size = 0; size < whole.size(); size += size < 400 ? 7 : step)
        EXPECT_FALSE(reads(path("cut-" + file), whole.substr(0, size))) << file << " " << size;
      EXPECT_FALSE(reads(path("cut-" + file), whole.substr(0, whole.size() - 1)));
    }
  }
}

TEST_F(VolumeFile, MutatedFilesGiveAVolumeOrAnError) {
  std::mt19937_64 random(7);
  for (const std::string file : {"a.vdb", "a.nvdb"}) {
    auto small = newGrid<openvdb::FloatGrid>("small", 0.0F);
    for (int i = 0; i < 90; ++i)
      small->tree().setValueOn({i, 2, 3}, float(i));
    writeVolume(path(file), volumeOf({small}), progress);
    const std::string whole = fileBytes(path(file));
    int good = 0;
    for (int i = 0; i < 120; ++i) {
      std::string bytes = whole;
      // Half of the changes hit the first bytes, where the structure is.
      const std::size_t range =
          i % 2 == 0 ? std::min<std::size_t>(900, bytes.size()) : bytes.size();
      for (int k = 0; k < 1 + i % 4; ++k)
        bytes[random() % range] = static_cast<char>(random());
      good += reads(path("mutant-" + file), bytes);
    }
    EXPECT_LT(good, 120) << file;
  }
}

/// Runs a program of the system; skips the test where it is not installed.
std::string outputOf(const std::string& command) {
  std::string output;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe)
    return output;
  char buffer[4096];
  while (const std::size_t size = std::fread(buffer, 1, sizeof buffer, pipe))
    output.append(buffer, size);
  ::pclose(pipe);
  return output;
}

bool succeeds(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

TEST_F(VolumeFile, PythonModuleReadsIt) {
  if (!succeeds("/usr/bin/python3 -c 'import pyopenvdb'"))
    GTEST_SKIP() << "no pyopenvdb";
  auto mask = newGrid<openvdb::BoolGrid>("mask", false);
  mask->sparseFill({openvdb::Coord(-20), openvdb::Coord(99)}, true, true);
  auto velocity = newGrid<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0));
  velocity->fill({openvdb::Coord(-5), openvdb::Coord(30)}, openvdb::Vec3s(1, 2, 3), true);
  const openvdb::GridPtrVec grids{fog(), mask, velocity};
  writeVolume(path("a.vdb"), volumeOf(grids), progress);
  const std::string output = outputOf(
      "/usr/bin/python3 -c \"import pyopenvdb as v\nfor g in v.readAll('" + path("a.vdb") +
      "')[0]: print(g.name, g.gridClass, g.activeVoxelCount(), g.transform.voxelSize())\"");
  for (const auto& grid : grids)
    EXPECT_NE(output.find(grid->getName() + " " +
                          openvdb::GridBase::gridClassToString(grid->getGridClass()) + " " +
                          std::to_string(grid->activeVoxelCount()) + " (0.05, 0.1, 0.025)"),
              std::string::npos)
        << output;
}

TEST_F(VolumeFile, VdbPrintReadsIt) {
  if (!succeeds("which vdb_print"))
    GTEST_SKIP() << "no vdb_print";
  writeVolume(path("a.vdb"), volumeOf(manyGrids()), progress);
  const std::string output = outputOf("vdb_print -l " + path("a.vdb"));
  for (const char* name : {"density", "surface", "mask", "tet_id", "vel", "wide", "count"})
    EXPECT_NE(output.find(name), std::string::npos) << output;
  EXPECT_TRUE(succeeds("vdb_print -l " + path("a.vdb")));
}

TEST_F(VolumeFile, NanoVdbsValidatorPasses) {
  if (!succeeds("which nanovdb_validate"))
    GTEST_SKIP() << "no nanovdb_validate";
  writeVolume(path("a.nvdb"), volumeOf(manyGrids()), progress);
  const std::string output = outputOf("nanovdb_validate -v " + path("a.nvdb"));
  std::size_t passed = 0;
  for (std::size_t at = 0; (at = output.find("passed", at)) != std::string::npos; ++at)
    ++passed;
  EXPECT_GE(passed, manyGrids().size()) << output;
  EXPECT_EQ(output.find("failed"), std::string::npos) << output;
}

} // namespace
} // namespace tetvdb
