// SPDX-License-Identifier: Apache-2.0
//
// Invariants of 3 x 3 tensors, rows first. Additions, multiplications, divisions and square roots
// alone, in a fixed order: the same bits on every machine.
#pragma once

#include <array>

namespace tetvdb {

using Tensor = std::array<double, 9>;

double traceOf(const Tensor& t);
double determinantOf(const Tensor& t);
/// Von Mises' equivalent of the symmetric part: sqrt(3/2 s:s), s the deviator.
double misesOf(const Tensor& t);
/// Eigenvalues of the symmetric part, the largest first, by Jacobi's rotations; good to a few units
/// in the last place of the largest magnitude. NaN where an entry is not finite.
std::array<double, 3> principalsOf(const Tensor& t);

} // namespace tetvdb
