// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/ShellSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <openvdb/tools/Prune.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {

openvdb::FloatGrid::Ptr shellSurface(const openvdb::FloatGrid& distance,
                                     const openvdb::BoolGrid& shell, double thickness, bool outward,
                                     double halfWidth) {
  using Leaf = openvdb::FloatTree::LeafNodeType;
  std::vector<const Leaf*> leaves;
  distance.constTree().getNodes(leaves);
  const auto background = static_cast<float>(halfWidth);
  const auto signedBy = [&](bool inside, double s) {
    const double f = outward ? std::max(-s, s - thickness) : std::max(s, -thickness - s);
    const double min = std::numeric_limits<float>::min();
    return static_cast<float>(inside ? std::min(f, -min) : std::max(f, 0.0));
  };
  std::vector<std::unique_ptr<Leaf>> made(leaves.size());
  tbb::parallel_for(std::size_t(0), leaves.size(), [&](std::size_t i) {
    auto leaf = std::make_unique<Leaf>(leaves[i]->origin(), background, false);
    const auto inside = shell.getConstAccessor();
    for (auto value = leaves[i]->cbeginValueOn(); value; ++value) { // others are outside
      const auto f = signedBy(inside.isValueOn(value.getCoord()), static_cast<double>(*value));
      if (std::abs(f) < background)
        leaf->setValueOn(value.pos(), f);
      else
        leaf->setValueOnly(value.pos(), std::copysign(background, f));
    }
    made[i] = std::move(leaf);
  });
  // So are tiles.
  auto grid = openvdb::FloatGrid::create(background);
  for (auto& leaf : made)
    grid->tree().addLeaf(leaf.release());
  openvdb::tools::pruneLevelSet(grid->tree());
  grid->setName("surface");
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

} // namespace tetvdb
