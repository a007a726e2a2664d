// SPDX-License-Identifier: Apache-2.0
#include "FileBytes.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/module/FormatModule.h"

#include <gtest/gtest.h>
#include <string>

namespace tetvdb {
namespace {

/// Whether a shared object of that name is mapped into this process.
bool isLoaded(const std::string& name) {
  return test::fileBytes("/proc/self/maps").find(name) != std::string::npos;
}

// The library itself is linked with none of those that the module needs.
TEST(FormatModule, IsLoadedWhenAFileNeedsIt) {
  for (const char* name : {kFormatModule, "libhdf5", "libnetcdf", "libcgns", "libassimp"})
    EXPECT_FALSE(isLoaded(name)) << name;
  const std::string data = TETVDB_TEST_DATA;
  Report report;
  Progress progress;
  readCells(data + "/table.msh", {}, report, progress);
  EXPECT_FALSE(isLoaded(kFormatModule));
  EXPECT_GT(readCells(data + "/readers/block.vtkhdf", {}, report, progress).cellCount(), 0U);
  EXPECT_TRUE(isLoaded(kFormatModule));
  EXPECT_TRUE(isLoaded("libhdf5"));
}

} // namespace
} // namespace tetvdb
