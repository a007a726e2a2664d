// SPDX-License-Identifier: Apache-2.0
//
// Whether a file read part by part is the file read as a whole.
#pragma once

#include "TemporaryFolder.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/SpoolCells.h"
#include "tetvdb/mesh/SplitCells.h"

#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace tetvdb::test {

template <typename T>
std::vector<T> valuesOf(const FileSpool& spool) {
  const T* all = spool.as<T>();
  return {all, all + spool.count<T>()};
}

inline void expectSpooledSame(const std::string& path, const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  Progress progress;
  Report report;
  const TetMesh whole =
      splitCells(readCells(path, options, report, progress), {}, report, progress);
  SpooledMesh spooled(folder.path().string());
  FileFormat format = FileFormat::Unknown;
  spoolCells(path, options, spooled, format, report, progress);
  EXPECT_EQ(valuesOf<Vec3d>(spooled.points), whole.points);
  EXPECT_EQ(valuesOf<std::uint32_t>(spooled.tets), whole.tets);
  EXPECT_EQ(valuesOf<std::uint32_t>(spooled.cellOfTet), whole.cellOfTet);
  EXPECT_EQ(spooled.cellCount(), whole.cellCount);
  EXPECT_EQ(spooled.hasShapes(), !whole.curved.empty());
  EXPECT_EQ(valuesOf<std::int32_t>(spooled.regions), whole.regions);
  ASSERT_EQ(spooled.arrays.size(), whole.attributes.size());
  for (const Attribute& array : whole.attributes) {
    const SpooledArray* same = spooled.find(array.name, array.on);
    ASSERT_NE(same, nullptr) << array.name;
    EXPECT_EQ(same->components, array.components);
    EXPECT_EQ(same->type, array.values.index());
    const auto [bytes, size] = bytesOf(array.values);
    ASSERT_EQ(same->values->size(), size);
    EXPECT_EQ(std::memcmp(same->values->as<char>(), bytes, size), 0) << array.name;
  }
  EXPECT_EQ(spooled.unread.size(), whole.unread.size());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())); // its files have no names
}

} // namespace tetvdb::test
