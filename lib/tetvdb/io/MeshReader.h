// SPDX-License-Identifier: Apache-2.0
//
// Tetrahedral and mixed solid meshes from files.
//
//   tetvdb::Progress progress;
//   tetvdb::Report report;
//   tetvdb::CellMesh cells = tetvdb::readCells("bracket.vtu", {}, report, progress);
//   tetvdb::TetMesh tets = tetvdb::splitCells(std::move(cells), {}, report, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/CellMesh.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

enum class MeshFormat : std::uint8_t {
  Unknown,
  Gmsh,        ///< .msh 1, 2.x, 4.0, 4.1; ASCII and binary
  Medit,       ///< .mesh
  MeditBinary, ///< .meshb
  TetGen,      ///< .node with .ele
  Netgen,      ///< .vol
  Abaqus,      ///< .inp
  Ucd,         ///< AVS UCD .inp
  Vtk,         ///< legacy .vtk
  Vtu,         ///< .vtu
  Pvtu,        ///< .pvtu
  Exodus,      ///< .exo, .e, .exo2, .g
  Xdmf,        ///< .xdmf, .xmf; its numbers may lie in HDF5 files beside it
  Stl,         ///< triangles, like all that follow: io/TriangleReader.h reads them
  Obj,
  Off, ///< OFF, COFF, NOFF, ...
  Ply,
  ThreeMf,
  Gltf, ///< .gltf, .glb
  Fbx,
  Collada ///< .dae
};

/// "Gmsh .msh" and so on.
std::string_view formatName(MeshFormat format);

/// Format of a file by its first bytes; its name decides only what the content leaves open
/// (TetGen's .node and .ele have no signature). Unknown where neither tells.
MeshFormat sniffMeshFormat(std::string_view bytes, const std::string& path);

/// What a file of unknown format looks like, as the end of a sentence: "holds triangles (STL), not
/// solid cells".
std::string describeUnknownFormat(std::string_view bytes, const std::string& path);

struct ReadOptions {
  /// Cell array that holds region numbers; empty: the format's own, or the first integer-valued
  /// cell array with a usual name (material, MaterialIds, region, mat_id, ... ; any case).
  std::string regionArray;
  bool attributes = true; ///< false: point and cell arrays other than regions are left out
  /// With `attributes`: names of the arrays that are wanted, those of an array's components
  /// ("u_x" of "u") being wanted with it; empty: all. Others are named in CellMesh::unread alone.
  std::vector<std::string> arrays;
  int timeStep = -1; ///< of files with several (Exodus, XDMF): counted from 0; -1: the last

  /// Whether the values of the array `name` are asked for.
  bool wants(std::string_view name) const;
};

/// Reads `path`. Throws Error(Invalid) with file, line or byte offset and cause for anything that
/// is not a whole mesh: missing or truncated data, indices out of range, coordinates that are not
/// finite, counts that the file cannot hold, no solid cells. Recoverable oddities are warnings in
/// `report`. Cost: about the time to read the bytes and parse the numbers once.
CellMesh readCells(const std::string& path, const ReadOptions& options, Report& report,
                   Progress& progress, MeshFormat* format = nullptr);

} // namespace tetvdb
