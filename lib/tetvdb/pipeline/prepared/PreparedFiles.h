// SPDX-License-Identifier: Apache-2.0
//
// The binary files of a prepared mesh, in this machine's byte order: eight bytes that say what
// follows, then arrays whose lengths are in the index.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/pipeline/prepared/PreparedIndex.h"
#include "tetvdb/voxelize/SpooledBoundary.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// A node of 128^3 voxels that tets meet, and the slabs of it that they do (eachNodeOf()).
struct MetNode {
  NodeIndex node{};
  std::uint32_t slabs = 0;
};

/// The tets of a bucket in their order, with points, regions and values of their own.
struct BucketTets {
  TetMesh mesh;                       ///< every tet is a cell of its own for arrays of the cells
  std::vector<std::uint32_t> numbers; ///< of the cells in the whole mesh
};

std::uint64_t boundaryFileBytes(std::uint64_t faces, std::uint64_t points);
std::uint64_t nodesFileBytes(std::uint64_t nodes);
/// By the counts of `bucket`, and the arrays and regions of `index`.
std::uint64_t bucketFileBytes(const PreparedIndex& index, const TetBucket& bucket);

/// They write `folder`/NAME and throw Error(Write).
PreparedFile writeBoundary(const std::string& folder, const SpooledBoundary& boundary);
PreparedFile writeNodes(const std::string& folder, const std::vector<MetNode>& nodes);
PreparedFile writeBucket(const std::string& folder, const std::string& name,
                         const BucketTets& tets);

/// They throw Error(Invalid), with the file's name, where its bytes are not those that were
/// written, or do not make sense.
SpooledBoundary readBoundary(const std::string& folder, const PreparedIndex& index);
std::vector<MetNode> readNodes(const std::string& folder, const PreparedIndex& index);
BucketTets readBucket(const std::string& folder, const PreparedIndex& index,
                      const TetBucket& bucket);
/// A bucket without tets, with the index's arrays.
BucketTets emptyBucket(const PreparedIndex& index);

} // namespace tetvdb
