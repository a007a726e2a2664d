// SPDX-License-Identifier: Apache-2.0
//
// Compiles the grid types that volume/Grids.h declares. Three files share them, so that they
// compile at the same time.
#include "tetvdb/volume/Grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
template class tree::Tree<FloatTree::RootNodeType>;
template class Grid<FloatTree>;
template class tree::Tree<DoubleTree::RootNodeType>;
template class Grid<DoubleTree>;
template class tree::Tree<Vec3DTree::RootNodeType>;
template class Grid<Vec3DTree>;
} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
