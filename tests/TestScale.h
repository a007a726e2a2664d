// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace tetvdb::test {

/// How much more than usual tests may look at: 1, or what TETVDB_TEST_SCALE says
/// (scripts/weekly.sh: 4).
inline int scale() {
  const char* said = std::getenv("TETVDB_TEST_SCALE");
  return said == nullptr ? 1 : std::atoi(said);
}

} // namespace tetvdb::test
