// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace tetvdb {

/// One vector of the elements of many, in the order of `parts`: the results of
/// threads or tasks, each in its own. `parts` is any range of vectors of T. The order is that of
/// the parts, so that results of threads need sorting. Linear; allocates once.
template <typename T, typename Parts>
std::vector<T> joinedVectors(const Parts& parts) {
  std::size_t total = 0;
  for (const std::vector<T>& part : parts)
    total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (const std::vector<T>& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

} // namespace tetvdb
