// SPDX-License-Identifier: Apache-2.0
//
// Runs a check for every line of a table in tests/corpus, made by an oracle of other means.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>

namespace tetvdb::test {

/// Calls compare(expected, path) for each line after the head of `table`, which must have `count`.
/// `Expected` has a member `file`, a path below `folder` in the corpus, and is read by operator>>.
/// Skips the test where the environment variable TETVDB_CORPUS does not name the corpus.
template <class Expected, class Compare>
void forEachExpected(const std::string& table, const std::string& folder, std::size_t count,
                     const Compare& compare) {
  const char* corpus = std::getenv("TETVDB_CORPUS");
  if (corpus == nullptr)
    GTEST_SKIP() << "TETVDB_CORPUS is not set";
  std::ifstream lines(TETVDB_TEST_DATA "/../corpus/" + table);
  std::string line;
  std::getline(lines, line);
  std::size_t found = 0;
  for (; std::getline(lines, line); ++found) {
    std::istringstream in(line);
    Expected expected;
    in >> expected;
    SCOPED_TRACE(expected.file);
    compare(expected, std::string(corpus) + "/" + folder + "/" + expected.file);
  }
  EXPECT_EQ(found, count);
}

} // namespace tetvdb::test
