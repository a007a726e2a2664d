// SPDX-License-Identifier: Apache-2.0
//
// Coverage that the device's twin makes, against the CPU's.
#include "CoverageCases.h"
#include "nanovdb_kernels/DeviceVoxelizer.h"

#include <gtest/gtest.h>
#include <stdexcept>

namespace {

using namespace tetvdb;

TEST(CoverageGrid, IsThatOfTheCpu) {
  nano::HostTwin twin;
  for (const CoverageCase& c : coverageCases(false)) {
    const Covered there =
        coveredBy(c, [&](const nano::CoverageJob& job) { return twin.coverage(job); });
    const Covered here = coveredByCpu(c);
    EXPECT_EQ(there.hash, here.hash) << c.name;
    EXPECT_TRUE(there == here) << c.name << ": " << there.sum.filled << " and " << here.sum.filled;
  }
}

TEST(CoverageGrid, FacesThatDoNotCloseAreRefused) {
  CoverageCase open = coverageCases(true).front();
  open.faces.faces.pop_back();
  nano::HostTwin twin;
  const auto cover = [&] {
    coveredBy(open, [&](const nano::CoverageJob& job) { return twin.coverage(job); });
  };
  EXPECT_THROW(cover(), std::logic_error);
}

} // namespace
