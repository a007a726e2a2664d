// SPDX-License-Identifier: Apache-2.0
//
// Compiles the grid types that volume/Grids.h declares. Three files share them, so that they
// compile at the same time.
#include "tetvdb/volume/Grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
template class tree::Tree<BoolTree::RootNodeType>;
template class Grid<BoolTree>;
template class tree::Tree<MaskTree::RootNodeType>;
template class Grid<MaskTree>;
template class tree::Tree<Vec3STree::RootNodeType>;
template class Grid<Vec3STree>;
} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
