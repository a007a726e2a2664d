// SPDX-License-Identifier: Apache-2.0
//
// One job from a mesh or a volume to a solid that is ready for a 3D printer: what `tetvdb prepare`
// runs.
//
//   tetvdb::PrepareJob job;
//   job.input = "figure.stl";
//   job.output = "hollow.stl";
//   job.wall = 2;
//   tetvdb::PrepareResult result = tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/print/DrainHole.h"
#include "tetvdb/print/InfillKind.h"
#include "tetvdb/surface/CleanTriangles.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Lengths are in the input's units.
struct PrepareJob {
  std::string input; ///< a mesh file, of triangles or of tets, or a volume file
  bool isVolume = false;
  std::string grid;   ///< of a volume, as ExtractOptions::grid
  std::string output; ///< .stl, .obj, .ply, .off or .3mf; .vdb or .nvdb: a level set
  double offset = 0;  ///< the solid grows, or shrinks where below 0, first; 0: stays
  double wall = 0;    ///< the solid becomes hollow with walls of this thickness; 0: stays
  double close = 0;   ///< as CavityOptions::close
  /// Of the cavity that `wall` leaves; an array is one of tets, by a name as of FieldRequest.
  std::optional<InfillSettings> infill;
  double fillVolume = 0; ///< cavities of less are filled, those of the input first of all
  std::vector<DrainHole> drains;
  /// Above 0: a hole of this radius at the lowest point of every cavity too.
  double drainRadius = 0;
  double voxelSize = 0;      ///< 0: by defaultVoxel()
  CleanOptions clean;        ///< of triangles
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: what the machine has available
};

/// A hole that was made.
struct PreparedDrain {
  DrainHole hole;
  OutputInfo plug;       ///< beside the output: NAME_plug_1.stl and on
  double plugVolume = 0; ///< world units cubed
};

struct PrepareResult {
  SolidSource source = SolidSource::Triangles;
  InputInfo input;     ///< of meshes
  CleanCounts cleaned; ///< of triangles
  bool repaired = false;
  std::string units;          ///< where they are known
  double voxel = 0;           ///< world units; 0 where none were needed
  bool voxelIsCoarse = false; ///< larger than by the wall alone, since the model is large
  double volumeBefore = 0, volumeAfter = 0; ///< world units cubed, cleaned
  std::size_t cavitiesBefore = 0, cavities = 0;
  std::size_t filledCavities = 0;
  double filledVolume = 0;
  std::size_t islands = 0; ///< components of the infill that nothing held, left out
  std::vector<PreparedDrain> drains;
  double wall = 0; ///< of the cavity that was made: no wall is thinner, proven; 0: there is none
  std::size_t keptFaces = 0; ///< of the input, cleaned, that are in the output as they were
  std::size_t vertices = 0, triangles = 0; ///< of the surface
  OutputInfo output;
};

/// The voxels that a job takes where it does not say: a twentieth of the wall, an eighth of the
/// offset or of the radius of `close`, with an infill an eighth of the wall and a quarter of the
/// infill's thickness, whichever is the smallest, but so large that the surface has
/// about four million faces at most. Throws Error(Limit) where such voxels are more than half of
/// one of them.
/// `area`, `volume`: the solid's; `thickness`: the infill's at its thinnest.
double defaultVoxel(const PrepareJob& job, double area, double volume, double thickness,
                    bool& coarse);

/// Reads and cleans. Triangles that are not closed, manifold, oriented and free of
/// self-intersections then are mended by repairLocally(), with the warning "repaired"; where that
/// fails, Error(Invalid). Tets are their surface, a volume the surface that extractSurface() makes
/// of it. Then, as far as it is asked for: small cavities are filled (print/Shells.h), the solid is
/// offset (print/OffsetSolid.h), a cavity is made in it (print/Cavity.h; warning "no-cavity" where
/// the wall fills the solid) of which small components are filled too, and holes are drilled into
/// cavities (print/DrainHoles.h), whose plugs are written as .stl files beside the output. Faces of
/// the input stay as they are where the solid is not offset. A volume file gets the grid "surface",
/// a level set of three voxels to each side. Adds stages "read", "clean", "voxelize", "distance",
/// "extract", "drill", "fields" and "write" to `report`. Throws what the steps throw; nothing is
/// written then.
PrepareResult run(const PrepareJob& job, Report& report, Progress& progress);

} // namespace tetvdb
