// SPDX-License-Identifier: Apache-2.0
//
// The mesh of tests/data/make_vtk_variants.py as formulas, and damage for any reader's files.
#pragma once

#include "FileBytes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace tetvdb::test {

using Reader = CellMesh (*)(const Source&, const ReadOptions&, Report&, Progress&);

inline std::string dataPath(const std::string& name) {
  return std::string(TETVDB_TEST_DATA) + "/vtk/" + name;
}

/// Files of tests/data/vtk whose names begin and end as given, sorted.
inline std::vector<std::string> dataFiles(const std::string& begin, const std::string& end) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(dataPath(""))) {
    const std::string name = entry.path().filename().string();
    if (name.size() >= end.size() && name.compare(0, begin.size(), begin) == 0 &&
        name.compare(name.size() - end.size(), end.size(), end) == 0)
      found.push_back(name);
  }
  std::sort(found.begin(), found.end());
  EXPECT_FALSE(found.empty()) << begin << "*" << end;
  return found;
}

inline CellMesh read(Reader reader, const std::string& bytes, Report& report,
                     const std::string& path = "test", const ReadOptions& options = {}) {
  Progress progress;
  return reader({bytes, path}, options, report, progress);
}
inline CellMesh read(Reader reader, const std::string& bytes) {
  Report report;
  return read(reader, bytes, report);
}

/// The message of the Error(Invalid) that reading `bytes` throws.
inline std::string errorOf(Reader reader, const std::string& bytes) {
  try {
    read(reader, bytes);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

inline const Attribute* find(const CellMesh& mesh, const std::string& name, Attribute::On on) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.on == on)
      return &attribute;
  return nullptr;
}

inline const std::vector<Vec3d>& expectedPoints() {
  static const std::vector<Vec3d> points = {
      {0, 0, 0},     {1, 0, 0},      {1, 1, 0},         {0, 1, 0},          {0, 0, 1},
      {1, 0, 1},     {1, 1, 1},      {0, 1, 1},         {2, 0.5, 0},        {2, 0.5, 1},
      {0.5, 0.5, 2}, {3, 0, 0},      {3, 1, 0},         {2.5, 0.5, 1.5},    {2.5, 0.25, 0},
      {3, 0.5, 0},   {2.5, 0.75, 0}, {2.25, 0.5, 0.75}, {2.75, 0.25, 0.75}, {2.75, 0.75, 0.75}};
  return points;
}

/// Whether `mesh` is the mixed mesh with its attributes.
inline void expectMixedMesh(const CellMesh& mesh) {
  EXPECT_EQ(mesh.points, expectedPoints());
  const std::vector<std::uint32_t> nodes = {1, 8,  2,  9,                           // tetra
                                            0, 1,  2,  3,  4,  5,  6,  7,           // hexahedron
                                            1, 2,  8,  5,  6,  9,                   // wedge
                                            4, 5,  6,  7,  10,                      // pyramid
                                            8, 11, 12, 13, 8,  11, 12, 9,           // two tetra
                                            0, 1,  3,  2,  4,  5,  7,  6,           // voxel
                                            8, 11, 12, 13, 14, 15, 16, 17, 18, 19}; // tetra10
  EXPECT_EQ(mesh.nodes, nodes);

  struct Run {
    CellType type;
    std::uint32_t nodes;
    std::size_t count;
    bool quadratic;
  };
  const std::vector<Run> runs = {
      {CellType::Flat, 0, 1, false},  {CellType::Tetra, 4, 1, false},
      {CellType::Flat, 0, 1, false},  {CellType::Hexahedron, 8, 1, false},
      {CellType::Wedge, 6, 1, false}, {CellType::Pyramid, 5, 1, false},
      {CellType::Tetra, 4, 2, false}, {CellType::Voxel, 8, 1, false},
      {CellType::Tetra, 10, 1, true}};
  ASSERT_EQ(mesh.runs.size(), runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_EQ(mesh.runs[i].type, runs[i].type) << i;
    EXPECT_EQ(mesh.runs[i].nodesPerCell, runs[i].nodes) << i;
    EXPECT_EQ(mesh.runs[i].count, runs[i].count) << i;
    EXPECT_EQ(mesh.runs[i].quadratic, runs[i].quadratic) << i;
  }

  const Attribute* t = find(mesh, "T", Attribute::On::Points);
  const Attribute* flow = find(mesh, "flow speed", Attribute::On::Points);
  ASSERT_TRUE(t && flow);
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(t->values));
  EXPECT_TRUE(std::holds_alternative<std::vector<double>>(flow->values));
  EXPECT_EQ(flow->components, 3u);
  ASSERT_EQ(t->size(), 20u);
  ASSERT_EQ(flow->size(), 20u);
  for (std::size_t i = 0; i < 20; ++i) {
    const auto n = static_cast<double>(i);
    EXPECT_EQ(t->number(i), n * 0.5 - 3);
    EXPECT_NEAR(flow->number(i, 0), n * 1.1, 1e-9);
    EXPECT_NEAR(flow->number(i, 1), n * -2.2, 1e-9);
    EXPECT_NEAR(flow->number(i, 2), n + 1e-9, 2e-9); // a text has fewer digits
  }
  const Attribute* material = find(mesh, "material", Attribute::On::Cells);
  const Attribute* bits = find(mesh, "bits", Attribute::On::Cells);
  ASSERT_TRUE(material && bits);
  ASSERT_EQ(material->size(), 10u);
  ASSERT_EQ(bits->size(), 10u);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_EQ(material->number(i), static_cast<double>(i / 3 + 1));
    EXPECT_EQ(bits->number(i), i % 3 == 0 ? 1 : 0);
  }
  for (const char* name :
       {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"}) {
    const Attribute* a = find(mesh, name, Attribute::On::Cells);
    ASSERT_TRUE(a) << name;
    const std::string text = name;
    EXPECT_EQ(a->values.index(), text.find("64") != text.npos || text == "uint32" ? 3u : 2u)
        << name;
    ASSERT_EQ(a->size(), 10u);
    for (std::size_t i = 0; i < 10; ++i)
      EXPECT_EQ(a->number(i), static_cast<double>(7 * i + 1)) << name;
  }
}

