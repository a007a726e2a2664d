// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tetvdb {

/// The file formats; io/Formats.h has a row for each. Values are not stored anywhere; their order
/// has no meaning.
enum class FileFormat : std::uint8_t {
  Unknown,
  Stl,
  Obj,
  Off, ///< OFF, COFF, NOFF, ...
  Ply,
  ThreeMf,
  Amf,
  Gltf,
  Fbx,
  Collada,
  ThreeDs,
  Gmsh,
  Medit,
  MeditBinary,
  TetGen,
  Netgen,
  Abaqus,
  Nastran,
  Ucd,
  Vtk,
  Vtu,
  Vts,  ///< structured and rectilinear grids
  Pvtu, ///< .pvts and .pvtr, too
  Vtp,
  Vtm,
  Pvd,
  VtkHdf,
  Xdmf,
  Cgns,
  Exodus,
  Ensight,
  Frd,
  Neu,
  Su2,
  OpenFoam,
  Unv,
  Vdb,
  Nvdb,
  Npy,
  Npz,
  Vti,
  VtkImage,
  Nrrd,
  Nhdr, ///< NRRD's header, apart from the numbers
  MetaImage,
  Nifti,
  Hdf5,
  Tiff,
  Raw,
  Binvox
};

} // namespace tetvdb
