// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <utility>
#include <vector>

namespace tetvdb::test {

/// How much longer than usual tests may take: sanitizers slow the program.
#ifdef TETVDB_SANITIZED
constexpr int kSlower = 10;
#else
constexpr int kSlower = 1;
#endif

/// How much more than usual tests may look at: 1, or what TETVDB_TEST_SCALE says
/// (scripts/weekly.sh: 4).
inline int scale() {
  const char* said = std::getenv("TETVDB_TEST_SCALE");
  return said == nullptr ? 1 : std::atoi(said);
}

/// All of these numbers of threads, or the last one where tests are not scaled up. What is compared
/// with theirs is made by as many threads as there are processors, which are seldom 3 or 7.
inline std::vector<int> threadCounts(std::vector<int> counts) {
  return scale() > 1 ? std::move(counts) : std::vector<int>{counts.back()};
}

} // namespace tetvdb::test
