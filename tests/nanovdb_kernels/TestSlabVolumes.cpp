// SPDX-License-Identifier: Apache-2.0
//
// Coverage whose slabs the device's twin adds up, against the CPU's.
#include "CoverageCases.h"
#include "nanovdb_kernels/DeviceVoxelizer.h"

#include <gtest/gtest.h>

namespace {

using namespace tetvdb;

TEST(SlabVolumes, CoverageIsThatOfTheCpu) {
  nano::HostTwin twin;
  for (const CoverageCase& c : coverageCases(false)) {
    std::uint64_t leaves = 0;
    const Covered there =
        coveredWith(c, [&](const nano::CoverageJob& job, nano::CoverageReceiver& receiver) {
          leaves = twin.coverage(job, receiver);
        });
    const Covered here = coveredWith(c, nullptr);
    EXPECT_TRUE(there == here) << c.name;
    EXPECT_EQ(leaves > 0, !c.faces.faces.empty()) << c.name;
  }
}

TEST(SlabVolumes, WhatAReceiverThrowsEndsTheRun) {
  struct Refusing final : nano::CoverageReceiver {
    void take(const nano::CoverageBatch&) override { throw 7; }
  } refusing;
  nano::HostTwin twin;
  const CoverageCase c = coverageCases(true).front();
  EXPECT_THROW(coveredWith(c, [&](const nano::CoverageJob& job,
                                  nano::CoverageReceiver&) { twin.coverage(job, refusing); }),
               int);
}

} // namespace
