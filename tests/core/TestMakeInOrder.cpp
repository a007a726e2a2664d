// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/MakeInOrder.h"

#include <atomic>
#include <gtest/gtest.h>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>

namespace tetvdb {
namespace {

// How many exist.
class Counted {
public:
  Counted() { ++count; }
  Counted(const Counted& other) : value(other.value) { ++count; }
  Counted& operator=(const Counted&) = default;
  ~Counted() { --count; }
  static std::atomic<int> count;
  int value = 0;
};
std::atomic<int> Counted::count{0};

std::vector<int> taken(int blocks, std::size_t window, int failing, const std::string& where) {
  std::vector<int> order;
  int next = 0;
  const auto failIf = [&](const char* here, int block) {
    if (block == failing && where == here)
      throw std::runtime_error(here);
  };
  makeInOrder<Counted, std::unique_ptr<Counted>>(
      [&](Counted& piece) {
        failIf("next", next);
        piece.value = next++;
        return piece.value < blocks;
      },
      [&](const Counted& piece) {
        if (piece.value % 3 == 0)
          std::this_thread::yield();
        failIf("make", piece.value);
        return std::make_unique<Counted>(piece);
      },
      [&](const std::unique_ptr<Counted>& made) {
        failIf("take", made->value);
        order.push_back(made->value);
      },
      window);
  return order;
}

TEST(MakeInOrder, Order) {
  for (const std::size_t window : {0u, 1u, 2u, 5u, 64u})
    for (const int blocks : {0, 1, 2, 7, 300}) {
      std::vector<int> expected(static_cast<std::size_t>(blocks));
      std::iota(expected.begin(), expected.end(), 0);
      EXPECT_EQ(taken(blocks, window, -1, ""), expected) << window;
      EXPECT_EQ(Counted::count, 0);
    }
}

TEST(MakeInOrder, NothingIsLeftWhereOneThrows) {
  for (const char* where : {"next", "make", "take"})
    for (const int failing : {0, 1, 9, 100}) {
      EXPECT_THROW(taken(200, 6, failing, where), std::runtime_error) << where;
      EXPECT_EQ(Counted::count, 0) << where << " " << failing;
    }
}

} // namespace
} // namespace tetvdb
