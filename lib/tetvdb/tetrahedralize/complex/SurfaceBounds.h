// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/Landmarks.h"

namespace tetvdb {

/// Where tracked faces and boundary edges must stay.
struct Bounds {
  const Envelope& surface;
  const Envelope& boundary; ///< empty where the input has none
  double radius;            ///< of both, lattice units
  /// Of `surface`: points that tracked faces must stay near to. Null: coarsen() and improve() make
  /// their own.
  const Landmarks* landmarks = nullptr;
};

} // namespace tetvdb
