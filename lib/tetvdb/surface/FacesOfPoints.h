// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/mesh/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// The faces that have each point of a mesh as a corner.
class FacesOfPoints {
public:
  /// Parallel, linear in the faces, independent of the number of threads.
  explicit FacesOfPoints(const TriangleMesh& mesh);

  struct Range {
    const std::uint32_t *first, *last;
    const std::uint32_t* begin() const { return first; }
    const std::uint32_t* end() const { return last; }
  };
  /// Ascending.
  Range operator()(std::size_t point) const {
    return {faces_.data() + first_[point], faces_.data() + first_[point + 1]};
  }

private:
  std::vector<std::uint32_t> first_; ///< by point, in faces_
  std::vector<std::uint32_t> faces_;
};

} // namespace tetvdb
