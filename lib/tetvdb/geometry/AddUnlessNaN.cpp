// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/geometry/AddUnlessNaN.h"

#include "tetvdb/core/Multiversion.h"

namespace tetvdb {

TETVDB_MULTIVERSION
bool addUnlessNaN(double* __restrict sums, const double* __restrict values, std::size_t n) {
  double check = 0;
  for (std::size_t i = 0; i < n; ++i)
    check = values[i] == values[i] ? check : 1.0;
  if (check != 0)
    return false;
  for (std::size_t i = 0; i < n; ++i)
    sums[i] += values[i];
  return true;
}

} // namespace tetvdb
