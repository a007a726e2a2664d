// SPDX-License-Identifier: Apache-2.0
//
// The levels of detail (volume/LevelsOfDetail.h) of a grid that comes part by part.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/volume/TreeSource.h"

#include <cstddef>
#include <memory>
#include <openvdb/openvdb.h>
#include <vector>

namespace tetvdb {

class GridLevels {
public:
  virtual ~GridLevels() = default;
  /// Nodes of the grid, of its type: those of a child of the root node come together. Throws
  /// Error(Limit), and as progress.check() does.
  virtual void add(const openvdb::GridBase& part, Progress& progress) = 0;
  /// When all parts have come: the grids of the levels. To be called once.
  virtual openvdb::GridPtrVec finish() = 0;
};

/// Of a grid with this name, type, class, transform and metadata, and with any tree. `maxMemory`:
/// bytes of the coarser leaves. Throws Error(Usage) as addLevels() does.
std::unique_ptr<GridLevels> makeGridLevels(const openvdb::GridBase::ConstPtr& grid,
                                           const LevelRange& levels, std::size_t maxMemory);

/// Passes on what another source has. Memory: that of the coarser trees, within `maxMemory`.
class TreeLevels : public TreeSource {
public:
  /// `source` must outlive it. Throws as makeGridLevels() does.
  TreeLevels(TreeSource& source, const LevelRange& levels, std::size_t maxMemory,
             Progress& progress);

  const std::vector<Vec3i>& cubes() const override { return source_.cubes(); }
  void begin() override; ///< another pass: counts anew
  std::vector<NodeBox> parts(std::size_t cube) override { return source_.parts(cube); }
  openvdb::GridPtrVec make(const NodeBox& box, Progress& progress) override;

  /// Of levels, all grids together.
  std::size_t gridCount() const;
  /// When all parts were passed on: the levels of the first grid, then those of the next.
  openvdb::GridPtrVec finish();

private:
  TreeSource& source_;
  LevelRange range_;
  std::size_t gridBytes_; ///< that the levels of a grid may take
  openvdb::GridPtrVec empty_;
  std::vector<std::unique_ptr<GridLevels>> levels_;
};

} // namespace tetvdb
