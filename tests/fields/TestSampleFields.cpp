// SPDX-License-Identifier: Apache-2.0
#include "FieldOracle.h"
#include "Meshes.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/SampleFields.h"
#include "tetvdb/volume/Grids.h"

#include <gtest/gtest.h>
#include <limits>
#include <tbb/task_arena.h>

namespace {

using namespace tetvdb;
using On = Attribute::On;

template <typename T>
void attach(TetMesh& mesh, const std::string& name, On on, std::uint32_t components,
            std::vector<T> values) {
  mesh.attributes.push_back({name, on, components, std::move(values)});
}

// Arrays of every kind, with values that have nothing to do with positions.
TetMesh withArrays(TetMesh mesh, std::uint64_t seed) {
  meshes::Random random(seed);
  std::vector<double> temperature;
  std::vector<float> velocity, stress;
  std::vector<std::int32_t> kind, label;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    temperature.push_back(random.between(-40, 1200));
    label.push_back(static_cast<std::int32_t>(random.below(1000)));
    for (int k = 0; k < 3; ++k)
      velocity.push_back(static_cast<float>(random.between(-3, 3)));
  }
  for (std::size_t i = 0; i < mesh.cellCount; ++i) {
    kind.push_back(static_cast<std::int32_t>(random.below(5)));
    for (int k = 0; k < 6; ++k)
      stress.push_back(static_cast<float>(random.between(-2e8, 2e8)));
  }
  attach(mesh, "temperature", On::Points, 1, std::move(temperature));
  attach(mesh, "velocity", On::Points, 3, std::move(velocity));
  attach(mesh, "label", On::Points, 1, std::move(label));
  attach(mesh, "kind", On::Cells, 1, std::move(kind));
  attach(mesh, "stress", On::Cells, 6, std::move(stress));
  return mesh;
}

struct Sampled {
  Volume volume;
  Report report;
  SnapCounts counts;
};

Sampled sample(const TetMesh& mesh, const FieldOptions& wanted,
               const GridTransform& transform = {{1, 1, 1}, {0, 0, 0}}, bool allowEmpty = true) {
  Sampled result;
  Progress progress;
  const auto fields = resolveFields(mesh, wanted, result.report);
  SampleOptions options;
  options.allowEmpty = allowEmpty;
  result.counts =
      sampleFields(mesh, transform, fields, options, result.volume, result.report, progress);
  return result;
}

FieldOptions named(const std::vector<std::string>& names) {
  FieldOptions options;
  for (const std::string& name : names)
    options.requests.push_back({"", name, FieldPart::Whole, ""});
  return options;
}

template <typename Grid>
const Grid& grid(const Sampled& s, std::size_t i) {
  return *openvdb::gridConstPtrCast<Grid>(s.volume.grids().all[i]);
}

openvdb::Coord coord(const oracle::Voxel& v) {
  return {std::get<0>(v), std::get<1>(v), std::get<2>(v)};
}