/// Every file cut off at some place is refused, unless the cut is between two sections of a legacy
/// file, which nothing announces.
inline void expectTruncatedIsRefused(Reader reader, const std::string& path) {
  const std::string whole = fileBytes(path);
  for (int percent = 0; percent <= 94; percent += 2) {
    const std::string cut = whole.substr(0, whole.size() * static_cast<std::size_t>(percent) / 100);
    const std::string rest = whole.substr(cut.size(), 11);
    if (rest.find("_DATA ") != rest.npos)
      continue;
    Report report;
    EXPECT_THROW(read(reader, cut, report, path), Error) << path << " at " << percent << " %";
  }
}

/// Damages the file in `rounds` ways: reading throws nothing but Error, soon, and without asking
/// for a gigabyte.
inline void expectDamageIsHarmless(Reader reader, const std::string& path, int rounds) {
  const std::string whole = fileBytes(path);
  ASSERT_FALSE(whole.empty());
#ifndef TETVDB_SANITIZED
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  rlimit limit = before;
  limit.rlim_cur = pages * 4096 + (std::size_t(1) << 30);
  setrlimit(RLIMIT_AS, &limit);
#endif
  std::mt19937 random(20240229);
  for (int round = 0; round < rounds; ++round) {
    std::string bytes = whole;
    const auto place = [&] { return random() % bytes.size(); };
    for (std::size_t flips = random() % 6; flips > 0; --flips)
      bytes[place()] = static_cast<char>(random());
    switch (random() % 6) {
    case 0:
      bytes.resize(place() + 1);
      break;
    case 1:
      bytes.erase(place(), random() % 16);
      break;
    case 2:
      bytes.insert(place(), whole.substr(place() % whole.size(), random() % 64));
      break;
    case 3: // a number becomes another
      for (std::size_t i = place(), last = std::min(i + 40, bytes.size()); i < last; ++i)
        if (bytes[i] >= '0' && bytes[i] <= '9') {
          bytes[i] = static_cast<char>('0' + random() % 10);
          break;
        }
      break;
    case 4: // a number becomes much larger
      for (std::size_t i = place(), last = std::min(i + 40, bytes.size()); i < last; ++i)
        if (bytes[i] >= '0' && bytes[i] <= '9') {
          bytes.insert(i, "999999999999", random() % 12);
          break;
        }
      break;
    default:
      break;
    }
    const auto start = std::chrono::steady_clock::now();
    try {
      Report report;
      read(reader, bytes, report, path);
    } catch (const Error& error) {
      EXPECT_GT(std::string(error.what()).size(), 10u);
    } catch (const std::exception& error) {
      ADD_FAILURE() << path << " in round " << round << ": " << error.what();
    }
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << path << round;
  }
#ifndef TETVDB_SANITIZED
  setrlimit(RLIMIT_AS, &before);
#endif
}

inline bool contains(const std::string& text, const std::string& what) {
  return text.find(what) != text.npos;
}

} // namespace tetvdb::test
