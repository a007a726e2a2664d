// SPDX-License-Identifier: Apache-2.0
//
// The mesh of tests/data/make_reader_samples.py as formulas.
#pragma once

#include "io/MeshSamples.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/Source.h"

namespace tetvdb::test {

inline CellMesh readSample(ReadFunction read, const std::string& name,
                           const ReadOptions& options = {}, Report* report = nullptr) {
  const MappedFile file(dataFile("readers/" + name));
  Report own;
  Progress progress;
  return read(file.source(), options, report != nullptr ? *report : own, progress);
}

inline const Attribute& arrayNamed(const CellMesh& mesh, const std::string& name) {
  for (const Attribute& array : mesh.attributes)
    if (array.name == name)
      return array;
  throw std::runtime_error("there is no array " + name);
}

/// Whether `mesh` is the block `copies` times, each 3 further along x, with values on points that
/// are `offset` larger.
inline void expectBlocks(const CellMesh& mesh, std::size_t copies, const std::string& onPoints,
                         const std::string& onCells, double offset = 0, bool restarts = false) {
  ASSERT_EQ(mesh.points.size(), 27 * copies);
  const Attribute &t = arrayNamed(mesh, onPoints), &c = arrayNamed(mesh, onCells);
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    const auto p = static_cast<double>(i % 27);
    const double x = std::fmod(p, 3), y = std::fmod(std::floor(p / 3), 3), z = std::floor(p / 9);
    EXPECT_EQ(mesh.points[i], (Vec3d{x + 3.0 * static_cast<double>(i / 27), y, z})) << i;
    EXPECT_EQ(t.number(i), x + 10 * y + 100 * z + offset) << i;
  }
  ASSERT_EQ(mesh.cellCount(), 8 * copies);
  for (std::size_t i = 0; i < 8 * copies; ++i)
    EXPECT_EQ(c.number(i), 1.5 * static_cast<double>(restarts ? i % 8 : i) + offset) << i;
  EXPECT_NEAR(cellVolume(mesh), 8.0 * static_cast<double>(copies), 1e-12);
}

} // namespace tetvdb::test
