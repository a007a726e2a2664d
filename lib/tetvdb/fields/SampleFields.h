// SPDX-License-Identifier: Apache-2.0
//
// Samples arrays of a mesh into sparse grids: every voxel has the value at its centre from the tet
// that owns it.
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
  std::size_t maxMemory = 0; ///< bytes for this stage; 0: the available memory
  bool allowEmpty = false;   ///< false: a mesh without any inside voxel is Error(Invalid)
};

/// Adds one grid per field to `volume`: Float, Vec3s or Int32; Float grids are fog volumes.
/// The voxels that a tet owns (geometry/Ownership.h) are active, except those with a value
/// that is not finite. Arrays of the points are interpolated between the owner's corners, or
/// by the shape functions of the cell that it is part of (TetMesh::curved); integers have
/// the value of the corner with the largest weight; arrays of the cells are used unchanged.
/// Tuples are interpolated first, and their invariants computed afterwards. Values of a
/// linear field are exact up to rounding to float: the weights are those of the snapped tet,
/// 2^-20 of a voxel from the tet in world space. Grids have the metadata "source_array",
/// "source_on", "original_min" and "original_max" (of the array, lengths for vectors), and,
/// if values were changed, "scale" and "offset": stored = original * scale + offset. The
/// values depend on mesh, transform and fields only, not on threads, and on the order of
/// tets and points only where tets overlap. Adds stage "fields" to `report`; returns the
/// counts of snapping. Warns ("values-by-tets") of voxels in linear cells whose reference
/// coordinates are not found, for example in inverted cells: they have the values of their
/// tets.
///
/// One rasterisation for all fields; about 60 ns per tet and 10 ns per voxel and number on
/// one core, and 0.3 us more per voxel in a cell with shape functions that is not an affine
/// image of its reference cell.
///
/// Throws Error(Limit) if the grids do not fit in memory, Error(Invalid) if no voxel centre
/// lies inside the mesh, Error(Cancelled). Uses the calling thread's TBB arena.
SnapCounts sampleFields(const TetMesh& mesh, const GridTransform& transform,
                        const std::vector<Field>& fields, const SampleOptions& options,
                        Volume& volume, Report& report, Progress& progress);

struct PackOptions {
  /// The folder for compressed values beyond `inMemory` bytes: that of the output.
  std::string folder;
  std::size_t inMemory = std::size_t(32) << 20;
  bool half = false; ///< stores floats with 16 bits
};

/// sampleFields() for a .vdb file: leaves are compressed as they are made, so that their values are
/// never all in memory. The grids are those of sampleFields(); they are added to `packed`, which
/// writeVdb() (io/volume/PackedGrid.h) writes. Also throws Error(Write) if the folder's disk is
/// full.
SnapCounts packFields(const TetMesh& mesh, const GridTransform& transform,
                      const std::vector<Field>& fields, const SampleOptions& options,
                      const PackOptions& pack, std::vector<std::unique_ptr<PackedGrid>>& packed,
                      Report& report, Progress& progress);

} // namespace tetvdb
