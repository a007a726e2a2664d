// SPDX-License-Identifier: Apache-2.0
//
// The input and the results of DeviceVoxelizer::sample(): arrays of a mesh at the voxels that its
// tets own, leaf by leaf. Contains no type of CUDA or NanoVDB.
#pragma once

#include "tetvdb/mesh/FieldRule.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb::nano {

enum class NumberType : std::uint8_t { Float, Double, Int32, Int64 };

/// An array over the points or the cells, in host memory.
struct ArrayView {
  const void* values = nullptr; ///< element e, component c at [e * components + c]
  NumberType type = NumberType::Float;
  std::uint32_t components = 1;
  std::uint64_t elements = 0;

  std::size_t bytes() const {
    return elements * components * (type == NumberType::Float || type == NumberType::Int32 ? 4 : 8);
  }
};

/// A grid's values: rule.numbers numbers are read and made into one value.
struct FieldView {
  struct Source {
    std::uint32_t array = 0; ///< in FieldJob::arrays
    std::uint32_t component = 0;
  };
  FieldRule rule;
  bool onCells = false;
  Source sources[FieldRule::kMaxNumbers];
  std::string name;      ///< at most 255 bytes
  double background = 0; ///< where no tet is
};

struct FieldJob {
  double voxelSize[3] = {1, 1, 1}; ///< world units
  double origin[3] = {0, 0, 0};    ///< world units: the centre of voxel (0, 0, 0)
  std::vector<ArrayView> arrays;
  std::vector<FieldView> fields;
  /// The cell of every tet, an element of arrays over cells; null: the tet's number.
  const std::uint32_t* cellOfTet = nullptr;
};

/// Leaves in tree order, those of a 128^3 node together and never in two batches. Masks may be
/// empty.
struct LeafBatch {
  std::uint64_t count = 0;
  const std::int32_t* origins = nullptr; ///< first voxel, three numbers a leaf
  /// Voxels that a tet owns, eight words a leaf: word = x, bit = 8 y + z.
  const std::uint64_t* masks = nullptr;
  /// Of every field 512 values a leaf, [64 x + 8 y + z]: a float, three floats or an int32 each;
  /// anything where the mask has no voxel.
  std::vector<const unsigned char*> values;
};

class LeafReceiver {
public:
  virtual ~LeafReceiver() = default;
  /// Called before the first batch, with the number of leaves (of one device, if several share the
  /// job).
  virtual void expect(std::uint64_t leaves) = 0;
  /// The batch is invalid after the return. If several devices share a job, their threads call at
  /// the same time.
  virtual void take(const LeafBatch& batch) = 0;
};

/// What there is of a sampled grid.
struct GridCounts {
  std::uint64_t bytes = 0;
  std::uint64_t leftOut = 0; ///< voxels of tets without a finite value
};

class GridReceiver {
public:
  virtual ~GridReceiver() = default;
  /// Called for one grid after another, in the job's order: memory that a grid of NanoVDB is copied
  /// to before the next call or the return, aligned to 64 bytes.
  virtual unsigned char* place(const GridCounts& counts) = 0;
};

} // namespace tetvdb::nano
