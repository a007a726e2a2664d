// SPDX-License-Identifier: Apache-2.0
//
// Arrays of a mesh into sparse grids: every voxel gets the value at its centre from the tet that
// owns it.
//
//   const auto fields = tetvdb::resolveFields(mesh, options, report);
//   tetvdb::sampleFields(mesh, transform, fields, {}, volume, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/fields/Field.h"
#include "tetvdb/io/volume/PackedGrid.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/Voxelize.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

struct SampleOptions {
  std::size_t maxMemory = 0; ///< bytes for this stage; 0: what the machine has available
  bool allowEmpty = false;   ///< false: not one voxel inside the mesh is Error(Invalid)
};

/// Adds a grid for each of `fields` to `volume`: Float, Vec3s or Int32, a fog volume if Float.
/// Active are the voxels that a tet owns (geometry/Ownership.h), but for those whose value is no
/// finite number. Arrays of the points are interpolated between the owner's corners, or by the
/// shape functions of the cell that it is cut out of (TetMesh::curved); integers take the value of
/// the corner with the largest weight; arrays of the cells are taken as they are.
/// Tuples are interpolated first, and their invariants taken then. Between points of a linear field
/// values are exact but for rounding to float: the weights are those of the snapped tet, 2^-20 of a
/// voxel from the tet in world space.
/// Grids carry the metadata "source_array", "source_on", "original_min" and "original_max" (of the
/// array, lengths for vectors), and, where values were changed, "scale" and "offset": stored =
/// original * scale + offset.
/// The values depend on mesh, transform and fields alone, not on threads, nor on the order of tets
/// and points but where tets overlap. Adds stage "fields" to `report`; returns what snapping found.
/// Warns ("values-by-tets") of voxels in linear cells whose place in the cell is not found, as
/// where it is turned inside out: they have the values of their tets.
///
/// One rasterisation for all fields; about 60 ns a tet and 10 ns a voxel and number on one core,
/// and 0.3 us more a voxel in a cell with shape functions that is no affine image of its reference
/// cell.
///
/// Throws Error(Limit) where the grids would not fit in memory, Error(Invalid) where no voxel
/// centre lies inside the mesh, Error(Cancelled). Uses the calling thread's TBB arena.
SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        Volume& volume, Report& report, Progress& progress);

struct PackOptions {
  /// Where compressed values go that are more than `inMemory` bytes: the output's folder.
  std::string folder;
  std::size_t inMemory = std::size_t(32) << 20;
  bool half = false; ///< floats are stored with 16 bits
};

/// sampleFields() for a .vdb file: leaves are compressed as they are made, so that their values are
/// never in memory together. The grids are those of sampleFields(); they come into `packed`, which
/// writeVdb() (io/volume/PackedGrid.h) writes. Throws Error(Write) too, where the folder's disk is
/// full.
SnapCounts packFields(const TetMesh& mesh, const GridTransform& transform,
                      const std::vector<Field>& fields, const SampleOptions& options,
                      const PackOptions& pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                      Report& report, Progress& progress);

} // namespace tetvdb
