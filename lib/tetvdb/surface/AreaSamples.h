// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

/// Points on the faces of a mesh, one in each of equal shares of their cumulative area; always the
/// same. The mesh must outlive it.
class AreaSamples {
public:
  /// None if no face has an area.
  AreaSamples(const TriangleMesh& mesh, std::size_t samples);

  struct Sample {
    std::size_t face;
    Vec3d point;
  };
  std::size_t size() const { return samples_; }
  Sample operator[](std::size_t i) const;

private:
  const TriangleMesh& mesh_;
  std::vector<double> areas_; ///< cumulative, twice the area
  std::size_t samples_ = 0;
};

} // namespace tetvdb
