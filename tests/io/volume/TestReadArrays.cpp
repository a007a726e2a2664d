// SPDX-License-Identifier: Apache-2.0
//
// The samples of tests/data/arrays hold 3 x 4 x 5 voxels of the value x + 10 y + 100 z
// (make_array_samples.py). tests/io/judge_arrays.py reads random arrays that other libraries wrote.
#include "FileBytes.h"
#include "TemporaryFolder.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/volume/arrays/TiffCodec.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

const fs::path kSamples = fs::path(TETVDB_TEST_DATA) / "arrays";

double sampleAt(int x, int y, int z) {
  return x + 10 * y + 100 * z;
}

// A .npy file of any bytes.
std::string npyBytes(const std::string& type, const std::string& shape, const void* values,
                     std::size_t bytes, bool fortran = false) {
  std::string header = "{'descr': '" + type +
                       "', 'fortran_order': " + (fortran ? "True" : "False") +
                       ", 'shape': " + shape + ", }";
  header += std::string(64 - (10 + header.size() + 1) % 64, ' ') + "\n";
  std::string text("\x93NUMPY\x01\x00", 8);
  text += static_cast<char>(header.size() & 0xff);
  text += static_cast<char>(header.size() >> 8);
  return text + header + std::string(static_cast<const char*>(values), bytes);
}

class ReadArrays : public ::testing::Test {
protected:
  Volume readBytes(const std::string& bytes, const ArrayInput& options = {},
                   const std::string& name = "a.npy") {
    const std::string path = folder / name;
    std::ofstream(path, std::ios::binary) << bytes;
    return readArrays(path, options, progress);
  }
  template <typename Number>
  Volume readNumbers(const std::string& type, const std::string& shape,
                     const std::vector<Number>& values, const ArrayInput& options = {}) {
    return readBytes(npyBytes(type, shape, values.data(), values.size() * sizeof(Number)), options);
  }
  Error failure(const std::string& bytes, const ArrayInput& options = {}) {
    try {
      readBytes(bytes, options);
    } catch (const Error& error) {
      return error;
    }
    return {Status::Ok, "", "nothing was thrown"};
  }

  TemporaryFolder folder;
  Progress progress;
};

template <typename GridT>
const GridT& only(const Volume& volume) {
  EXPECT_EQ(volume.grids().all.size(), 1U);
  const auto grid = openvdb::gridConstPtrCast<GridT>(volume.grids().all.front());
  if (!grid)
    throw std::logic_error("is of type " + volume.grids().all.front()->valueType());
  return *grid;
}

TEST_F(ReadArrays, SamplesOfEveryFormat) {
  std::set<std::string> formats;
  for (const auto& file : fs::directory_iterator(kSamples)) {
    const std::string path = file.path().string();
    if (file.path().filename() == "beside.raw") // the numbers of beside.nhdr
      continue;
    SCOPED_TRACE(path);
    const FileFormat format = volumeFormatOf(path);
    ASSERT_TRUE(can(formatOf(format), FormatUse::ReadArrays));
    formats.emplace(formatName(format));
    const Volume volume = readArrays(path, {}, progress);
    const std::vector<GridInfo> infos = describe(volume);
    ASSERT_EQ(infos.size(), 1U);
    EXPECT_EQ(infos[0].activeVoxels, 59U); // all but the first
    const openvdb::GridBase& grid = *volume.grids().all.front();
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = 0; z < 5; ++z) {
          const openvdb::Coord at(x, y, z);
          const double value =
              grid.isType<openvdb::Int32Grid>()
                  ? static_cast<const openvdb::Int32Grid&>(grid).tree().getValue(at)
                  : static_cast<double>(
                        dynamic_cast<const openvdb::FloatGrid&>(grid).tree().getValue(at));
          ASSERT_EQ(value, sampleAt(x, y, z)) << x << y << z;
        }
    const bool hasPlace = infos[0].transform.origin[0] == 1;
    EXPECT_EQ(infos[0].transform.origin, hasPlace ? Vec3d({1, 2, 3}) : Vec3d({0, 0, 0}));
    const bool hasSize = hasPlace || file.path().filename() == "imagej.tif";
    EXPECT_EQ(infos[0].transform.voxelSize, hasSize ? Vec3d({0.5, 1, 2}) : Vec3d({1, 1, 1}));
    EXPECT_EQ(hasPlace, format == FileFormat::Nrrd || format == FileFormat::Nhdr ||
                            format == FileFormat::Nifti || format == FileFormat::MetaImage ||
                            format == FileFormat::Vti || format == FileFormat::VtkImage);
  }
  // .raw and .binvox files have no sample: tests/cli/test_arrays.py writes them.
  EXPECT_EQ(formats.size(), 9U);
}

