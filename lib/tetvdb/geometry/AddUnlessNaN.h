// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace tetvdb {

/// Adds n values to sums; returns false, and adds nothing, if one of the values is NaN.
bool addUnlessNaN(double* sums, const double* values, std::size_t n);

} // namespace tetvdb
