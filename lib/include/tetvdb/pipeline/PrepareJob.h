// SPDX-License-Identifier: Apache-2.0
//
// Prepares a mesh or a volume as a solid for a 3D printer: the job of `tetvdb
// prepare`.
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
  double offset = 0;  ///< first step: the solid grows, or shrinks if negative; 0: none
  double wall = 0;    ///< makes the solid hollow with walls of this thickness; 0: no
  double close = 0;   ///< as CavityOptions::close
  /// For the cavity made by `wall`; an array is one of tets, with a name as in FieldRequest.
  std::optional<InfillSettings> infill;
  /// Voxels: faces of the cavity are merged while its surface moves by less, and away from the wall
  /// alone; 0: they stay. By default kSimplify, and 0 with an infill or for a volume file.
  std::optional<double> simplify;
  static constexpr double kSimplify = 0.25;
  double fillVolume = 0; ///< fills cavities of less volume; those of the input are filled first
  std::vector<DrainHole> drains;
  /// Above 0: also a hole of this radius at the lowest point of every cavity.
  double drainRadius = 0;
  double voxelSize = 0;      ///< 0: by defaultVoxel()
  CleanOptions clean;        ///< of triangles
  int threads = 0;           ///< 0: as many as the calling thread's TBB arena has
  std::size_t maxMemory = 0; ///< bytes for the whole process; 0: the available memory
};

/// A drilled hole.
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
  std::string units;          ///< if known
  double voxel = 0;           ///< world units; 0 if no voxels were needed
  bool voxelIsCoarse = false; ///< larger than the wall requires, because of the model's size
  double volumeBefore = 0, volumeAfter = 0; ///< world units cubed, of the cleaned solid
  std::size_t cavitiesBefore = 0, cavities = 0;
  std::size_t filledCavities = 0;
  double filledVolume = 0;
  std::size_t islands = 0; ///< omitted components of the infill that touch nothing
  std::vector<PreparedDrain> drains;
  std::size_t cavityFaces = 0; ///< of the cavity as it was made, before simplification
  double wall = 0;             ///< proven minimum of the wall thickness; 0: there is no cavity
  std::size_t keptFaces = 0;   ///< faces of the cleaned input that are unchanged in the output
  std::size_t vertices = 0, triangles = 0; ///< of the surface
  OutputInfo output;
};

/// The default voxel size: the smallest of a twentieth of the wall and an eighth of the
/// offset and of the radius of `close`; with an infill, an eighth of the wall and a quarter
/// of the infill's thickness; but at least the size for which the surface has about four
/// million faces. Throws Error(Limit) if such voxels are larger than half of one of these
/// lengths.
/// `area`, `volume`: of the solid; `thickness`: the minimum of the infill's thickness.
double defaultVoxel(const PrepareJob& job, double area, double volume, double thickness,
                    bool& coarse);

/// Reads and cleans. Triangles that are then not closed, manifold, oriented and free of
/// self-intersections are mended by mendSolid() (RepairJob.h): in place, with the warning
/// "repaired", or remade from voxels, with the warning "remeshed". Tets are replaced by their
/// surface, a volume by the result of extractSurface(). Then, as requested: small cavities are
/// filled (print/Shells.h), the solid is offset (print/OffsetSolid.h), a cavity is made in it
/// (print/Cavity.h; warning "no-cavity" if the wall fills the solid), of which small components are
/// also filled and whose faces are merged (surface/SimplifySurface.h), and holes are drilled into
/// cavities (print/DrainHoles.h), whose plugs are written as .stl files beside the output. Faces of
/// the input are unchanged if the solid is not offset. A volume file contains the grid "surface", a
/// level set of three voxels to each side. Adds stages "read", "clean", those of mendSolid(),
/// "round" (RoundToFloats.h, for .stl and .3mf, which may warn of "float-crossings"), "voxelize",
/// "distance", "extract", "simplify", "drill", "fields" and "write" to `report`. Throws the errors
/// of its stages; nothing is written then.
PrepareResult run(const PrepareJob& job, Report& report, Progress& progress);

} // namespace tetvdb