TEST_F(ReadArrays, TypesOfGridsFollowThoseOfNumbers) {
  const std::vector<std::uint8_t> bits{0, 1, 1, 0, 1, 0, 0, 1};
  EXPECT_EQ(only<openvdb::BoolGrid>(readNumbers("|b1", "(2, 2, 2)", bits)).activeVoxelCount(), 4U);
  EXPECT_EQ(only<openvdb::BoolGrid>(readNumbers("|u1", "(2, 2, 2)", bits)).getName(), "mask");
  const std::vector<std::uint8_t> bytes{0, 1, 2, 0, 255, 0, 0, 1};
  EXPECT_EQ(
      only<openvdb::FloatGrid>(readNumbers("|u1", "(2, 2, 2)", bytes)).tree().getValue({1, 0, 0}),
      255.0F);
  const std::vector<std::int64_t> wide{0, 1, -(std::int64_t(1) << 62), 0, 5, 0, 0, 1};
  EXPECT_EQ(
      only<openvdb::Int64Grid>(readNumbers("<i8", "(2, 2, 2)", wide)).tree().getValue({0, 1, 0}),
      -(std::int64_t(1) << 62));
  std::vector<std::uint32_t> number{0, 7, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(
      only<openvdb::Int32Grid>(readNumbers("<u4", "(2, 2, 2)", number)).tree().getValue({0, 0, 1}),
      7);
  number[1] = 0xffffffffU;
  EXPECT_EQ(
      only<openvdb::Int64Grid>(readNumbers("<u4", "(2, 2, 2)", number)).tree().getValue({0, 0, 1}),
      4294967295);
  const std::vector<std::uint16_t> halves{0x3c00, 0xc000, 0, 0x3555, 0, 0, 0, 0}; // 1, -2, 0.333
  const Volume half = readNumbers("<f2", "(2, 2, 2)", halves);
  EXPECT_EQ(only<openvdb::FloatGrid>(half).tree().getValue({0, 0, 1}), -2.0F);
  EXPECT_NEAR(only<openvdb::FloatGrid>(half).tree().getValue({0, 1, 1}), 1 / 3.0F, 1e-4F);
  EXPECT_TRUE(half.grids().all.front()->saveFloatAsHalf());
  const std::vector<std::uint64_t> large{0, std::uint64_t(1) << 63, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(failure(npyBytes("<u8", "(2, 2, 2)", large.data(), 64)).status(), Status::Limit);
}

TEST_F(ReadArrays, ComponentsAreVectorsOrGridsOfTheirOwn) {
  std::vector<float> values(2 * 2 * 2 * 3);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(i);
  const Volume last = readNumbers("<f4", "(2, 2, 2, 3)", values);
  EXPECT_EQ(only<openvdb::Vec3SGrid>(last).tree().getValue({0, 1, 0}), openvdb::Vec3s(6, 7, 8));
  const Volume first = readNumbers("<f4", "(3, 2, 2, 2)", values); // ambiguous: the last axis
  EXPECT_EQ(first.grids().all.size(), 2U);
  values.resize(5 * 2 * 2 * 6);
  const Volume five = readNumbers("<f4", "(5, 2, 2, 6)", values);
  ASSERT_EQ(five.grids().all.size(), 5U);
  EXPECT_EQ(five.grids().all[3]->getName(), "density_3");
  values.resize(5 * 5 * 5);
  EXPECT_EQ(readNumbers("<f4", "(1, 1, 5, 5, 5)", values).grids().all.size(), 1U);
  EXPECT_EQ(failure(npyBytes("<f4", "(2, 4)", values.data(), 32)).status(), Status::Invalid);
}

TEST_F(ReadArrays, NaNIsInactiveAndCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values{nan, 1, 2, nan, 3, 4, 5, 6};
  const Volume volume = readNumbers("<f4", "(2, 2, 2)", values);
  EXPECT_EQ(volume.notNumbers, 2U);
  const auto& grid = only<openvdb::FloatGrid>(volume);
  EXPECT_EQ(grid.activeVoxelCount(), 6U);
  EXPECT_EQ(grid.tree().getValue({0, 0, 0}), 0.0F);
}

// A ball's distances, cut off at 3: 40^3 voxels with its middle at (20, 20, 20).
std::vector<float> ballDistances(float outside = 3) {
  std::vector<float> values;
  for (int x = 0; x < 40; ++x)
    for (int y = 0; y < 40; ++y)
      for (int z = 0; z < 40; ++z) {
        const float d = std::sqrt(static_cast<float>((x - 20) * (x - 20) + (y - 20) * (y - 20) +
                                                     (z - 20) * (z - 20))) -
                        12;
        values.push_back(std::clamp(d, -3.0F, outside));
      }
  return values;
}

TEST_F(ReadArrays, DistancesThatAreCutOffAreALevelSet) {
  const Volume volume = readNumbers("<f4", "(40, 40, 40)", ballDistances());
  const auto& grid = only<openvdb::FloatGrid>(volume);
  EXPECT_EQ(grid.getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid.getName(), "surface");
  EXPECT_EQ(grid.background(), 3.0F);
  std::size_t active = 0;
  const std::vector<float> values = ballDistances();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const openvdb::Coord at(static_cast<int>(i / 1600), static_cast<int>(i / 40 % 40),
                            static_cast<int>(i % 40));
    ASSERT_EQ(grid.tree().getValue(at), values[i]) << at;
    const bool isIn = std::abs(values[i]) < 3;
    ASSERT_EQ(grid.tree().isValueOn(at), isIn) << at;
    active += isIn;
  }
  EXPECT_EQ(grid.activeVoxelCount(), active);
  EXPECT_EQ(grid.tree().getValue({500, 0, 0}), 3.0F);
}

TEST_F(ReadArrays, OtherFloatsAreFog) {
  // Distances without a limit, and values that are cut off below alone.
  EXPECT_EQ(only<openvdb::FloatGrid>(readNumbers("<f4", "(40, 40, 40)", ballDistances(1e9F)))
                .getGridClass(),
            openvdb::GRID_FOG_VOLUME);
  std::vector<float> turned = ballDistances();
  for (float& value : turned)
    value = -value; // air of -3, as in a scan
  EXPECT_EQ(only<openvdb::FloatGrid>(readNumbers("<f4", "(40, 40, 40)", turned)).background(), 0);
  ArrayInput zero;
  zero.background = 0;
  const Volume fog = readNumbers("<f4", "(40, 40, 40)", ballDistances(), zero);
  EXPECT_EQ(only<openvdb::FloatGrid>(fog).getGridClass(), openvdb::GRID_FOG_VOLUME);
}

TEST_F(ReadArrays, OptionsReplaceWhatTheFileSays) {
  const std::vector<float> values{1, 2, 3, 4, 5, 6};
  ArrayInput options;
  options.zSlowest = true;
  options.voxelSize = Vec3d{0.5, 1, 2};
  options.origin = Vec3d{7, 8, 9};
  options.background = 6;
  const Volume volume = readNumbers("<f4", "(1, 2, 3)", values, options);
  const auto& grid = only<openvdb::FloatGrid>(volume);
  EXPECT_EQ(grid.tree().getValue({2, 0, 0}), 3.0F);
  EXPECT_EQ(grid.tree().getValue({0, 1, 0}), 4.0F);
  EXPECT_EQ(grid.activeVoxelCount(), 5U);
  EXPECT_EQ(grid.background(), 6.0F);
  EXPECT_EQ(grid.indexToWorld(openvdb::Coord(1, 1, 1)), openvdb::Vec3d(7.5, 9, 11));
  try {
    readArrays((kSamples / "raw.nrrd").string(), options, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Usage);
  }
  options.zSlowest = false;
  const Volume nrrd = readArrays((kSamples / "raw.nrrd").string(), options, progress);
  EXPECT_EQ(describe(nrrd)[0].transform.origin, Vec3d({7, 8, 9}));
}

TEST_F(ReadArrays, PiecesOfAnImageAreJoined) {
  const std::string text = R"(<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian">
  <ImageData WholeExtent="2 5 0 1 0 0" Origin="1 2 3" Spacing="1 1 2">
    <Piece Extent="2 4 0 1 0 0"><PointData><DataArray type="Int32" Name="a" format="ascii">
      1 2 3 4 5 6</DataArray></PointData><CellData><DataArray type="Float32" Name="c" format="ascii">
      0.5 1.5</DataArray><DataArray type="String" Name="s"/></CellData></Piece>
    <Piece Extent="4 5 0 1 0 0"><PointData><DataArray type="Int32" Name="a" format="ascii">
      3 7 6 8</DataArray></PointData><CellData><DataArray type="Float32" Name="c" format="ascii">
      2.5</DataArray></CellData></Piece>
  </ImageData></VTKFile>)";
  const Volume volume = readBytes(text, {}, "a.vti");
  ASSERT_EQ(volume.grids().all.size(), 2U);
  ASSERT_EQ(volume.unread.size(), 1U);
  const auto points = openvdb::gridPtrCast<openvdb::Int32Grid>(volume.grids().all[0]);
  const auto cells = openvdb::gridPtrCast<openvdb::FloatGrid>(volume.grids().all[1]);
  ASSERT_TRUE(points && cells);
  const int expected[2][4] = {{1, 2, 3, 7}, {4, 5, 6, 8}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(points->tree().getValue({x + 2, y, 0}), expected[y][x]);
  for (int x = 0; x < 3; ++x)
    EXPECT_EQ(cells->tree().getValue({x + 2, 0, 0}), static_cast<float>(x) + 0.5F);
  EXPECT_EQ(points->indexToWorld(openvdb::Coord(0, 0, 0)), openvdb::Vec3d(1, 2, 3));
  EXPECT_EQ(cells->indexToWorld(openvdb::Coord(0, 0, 0)), openvdb::Vec3d(1.5, 2.5, 4));
  std::string gap = text;
  gap.replace(gap.find("4 5 0 1 0 0"), 11, "5 6 0 1 0 0");
  EXPECT_THROW(readBytes(gap, {}, "a.vti"), Error);
}

// "TIFF Revision 6.0", section 9, has this example.
TEST(TiffCodec, PackBitsOfTheSpecification) {
  const unsigned char packed[] = {0xfe, 0xaa, 0x02, 0x80, 0x00, 0x2a, 0xfd, 0xaa,
                                  0x03, 0x80, 0x00, 0x2a, 0x22, 0xf7, 0xaa};
  const unsigned char bytes[] = {0xaa, 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0xaa, 0xaa,
                                 0xaa, 0xaa, 0x80, 0x00, 0x2a, 0x22, 0xaa, 0xaa,
                                 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa, 0xaa};
  const std::string_view from(reinterpret_cast<const char*>(packed), sizeof packed);
  EXPECT_EQ(tiff::decompress(from, tiff::kPackBits, sizeof bytes, "a"),
            std::string(reinterpret_cast<const char*>(bytes), sizeof bytes));
  EXPECT_THROW(tiff::decompress(from, tiff::kPackBits, sizeof bytes + 1, "a"), Error);
  EXPECT_THROW(tiff::decompress(from.substr(0, 5), tiff::kPackBits, sizeof bytes, "a"), Error);
}

// By the specification's algorithm, with the strings themselves as a table.
std::string lzwPacked(const std::string& bytes) {
  std::string packed;
  std::uint32_t word = 0;
  int bits = 0;
  std::map<std::string, int> table;
  const auto reset = [&] {
    table.clear();
    for (int i = 0; i < 256; ++i)
      table[std::string(1, static_cast<char>(i))] = i;
  };
  int next = 258;
  const auto put = [&](int code) {
    const int length = next > 2047 ? 12 : next > 1023 ? 11 : next > 511 ? 10 : 9;
    word = word << length | static_cast<std::uint32_t>(code);
    for (bits += length; bits >= 8; bits -= 8)
      packed += static_cast<char>(word >> (bits - 8) & 0xff);
  };
  reset();
  put(256);
  std::string last;
  for (const char c : bytes) {
    if (table.count(last + c) != 0) {
      last += c;
      continue;
    }
    put(table[last]);
    table[last + c] = next++;
    if (next == 4095) {
      put(256);
      reset();
      next = 258;
    }
    last = std::string(1, c);
  }
  if (!last.empty()) {
    put(table[last]);
    ++next;
  }
  put(257);
  if (bits > 0)
    packed += static_cast<char>(word << (8 - bits) & 0xff);
  return packed;
}

TEST(TiffCodec, LzwOfAllLengthsOfCodes) {
  std::mt19937 random(3);
  for (const std::size_t size : {1U, 2U, 200U, 700U, 3000U, 20000U, 100000U})
    for (const unsigned letters : {1U, 2U, 5U, 256U}) {
      std::string bytes;
      for (std::size_t i = 0; i < size; ++i)
        bytes += static_cast<char>(random() % letters);
      ASSERT_EQ(tiff::decompress(lzwPacked(bytes), tiff::kLzw, size, "a"), bytes)
          << size << " of " << letters;
    }
}

// Damaged files end in an Error, or in a volume.
TEST_F(ReadArrays, Mutations) {
  std::mt19937 random(20);
  for (const auto& file : fs::directory_iterator(kSamples)) {
    const std::string whole = test::fileBytes(file.path().string());
    for (int i = 0; i < 300; ++i) {
      std::string bytes = whole;
      const auto place = [&] { return random() % bytes.size(); };
      if (i % 4 == 0)
        bytes.resize(place());
      for (std::size_t n = random() % 5; n > 0 && !bytes.empty(); --n)
        bytes[place()] = static_cast<char>(random());
      if (const std::size_t at = bytes.find_first_of("0123456789", bytes.size() / 4);
          i % 3 == 0 && at != bytes.npos)
        bytes.replace(at, 1, i % 2 == 0 ? "4294967295" : "-7");
      try {
        describe(readBytes(bytes, {}, "mutant" + file.path().extension().string()));
      } catch (const Error& error) {
        ASSERT_TRUE(error.status() == Status::Invalid || error.status() == Status::Limit ||
                    error.status() == Status::Usage)
            << error.what();
      }
    }
  }
}

TEST_F(ReadArrays, DeclaredSizesAreNotBelieved) {
  const float one = 1;
  for (const char* shape : {"(1000000, 1000000, 1000000)", "(18446744073709551615, 2, 2)",
                            "(4294967296, 4294967296, 1)"}) {
    const Error error = failure(npyBytes("<f4", shape, &one, sizeof one));
    EXPECT_EQ(error.status(), Status::Invalid) << error.what();
  }
  EXPECT_EQ(failure(npyBytes("<f4", "(0, 5, 5)", &one, 0)).status(), Status::Invalid);
  std::string binvox = "#binvox 1\ndim 100000 100000 100000\ntranslate 0 0 0\nscale 1\ndata\n\1\1";
  EXPECT_THROW(readBytes(binvox, {}, "a.binvox"), Error);
}

} // namespace
} // namespace tetvdb
