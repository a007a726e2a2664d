// SPDX-License-Identifier: Apache-2.0
//
// Damaged volume files end in an Error or in a volume that can be described and hashed, without a
// crash and in little memory. TETVDB_MUTANTS sets how many of each file are tried.
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/volume/NvdbLayout.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <blosc.h>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/points/PointDataGrid.h>
#include <random>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace tetvdb {
namespace {

class DamagedVolume : public testing::Test {
protected:
  DamagedVolume() { initializeOpenVDB(); }

  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::string bytesOf(const std::string& name) const { return test::fileBytes(folder_ / name); }
  /// What the error says; "" where the file is read.
  std::string refusal(const std::string& bytes, const std::string& name = "a.vdb") const {
    write(name, bytes);
    Progress progress;
    try {
      const Volume volume = readVolume(folder_ / name, progress);
      describe(volume);
      hash(volume);
      return {};
    } catch (const Error& error) {
      EXPECT_TRUE(error.status() == Status::Invalid || error.status() == Status::Limit);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
  }
  std::string written(const openvdb::GridPtrVec& grids, const std::string& name) const {
    Volume volume;
    volume.grids().all = grids;
    Progress progress;
    writeVolume(folder_ / name, volume, progress);
    return bytesOf(name);
  }

  TemporaryFolder folder_;
};

template <class GridT>
typename GridT::Ptr some(const char* name, typename GridT::ValueType background,
                         typename GridT::ValueType value) {
  auto grid = GridT::create(background);
  grid->setName(name);
  for (int i = 0; i < 40; ++i)
    grid->tree().setValueOn({i * 5, 2, i % 3}, value);
  grid->tree().addTile(1, {-64, 0, 0}, value, true);
  grid->tree().addTile(3, {8192, 0, 0}, value, true);
  return grid;
}

openvdb::GridPtrVec someGrids() {
  auto half = some<openvdb::FloatGrid>("half", 0, 0.5F);
  half->setSaveFloatAsHalf(true);
  auto number = some<openvdb::FloatGrid>("number", 3, -1);
  number->tree().setValueOn({1, 1, 1}, 0.125F);
  return {number, half, some<openvdb::BoolGrid>("flag", false, true),
          some<openvdb::Int32Grid>("id", -1, 7),
          some<openvdb::Vec3SGrid>("vel", openvdb::Vec3s(0), openvdb::Vec3s(1, 2, 3))};
}

void put(std::string& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(&bytes.at(at), &value, sizeof value);
}

TEST_F(DamagedVolume, OtherVersions) {
  const std::string whole = written(someGrids(), "whole.vdb");
  EXPECT_EQ(refusal(whole), "");
  for (const auto& [version, says] :
       std::vector<std::pair<std::uint32_t, const char*>>{{0, "before OpenVDB 3"},
                                                          {213, "before OpenVDB 3"},
                                                          {221, "before OpenVDB 3"},
                                                          {222, ""},
                                                          {223, ""},
                                                          {225, ""},
                                                          {226, "newer than"},
                                                          {230, "newer than"},
                                                          {UINT32_MAX, "newer than"}}) {
    std::string bytes = whole;
    put(bytes, 8, version);
    const std::string text = refusal(bytes);
    EXPECT_EQ(text.empty(), *says == '\0') << version << text;
    EXPECT_NE(text.find(says), std::string::npos) << version << text;
  }
}

TEST_F(DamagedVolume, GridsOfOtherTypesAreLeftOut) {
  const auto points = openvdb::points::PointDataGrid::create();
  points->setName("points");
  const auto save = [&](const openvdb::GridPtrVec& grids) {
    openvdb::io::File(folder_ / "a.vdb").write(grids);
    return bytesOf("a.vdb");
  };
  EXPECT_NE(refusal(save({points})).find("Tree_ptdataidx32_5_4_3"), std::string::npos);

  save({points, some<openvdb::BoolGrid>("m", false, true)});
  Progress progress;
  const Volume volume = readVolume(folder_ / "a.vdb", progress);
  ASSERT_EQ(volume.grids().all.size(), 1U);
  EXPECT_EQ(volume.grids().all.front()->getName(), "m");
  ASSERT_EQ(volume.unread.size(), 1U);
  EXPECT_EQ(volume.unread.front().name, "points");
  EXPECT_EQ(volume.unread.front().type, "Tree_ptdataidx32_5_4_3");
}

TEST_F(DamagedVolume, FilesWithoutOffsetsAreCheckedToo) {
  {
    std::ofstream file(folder_ / "stream.vdb", std::ios::binary);
    openvdb::io::Stream stream(file);
    stream.write(someGrids());
  }
  const std::string whole = bytesOf("stream.vdb");
  ASSERT_EQ(whole[20], 0) << "has offsets";
  EXPECT_EQ(refusal(whole), "");
  for (std::size_t size = 60; size < whole.size(); size += whole.size() / 97)
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
}

TEST_F(DamagedVolume, Frustums) {
  auto grid = some<openvdb::FloatGrid>("frustum", 0, 1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(
      openvdb::BBoxd({0, 0, 0}, {9, 9, 9}), 0.5, 10.0, 0.1));
  const std::string whole = written({grid}, "frustum.vdb");
  EXPECT_EQ(refusal(whole), "");
  for (std::size_t size = 60; size < whole.size(); size += whole.size() / 97)
    EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
}

TEST_F(DamagedVolume, LeavesThatTheFileCannotHold) {
  auto grid = some<openvdb::FloatGrid>("number", 3, -1);
  std::string bytes = written({grid}, "delayed.vdb");
  const std::size_t at = bytes.find("__delayedload");
  ASSERT_NE(at, bytes.npos);
  put(bytes, at + 13 + 4, 0xFFFFFFF0); // after the type's name and the value's size
  EXPECT_NE(refusal(bytes).find("more leaves"), std::string::npos);
}

/// A few changes: bytes, numbers at their limits, pieces that go, come, or come twice.
std::string mutatedVolume(std::string bytes, std::mt19937& random) {
  // Most changes hit the beginning, where the structure is.
  const auto place = [&] {
    const double u = static_cast<double>(random()) / 4294967296.0;
    return static_cast<std::size_t>(static_cast<double>(bytes.size()) *
                                    (random() % 3 == 0 ? u : u * u * u * u));
  };
  constexpr std::uint32_t kNumbers[] = {0,       1,          2,          255,       65536,
                                        1000000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
  for (std::size_t n = std::size_t(1) << random() % 4; n > 0; --n) {
    const std::size_t at = place();
    switch (random() % 8) {
    case 0:
      bytes.erase(at, 1 + random() % 60);
      break;
    case 1:
      bytes.insert(at, bytes.substr(place(), 1 + random() % 60));
      break;
    case 2:
    case 3:
      if (at + 4 <= bytes.size())
        put(bytes, at, kNumbers[random() % std::size(kNumbers)]);
      break;
    case 4:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
      break;
    default:
      bytes[at] = static_cast<char>(random());
    }
    if (bytes.size() < 100)
      break;
  }
  return bytes;
}

// OpenVDB reads values as the metadata says, whatever the type's suffix.
TEST_F(DamagedVolume, HalfFloatsThatTheMetadataDenies) {
  std::string bytes = written({someGrids().at(1)}, "half.vdb");
  EXPECT_EQ(refusal(bytes), "");
  const std::size_t key = bytes.find("is_saved_as_half_float");
  ASSERT_NE(key, std::string::npos);
  bytes[key] = 'I';
  EXPECT_NE(refusal(bytes).find("do not agree about half floats"), std::string::npos);
}

// A byte that is neither 0 nor 1 is no bool: OpenVDB may take it for false where this program takes
// it for true.
TEST_F(DamagedVolume, BooleanMetadataThatIsNeitherZeroNorOne) {
  std::string bytes = written({someGrids().at(1)}, "half.vdb");
  const std::size_t key = bytes.find("is_saved_as_half_float");
  ASSERT_NE(key, std::string::npos);
  const std::size_t value = bytes.find("bool", key) + 4 + sizeof(std::uint32_t);
  ASSERT_EQ(bytes[value], 1);
  bytes[value] = static_cast<char>(234);
  EXPECT_NE(refusal(bytes).find("metadata has an impossible value"), std::string::npos);
}

/// A .nvdb file of one grid of booleans without compression and checksum, where the bytes of its
/// tiles that are true are `yes`.
std::string withBooleans(const std::string& packed, unsigned char yes) {
  NvdbHeader header;
  NvdbEntry entry;
  std::memcpy(&header, packed.data(), sizeof header);
  std::memcpy(&entry, packed.data() + sizeof header, sizeof entry);
  const std::size_t at = sizeof header + sizeof entry + entry.nameSize;
  struct alignas(32) Block {
    char bytes[32];
  };
  std::vector<Block> blocks(entry.gridSize / sizeof(Block));
  EXPECT_EQ(blosc_decompress_ctx(packed.data() + at + 8, blocks.data(), entry.gridSize, 1),
            static_cast<int>(entry.gridSize));
  auto* grid = reinterpret_cast<nanovdb::NanoGrid<bool>*>(blocks.data());
  checksumOf(*grid->data()) = ~std::uint64_t(0);
  auto* lower = const_cast<nanovdb::NanoLower<bool>*>(grid->tree().getFirstLower())->data();
  std::size_t changed = 0;
  for (std::uint32_t n = 0; n < 4096; ++n)
    if (lower->mValueMask.isOn(n)) {
      std::memcpy(&lower->mTable[n].value, &yes, 1);
      ++changed;
    }
  EXPECT_GT(changed, 0U);
  header.codec = entry.codec = NvdbCodec::None;
  std::string file = packed.substr(0, at);
  std::memcpy(&file[0], &header, sizeof header);
  std::memcpy(&file[sizeof header], &entry, sizeof entry);
  return file + std::string(blocks.data()->bytes, entry.gridSize);
}

TEST_F(DamagedVolume, BytesOfBooleansThatAreNeitherZeroNorOne) {
  const auto grid = openvdb::BoolGrid::create(false);
  grid->setName("flag");
  grid->tree().addTile(1, {8, 0, 0}, true, true);
  grid->tree().setValueOn({0, 0, 0}, true);
  const std::string packed = written({grid}, "a.nvdb");
  const auto hashOf = [&](const std::string& bytes) {
    write("b.nvdb", bytes);
    Progress progress;
    return hash(readVolume(folder_ / "b.nvdb", progress));
  };
  EXPECT_EQ(hashOf(withBooleans(packed, 1)), hashOf(packed));
  EXPECT_EQ(hashOf(withBooleans(packed, 6)), hashOf(packed));
}

long peakMegabytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST_F(DamagedVolume, MutantsEndInAVolumeOrAnError) {
  const char* asked = std::getenv("TETVDB_MUTANTS");
#ifdef TETVDB_SANITIZED
  const int count = asked != nullptr ? std::atoi(asked) : 50;
#else
  const int count = asked != nullptr ? std::atoi(asked) : 150;
#endif
  [[maybe_unused]] const long before = peakMegabytes(); // sanitizers take memory of their own
  for (const std::string name : {"a.vdb", "a.nvdb"}) {
    std::vector<std::string> seeds{written(someGrids(), name)};
    for (const auto& grid : someGrids())
      seeds.push_back(written({grid}, name));
    std::mt19937 random(11);
    for (const std::string& seed : seeds)
      for (int i = 0; i < count; ++i) {
        const std::string mutant = mutatedVolume(seed, random);
        write("mutant", mutant); // what is there after a crash
        refusal(mutant, name);
      }
  }
#ifndef TETVDB_SANITIZED
  EXPECT_LT(peakMegabytes() - before, 500);
#endif
}

} // namespace
} // namespace tetvdb
