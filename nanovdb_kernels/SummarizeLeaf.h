// SPDX-License-Identifier: Apache-2.0
//
// What a leaf's values sum up to, by a team.
#pragma once

#include "GridParts.h"

namespace tetvdb::nano {

/// A leaf that a team shares.
template <typename V>
struct SharedLeaf {
  V value[512];
  u64 active[8]; ///< word x, bit 8 y + z
  TeamExtremes<V> extremes;
  double sum[kParts], mean;
};

// As LeafSummary has them.
TETVDB_HD inline void setExtremes(const TeamExtremes<u32>& all, LeafSummary& summary) {
  summary.min = all.least;
  summary.max = all.most;
}
TETVDB_HD inline void setExtremes(const TeamExtremes<Vector>& all, LeafSummary& summary) {
  summary.min = static_cast<i32>(static_cast<u32>(all.least));
  summary.max = static_cast<i32>(0xFFFFFFFFu - static_cast<u32>(all.most));
}

/// Called by the whole team, which has met since values, active voxels and extremes were set; the
/// first member receives the summary.
template <typename V>
TETVDB_HD void summarize(const Team& team, SharedLeaf<V>& s, bool isFloat, LeafSummary& summary) {
  constexpr int kOfPart = 512 / kParts;
  const auto forPart = [&](int p, const auto& f) {
    for (int n = p * kOfPart; n < (p + 1) * kOfPart; ++n)
      if ((s.active[n >> 6] >> (n & 63) & 1) != 0)
        f(statisticOf(s.value[n], isFloat));
  };
  for (int p = team.rank(); p < kParts; p += team.size()) {
    double sum = 0;
    forPart(p, [&](double v) { sum += v; });
    s.sum[p] = sum;
  }
  team.sync();
  const u64 count = countVoxels(s.active);
  if (team.rank() == 0) {
    double sum = 0;
    for (int p = 0; p < kParts; ++p)
      sum += s.sum[p];
    s.mean = count == 0 ? 0 : sum / static_cast<double>(count);
  }
  team.sync();
  for (int p = team.rank(); p < kParts; p += team.size()) {
    double squares = 0;
    forPart(p, [&](double v) { squares += (v - s.mean) * (v - s.mean); });
    s.sum[p] = squares;
  }
  team.sync();
  if (team.rank() == 0) {
    double squares = 0;
    for (int p = 0; p < kParts; ++p)
      squares += s.sum[p];
    summary = {0, 0, static_cast<double>(count), s.mean, squares};
    setExtremes(s.extremes, summary);
  }
}

} // namespace tetvdb::nano