// Every voxel of every kind of array against the oracle.
void expectOracle(const TetMesh& mesh, const GridTransform& transform = {{1, 1, 1}, {0, 0, 0}}) {
  const Sampled s =
      sample(mesh, named({"temperature", "velocity", "label", "kind", "stress"}), transform);
  const auto expected = oracle::voxels(mesh, transform);
  for (const auto& grid : s.volume.grids().all)
    ASSERT_EQ(grid->activeVoxelCount(), expected.size()) << grid->getName();
  ASSERT_GT(expected.size(), 0u);
  ASSERT_EQ(s.volume.grids().all.size(), 10u); // a symmetric tensor has six components
  const auto temperature = grid<openvdb::FloatGrid>(s, 0).getConstAccessor();
  const auto velocity = grid<openvdb::Vec3SGrid>(s, 1).getConstAccessor();
  const auto label = grid<openvdb::Int32Grid>(s, 2).getConstAccessor();
  const auto kind = grid<openvdb::Int32Grid>(s, 3).getConstAccessor();
  const auto yz = grid<openvdb::FloatGrid>(s, 8).getConstAccessor();
  EXPECT_EQ(grid<openvdb::FloatGrid>(s, 8).getName(), "stress.yz");
  const auto& arrays = mesh.attributes;
  for (const auto& each : expected) {
    const auto& voxel = each.first; // lambdas cannot refer to structured bindings
    const auto& owner = each.second;
    const openvdb::Coord c = coord(voxel);
    const auto at = [&](std::size_t array, std::uint32_t component) {
      return oracle::interpolated(mesh, transform, owner.tet, voxel, arrays[array], component);
    };
    ASSERT_TRUE(temperature.isValueOn(c)) << c;
    // Rounding to float, and weights good to 2^-30.
    ASSERT_NEAR(temperature.getValue(c), at(0, 0), 1200 * 1.3e-7) << c;
    for (std::uint32_t k = 0; k < 3; ++k)
      ASSERT_NEAR(velocity.getValue(c)[static_cast<int>(k)], at(1, k), 3 * 1.3e-7) << c;
    const auto w = oracle::weights(mesh, transform, owner.tet, voxel);
    bool fits = false; // several corners may be equally near
    for (std::size_t i = 0; i < 4; ++i)
      if (w[i] > *std::max_element(w.begin(), w.end()) - 1e-9L)
        fits = fits || label.getValue(c) ==
                           static_cast<int>(arrays[2].number(mesh.tets[4 * owner.tet + i]));
    ASSERT_TRUE(fits) << c;
    ASSERT_EQ(kind.getValue(c), static_cast<int>(arrays[3].number(owner.tet))) << c;
    ASSERT_EQ(yz.getValue(c), static_cast<float>(arrays[4].number(owner.tet, 4))) << c;
  }
}

TEST(SampleFields, JitteredBlock) {
  expectOracle(withArrays(
      meshes::scaled(meshes::jittered(meshes::kuhnGrid(4, 3, 5), 0.25, 1), 3.7, {-5, 2, 0.3}), 2));
}

TEST(SampleFields, EveryCentreOnFacesEdgesAndVertices) {
  expectOracle(withArrays(meshes::scaled(meshes::kuhnGrid(4, 4, 4), 3), 3));
}

TEST(SampleFields, TetsSmallerThanVoxels) {
  expectOracle(
      withArrays(meshes::scaled(meshes::jittered(meshes::kuhnGrid(24, 24, 24), 0.2, 4), 0.4), 5));
}

TEST(SampleFields, OverlappingFlippedAndFlatTets) {
  expectOracle(withArrays(meshes::soup(60, 30, 8, 6, 5), 7));
}

// Doubles alone would give weights that are noise.
TEST(SampleFields, Slivers) {
  for (const double height : {1e-3, 1e-5}) {
    const TetMesh thin =
        meshes::mapped(meshes::jittered(meshes::kuhnGrid(4, 4, 1), 0.2, 8, true), [&](Vec3d p) {
          return Vec3d{6 * p[0] + 0.1, 6 * p[1] + 0.1, 3 + height * (p[2] - 0.4)};
        });
    expectOracle(withArrays(thin, 9));
  }
}

TEST(SampleFields, VoxelsThatAreNoCubesAndAnOrigin) {
  expectOracle(withArrays(meshes::jittered(meshes::kuhnGrid(4, 4, 4), 0.2, 10), 11),
               {{0.2, 0.35, 0.6}, {0.11, -3, 0.017}});
}

TEST(SampleFields, LinearFieldsAreReproduced) {
  const GridTransform transform{{0.03, 0.03, 0.03}, {0, 0, 0}};
  TetMesh mesh = meshes::jittered(meshes::kuhnGrid(3, 3, 3), 0.3, 12);
  const auto linear = [](double x, double y, double z) { return 300 + 2 * x - 7 * y + 0.5 * z; };
  std::vector<double> values;
  for (const Vec3d& p : mesh.points)
    values.push_back(linear(p[0], p[1], p[2]));
  attach(mesh, "T", On::Points, 1, std::move(values));
  const Sampled s = sample(mesh, named({"T"}), transform);
  std::size_t count = 0;
  for (auto it = grid<openvdb::FloatGrid>(s, 0).cbeginValueOn(); it; ++it, ++count) {
    ASSERT_TRUE(it.isVoxelValue());
    const openvdb::Coord c = it.getCoord();
    const double expected = linear(0.03 * c.x(), 0.03 * c.y(), 0.03 * c.z());
    // Half a unit in the last place of a float, and the snapping of 2^-21 voxel.
    ASSERT_NEAR(*it, expected, 321 * 0x1p-24 + 8 * 0.03 * 0x1p-20) << c;
  }
  EXPECT_EQ(count, 100u * 100 * 100);
}

