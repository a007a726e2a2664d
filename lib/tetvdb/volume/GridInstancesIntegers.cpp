// SPDX-License-Identifier: Apache-2.0
//
// Compiles the grid types that volume/Grids.h declares. Three files share them, so that they
// compile at the same time.
#include "tetvdb/volume/Grids.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
template class tree::Tree<Int32Tree::RootNodeType>;
template class Grid<Int32Tree>;
template class tree::Tree<Int64Tree::RootNodeType>;
template class Grid<Int64Tree>;
template class tree::Tree<Vec3ITree::RootNodeType>;
template class Grid<Vec3ITree>;
} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
