// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Error.h"

namespace tetvdb {

/// Thrown by tetrahedralize() where the triangles cut one another into more tets than can be
/// meshed. Those of the solid's boundary alone (surface/LocalRepair.h) do so seldom.
class TooManyTets : public Error {
public:
  using Error::Error;
};

} // namespace tetvdb