TEST(SampleFields, ConstantsStayConstantAndBecomeTiles) {
  TetMesh mesh = meshes::scaled(meshes::jittered(meshes::kuhnGrid(4, 4, 4), 0.2, 13), 16);
  attach(mesh, "p", On::Points, 1, std::vector<double>(mesh.points.size(), 0.1));
  const Sampled s = sample(mesh, named({"p"}));
  const auto& p = grid<openvdb::FloatGrid>(s, 0);
  EXPECT_EQ(p.activeVoxelCount(), 64u * 64 * 64);
  EXPECT_EQ(p.tree().leafCount(), 0u);
  for (auto it = p.cbeginValueOn(); it; ++it)
    ASSERT_EQ(*it, 0.1f);
}

// Nodes of 128^3 that lie in one tet: voxels x, y, z >= 0 with x + y + z <= 518.
TEST(SampleFields, NodesWithinOneTet) {
  TetMesh mesh;
  mesh.points = {{-0.5, -0.5, -0.5}, {519.5, -0.5, -0.5}, {-0.5, 519.5, -0.5}, {-0.5, -0.5, 519.5}};
  mesh.tets = {0, 1, 2, 3};
  mesh.cellCount = 1;
  attach(mesh, "x", On::Points, 1, std::vector<double>{-0.5, 519.5, -0.5, -0.5});
  attach(mesh, "c", On::Cells, 1, std::vector<float>{2.5f});
  const Sampled s = sample(mesh, named({"x", "c"}));
  const auto& x = grid<openvdb::FloatGrid>(s, 0);
  const auto& c = grid<openvdb::FloatGrid>(s, 1);
  constexpr std::uint64_t count = 521ull * 520 * 519 / 6;
  EXPECT_EQ(c.activeVoxelCount(), count);
  EXPECT_EQ(x.activeVoxelCount(), count);
  std::size_t nodeTiles = 0;
  for (auto it = c.cbeginValueOn(); it; ++it)
    nodeTiles += it.getVoxelCount() == 128u * 128 * 128;
  EXPECT_GT(nodeTiles, 0u);
  for (auto leaf = x.tree().cbeginLeaf(); leaf; ++leaf)
    for (auto it = leaf->cbeginValueOn(); it; ++it) {
      const openvdb::Coord at = it.getCoord();
      ASSERT_LE(at.x() + at.y() + at.z(), 518);
      ASSERT_NEAR(*it, at.x(), 520 * 1.3e-7) << at;
    }
}

TEST(SampleFields, SameBitsForAnyThreadsAndOrder) {
  const TetMesh mesh =
      withArrays(meshes::scaled(meshes::jittered(meshes::kuhnGrid(9, 9, 9), 0.2, 14), 20), 15);
  FieldOptions all;
  all.all = true;
  const std::string once = hash(sample(mesh, all).volume);
  for (const int threads : {1, 2, 7}) {
    tbb::task_arena arena(threads);
    EXPECT_EQ(arena.execute([&] { return hash(sample(mesh, all).volume); }), once) << threads;
  }
  std::vector<std::uint32_t> tetOf;
  TetMesh other = meshes::shuffled(mesh, 16, &tetOf);
  // The arrays in the new order: points are found by their position.
  std::map<Vec3d, std::size_t> oldPoint;
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    oldPoint[mesh.points[i]] = i;
  for (const Attribute& array : mesh.attributes) {
    Attribute moved = array;
    std::visit(
        [&](auto& values) {
          using Values = std::decay_t<decltype(values)>;
          const Values old = std::get<Values>(array.values);
          const std::size_t count = values.size() / array.components;
          for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < array.components; ++k)
              values[i * array.components + k] =
                  old[(array.on == On::Points ? oldPoint.at(other.points[i]) : tetOf[i]) *
                          array.components +
                      k];
        },
        moved.values);
    other.attributes.push_back(std::move(moved));
  }
  EXPECT_EQ(hash(sample(other, all).volume), once);
}

