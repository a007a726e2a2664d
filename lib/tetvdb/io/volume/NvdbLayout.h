// SPDX-License-Identifier: Apache-2.0
//
// The .nvdb container: segments, each a header, one entry a grid, then the grids' bytes.
// Internal.
#pragma once

#include "tetvdb/core/NanoVdb.h"

#include <cstdint>
#include <openvdb/openvdb.h>

namespace tetvdb {

/// The types that are written.
using NvdbGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::BoolGrid, openvdb::Int32Grid,
                                    openvdb::Vec3SGrid, openvdb::DoubleGrid, openvdb::Int64Grid>;

enum class NvdbCodec : std::uint16_t { None = 0, Zip = 1, Blosc = 2 };
constexpr std::uint64_t kNvdbMagic = 0x304244566F6E614E;     ///< "NanoVDB0", file and grid
constexpr std::uint64_t kNvdbGridMagic = 0x314244566F6E614E; ///< "NanoVDB1", a grid since 32.6
constexpr std::uint64_t kNvdbFileMagic = 0x324244566F6E614E; ///< "NanoVDB2", a file since 32.6
constexpr std::uint64_t kNvdbChunk = std::uint64_t(1) << 30; ///< bytes compressed at once by Blosc

/// At the beginning of each segment.
struct NvdbHeader {
  std::uint64_t magic;
  std::uint32_t version;
  std::uint16_t gridCount;
  NvdbCodec codec;
};
static_assert(sizeof(NvdbHeader) == 16, "written as it is");

/// For each grid of a segment, followed by the grid's name.
struct NvdbEntry {
  std::uint64_t gridSize, fileSize, nameKey, voxelCount;
  std::uint32_t gridType, gridClass;
  double worldBox[6];
  std::int32_t indexBox[6];
  double voxelSize[3];
  std::uint32_t nameSize; ///< with the final zero
  std::uint32_t nodeCount[4], tileCount[3];
  NvdbCodec codec;
  std::uint16_t padding;
  std::uint32_t version;
};
static_assert(sizeof(NvdbEntry) == 176, "written as it is");

/// The beginning of a grid's buffer, the same bytes in NanoVDB 32.4 to 32.9.
struct NvdbGrid {
  std::uint64_t magic, checksum;
  std::uint32_t version, flags, gridIndex, gridCount;
  std::uint64_t gridSize;
  char name[256];
  float mapF[22];
  double matrix[9], inverse[9], translation[3], taper;
  double worldBox[6], voxelSize[3];
  std::uint32_t gridClass, gridType;
  std::int64_t blindOffset;
  std::uint32_t blindCount, data0;
  std::uint64_t data1, data2;
  // the tree
  std::uint64_t nodeOffset[4]; ///< from the tree: first leaf, lower, upper node, root
  std::uint32_t nodeCount[3], tileCount[3];
  std::uint64_t voxelCount;
};
constexpr std::size_t kNvdbTreeAt = 672;
static_assert(sizeof(NvdbGrid) == kNvdbTreeAt + 64, "grid and tree");

} // namespace tetvdb
