// SPDX-License-Identifier: Apache-2.0
//
// The OpenVDB side of a Volume. Includes OpenVDB: four seconds of compile time.
#pragma once

#include "tetvdb/volume/Volume.h"

#include <openvdb/openvdb.h>

namespace tetvdb {

struct GridSet {
  openvdb::GridPtrVec all; ///< names unique, one transform
};

/// OpenVDB's linear transform for `transform`: ScaleTranslateMap or ScaleMap, uniform where the
/// three sizes are equal; exact, as are files. Beware: OpenVDB 10 rounds voxel sizes whenever it
/// copies a transform that has an origin (copyGrid, deepCopy): give copies the original's transform
/// again. Throws Error(Usage) for a size that is not positive and finite, an origin
/// that is not finite, or a voxel whose volume is below OpenVDB's limit of 3e-15 cubic units.
openvdb::math::Transform::Ptr makeTransform(const GridTransform& transform);

/// Registers OpenVDB's types once; call before any use of grids or files. Thread-safe, cheap.
void initializeOpenVDB();

/// Opens the active tile whose origin comes first (x, then y, then z) to one leaf if the grid has
/// active tiles but no leaf; otherwise does nothing. Blender 3.4 draws nothing of a grid that is
/// tiles alone. Call it on finished, pruned grids before hash() and writeVolume(), so that both see
/// the same tree; neither does it on its own. Throws Error(Usage) for a grid type that is unknown.
void openFirstTile(openvdb::GridBase& grid);

} // namespace tetvdb

// Instantiating a grid type takes twelve seconds of compile time: these are compiled once, in
// GridInstances*.cpp.
namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
extern template class tree::Tree<FloatTree::RootNodeType>;
extern template class Grid<FloatTree>;
extern template class tree::Tree<BoolTree::RootNodeType>;
extern template class Grid<BoolTree>;
extern template class tree::Tree<Int32Tree::RootNodeType>;
extern template class Grid<Int32Tree>;
extern template class tree::Tree<Vec3STree::RootNodeType>;
extern template class Grid<Vec3STree>;
extern template class tree::Tree<DoubleTree::RootNodeType>;
extern template class Grid<DoubleTree>;
extern template class tree::Tree<Int64Tree::RootNodeType>;
extern template class Grid<Int64Tree>;
extern template class tree::Tree<MaskTree::RootNodeType>;
extern template class Grid<MaskTree>;
extern template class tree::Tree<Vec3DTree::RootNodeType>;
extern template class Grid<Vec3DTree>;
extern template class tree::Tree<Vec3ITree::RootNodeType>;
extern template class Grid<Vec3ITree>;
} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