TEST(SampleFields, WhatIsNotFiniteIsKeptOutAndCounted) {
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(3, 3, 3), 8);
  std::vector<double> values(mesh.points.size(), 1);
  values[0] = std::numeric_limits<double>::quiet_NaN(); // the corner at the origin
  std::vector<float> cells(mesh.cellCount, 2);
  cells.back() = std::numeric_limits<float>::infinity();
  attach(mesh, "T", On::Points, 1, std::move(values));
  attach(mesh, "q", On::Cells, 1, std::move(cells));
  const Sampled s = sample(mesh, named({"T", "q"}));
  const auto expected = oracle::voxels(mesh, {{1, 1, 1}, {0, 0, 0}});
  std::size_t out[2] = {0, 0};
  for (const auto& [voxel, owner] : expected) {
    const std::uint32_t* v = mesh.tets.data() + 4 * owner.tet;
    const bool bad[2] = {v[0] == 0 || v[1] == 0 || v[2] == 0 || v[3] == 0,
                         owner.tet + 1 == mesh.tetCount()};
    for (std::size_t i = 0; i < 2; ++i) {
      out[i] += bad[i];
      ASSERT_EQ(grid<openvdb::FloatGrid>(s, i).tree().isValueOn(coord(voxel)), !bad[i]);
      ASSERT_EQ(grid<openvdb::FloatGrid>(s, i).tree().getValue(coord(voxel)),
                bad[i] ? 0.0f : float(i + 1));
    }
  }
  EXPECT_GT(out[0], 0u);
  EXPECT_GT(out[1], 0u);
  std::string told;
  for (const Warning& warning : s.report.warnings)
    told += warning.text + "\n";
  EXPECT_NE(told.find("no finite value at 1 points"), std::string::npos) << told;
  EXPECT_NE(told.find(std::to_string(out[0]) + " voxels of 'T'"), std::string::npos) << told;
  EXPECT_NE(told.find(std::to_string(out[1]) + " voxels of 'q'"), std::string::npos) << told;
}

TEST(SampleFields, ClampRemapAndBackground) {
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(2, 2, 2), 8);
  std::vector<double> values;
  std::vector<float> vectors;
  for (const Vec3d& p : mesh.points) {
    values.push_back(100 + 10 * p[0]); // 100 to 260
    vectors.insert(vectors.end(), {float(p[0]), 0, 0});
  }
  attach(mesh, "T", On::Points, 1, values);
  attach(mesh, "U", On::Points, 1, values);
  attach(mesh, "vel", On::Points, 3, vectors);
  FieldOptions wanted = named({"T", "U", "vel"});
  wanted.remap = {{"", 0, 1}, {"vel", 0, 2}};
  wanted.clamp = {{"U", 140, 180}};
  wanted.background = {{"T", -7}};
  const Sampled s = sample(mesh, wanted);
  const auto& t = grid<openvdb::FloatGrid>(s, 0);
  const auto& u = grid<openvdb::FloatGrid>(s, 1);
  const auto& vel = grid<openvdb::Vec3SGrid>(s, 2);
  EXPECT_EQ(t.background(), -7.0f);
  EXPECT_EQ(u.background(), 0.0f);
  // T's range is that of the points; x = i at voxel i.
  for (int x = 0; x < 16; ++x) {
    const openvdb::Coord c(x, 3, 5);
    EXPECT_NEAR(t.tree().getValue(c), x / 16.0, 1e-6);
    const double clamped = std::min(std::max(100.0 + 10 * x, 140.0), 180.0);
    EXPECT_NEAR(u.tree().getValue(c), (clamped - 140) / 40, 1e-6);
    EXPECT_NEAR(vel.tree().getValue(c)[0], x * 2 / 16.0, 1e-6);
  }
  const auto number = [](const openvdb::GridBase& grid, const char* name) {
    return grid.metaValue<double>(name);
  };
  EXPECT_EQ(number(t, "original_min"), 100);
  EXPECT_EQ(number(t, "original_max"), 260);
  EXPECT_NEAR(260 * number(t, "scale") + number(t, "offset"), 1, 1e-12);
  EXPECT_EQ(number(u, "clamp_max"), 180);
  EXPECT_EQ(number(vel, "original_max"), 16);
  EXPECT_EQ(t.metaValue<std::string>("source_array"), "T");
  EXPECT_EQ(t.getGridClass(), openvdb::GRID_FOG_VOLUME);
}

