// SPDX-License-Identifier: Apache-2.0
//
// Values of a grid of any type as numbers: of vectors the length.
#pragma once

#include "tetvdb/core/Vec3.h"

#include <memory>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// Const member functions are thread-safe.
class GridValues {
public:
  virtual ~GridValues() = default;
  /// Whether the voxel is active; `value` is set in either case (inactive: what the grid holds
  /// there, mostly its background).
  virtual bool at(const Vec3i& voxel, double& value) const = 0;

  /// at() for voxels near one another, by one thread: it caches the last nodes.
  class Reader {
  public:
    virtual ~Reader() = default;
    virtual bool at(const Vec3i& voxel, double& value) = 0;
  };
  /// The values must outlive it.
  virtual std::unique_ptr<Reader> reader() const = 0;
};

/// The grid must outlive it. Any of KnownGrids; Error(Usage) for others.
std::unique_ptr<GridValues> valuesOf(const openvdb::GridBase& grid);

} // namespace tetvdb
