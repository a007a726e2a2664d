// SPDX-License-Identifier: Apache-2.0
//
// A volume of arrays. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/volume/arrays/StoredArray.h"
#include "tetvdb/volume/Grids.h"

#include <set>
#include <string>

namespace tetvdb {

/// Makes a volume of arrays as readArrays() says (io/ArrayFile.h), of a file or in memory.
class ArrayVolume {
public:
  /// `where`: for messages.
  ArrayVolume(std::string where, const ArrayInput& options, Progress& progress);

  /// Refers to this.
  ArraySink sink();
  void add(StoredArray array);
  /// Throws Error(Invalid) if there is no grid.
  Volume finish();

private:
  void addGrid(const StoredArray& array, std::string name);
  openvdb::math::Transform::Ptr transformOf(const StoredArray& array) const;

  std::string where_;
  const ArrayInput& options_;
  Progress& progress_;
  Volume volume_;
  std::set<std::string> names_; ///< of its grids
};

} // namespace tetvdb