TEST(SampleFields, InvariantsOfInterpolatedTuples) {
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 6);
  std::vector<double> v, s;
  for (const Vec3d& p : mesh.points) {
    v.insert(v.end(), {p[0], -p[1], 2});
    s.insert(s.end(), {p[0], 0, 0, 0, 0, 0}); // uniaxial: its equivalent is |x|
  }
  attach(mesh, "v", On::Points, 3, std::move(v));
  attach(mesh, "s", On::Points, 6, std::move(s));
  FieldOptions wanted;
  wanted.requests = {{"speed", "v", FieldPart::Magnitude, ""},
                     {"vonMises", "s", FieldPart::Mises, ""},
                     {"vy", "v", FieldPart::Component, "y"},
                     {"p1", "s", FieldPart::Principal1, ""}};
  const Sampled sampled = sample(mesh, wanted);
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y) {
      const openvdb::Coord c(x, y, 2);
      const auto at = [&](std::size_t i) {
        return grid<openvdb::FloatGrid>(sampled, i).tree().getValue(c);
      };
      EXPECT_NEAR(at(0), std::sqrt(x * x + y * y + 4.0), 1e-6);
      EXPECT_NEAR(at(1), x, 1e-6);
      EXPECT_NEAR(at(2), -y, 1e-6);
      EXPECT_NEAR(at(3), x, 1e-6);
    }
}

TEST(SampleFields, VectorsTurnWithThePoints) {
  TetMesh mesh = meshes::scaled(meshes::kuhnGrid(1, 1, 1), 4);
  std::vector<float> v, colour;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    v.insert(v.end(), {1, 2, 3});
    colour.insert(colour.end(), {1, 2, 3});
  }
  attach(mesh, "v", On::Points, 3, std::move(v));
  attach(mesh, "Cd", On::Points, 3, std::move(colour));
  FieldOptions wanted = named({"v", "Cd"});
  wanted.turnVectors = true;
  const Sampled s = sample(mesh, wanted);
  const openvdb::Coord c(1, 1, 1);
  EXPECT_EQ(grid<openvdb::Vec3SGrid>(s, 0).tree().getValue(c), openvdb::Vec3s(1, 3, -2));
  EXPECT_EQ(grid<openvdb::Vec3SGrid>(s, 1).tree().getValue(c), openvdb::Vec3s(1, 2, 3));
}

TEST(SampleFields, NothingInsideIsAnError) {
  TetMesh mesh = withArrays(meshes::scaled(meshes::kuhnGrid(1, 1, 1), 0.2, {0.4, 0.4, 0.4}), 17);
  EXPECT_EQ(sample(mesh, named({"kind"})).volume.grids().all[0]->activeVoxelCount(), 0u);
  try {
    sample(mesh, named({"kind"}), {{1, 1, 1}, {0, 0, 0}}, false);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Invalid);
  }
}

TEST(SampleFields, TooLittleMemoryIsRefused) {
  const TetMesh mesh = withArrays(meshes::scaled(meshes::kuhnGrid(2, 2, 2), 100), 18);
  Report report;
  Progress progress;
  Volume volume;
  const auto fields = resolveFields(mesh, named({"temperature"}), report);
  SampleOptions options;
  options.maxMemory = 1 << 20;
  try {
    sampleFields(mesh, {{1, 1, 1}, {0, 0, 0}}, fields, options, volume, report, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), Status::Limit);
  }
}

} // namespace
