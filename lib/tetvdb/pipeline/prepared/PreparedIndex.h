// SPDX-License-Identifier: Apache-2.0
//
// The folder of a prepared mesh: prepared.json, which says what its other files hold, their sizes
// and hashes. docs/huge.md describes it.
#pragma once

#include "tetvdb/core/AtomicFolder.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/SplitBox.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// Files of a prepared mesh, besides the index and those of its tets.
constexpr const char* kPreparedBoundary = "boundary.bin";
constexpr const char* kPreparedNodes = "nodes.bin";
/// Nodes of index space reach from its negative to here.
constexpr std::int32_t kMaxNode = 1 << 24;

/// A file of the folder.
struct PreparedFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string hash; ///< XXH128, 32 hexadecimal digits
};

/// The tets that may own voxels of a box of nodes; a box without tets has no file.
struct TetBucket {
  SplitBox box;
  std::uint64_t tets = 0, points = 0;
  std::uint64_t cells = 0, cellNodes = 0; ///< of those with shape functions (TetMesh::curved)
  PreparedFile file;
};

struct PreparedArray {
  std::string name;
  Attribute::On on = Attribute::On::Points;
  std::uint32_t components = 1;
  std::size_t type = 0;     ///< number of the alternative of Attribute::Values
  bool beyondInt32 = false; ///< has whole numbers that 32 bits do not hold
};

/// The range of a field's values over the whole mesh (Field::original).
struct PreparedRange {
  std::string key; ///< keyOf(field)
  ValueRange range;
  bool notFinite = false;
};

struct PreparedIndex {
  std::string source; ///< the input's file name
  InputInfo input;
  UpAxis up = UpAxis::Z;
  GridTransform transform;
  SnapCounts counts;
  std::uint64_t boundaryPoints = 0;
  PreparedFile boundary;
  bool hasTets = false; ///< whether owners and arrays can be found
  bool hasRegions = false;
  bool hasShapes = false; ///< whether some cells have shape functions
  std::uint64_t nodeCount = 0;
  PreparedFile nodes;
  std::vector<PreparedArray> arrays;
  std::vector<UnreadArray> unread;
  std::vector<PreparedRange> ranges;
  std::vector<TetBucket> buckets; ///< by cube, then in the order of a file

  /// 32 hexadecimal digits that follow from everything that the files hold.
  std::string mark() const;
};

constexpr const char* kPreparedIndex = "prepared.json";

/// What AtomicFolder needs to know.
AtomicFolder::Contents preparedContents();
std::string bucketName(std::size_t number);

/// What determines the values that a field's range is taken over.
std::string keyOf(const Field& field);

/// Writes `folder`/prepared.json. Throws Error(Write).
void writePreparedIndex(const std::string& folder, const PreparedIndex& index);
/// Reads it and checks it, and that all files are there with their sizes. Throws Error(Invalid)
/// with the name of the file that is at fault.
PreparedIndex readPreparedIndex(const std::string& folder);

} // namespace tetvdb
