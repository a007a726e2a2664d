// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/Formats.h"

#include "tetvdb/core/Letters.h"
#include "tetvdb/io/FormatSignatures.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/VtmReader.h"
#include "tetvdb/io/cells/CellFaces.h"
#include "tetvdb/io/formats/abaqus/AbaqusReader.h"
#include "tetvdb/io/formats/amf/AmfReader.h"
#include "tetvdb/io/formats/assimp/AssimpReader.h"
#include "tetvdb/io/formats/avs/UcdReader.h"
#include "tetvdb/io/formats/calculix/FrdReader.h"
#include "tetvdb/io/formats/cgns/CgnsReader.h"
#include "tetvdb/io/formats/ensight/EnsightReader.h"
#include "tetvdb/io/formats/exodus/ExodusReader.h"
#include "tetvdb/io/formats/gambit/NeuReader.h"
#include "tetvdb/io/formats/gmsh/GmshReader.h"
#include "tetvdb/io/formats/gmsh/GmshWriter.h"
#include "tetvdb/io/formats/ideas/UnvReader.h"
#include "tetvdb/io/formats/medit/MeditReader.h"
#include "tetvdb/io/formats/medit/MeditWriter.h"
#include "tetvdb/io/formats/nastran/NastranReader.h"
#include "tetvdb/io/formats/netgen/NetgenReader.h"
#include "tetvdb/io/formats/obj/ObjReader.h"
#include "tetvdb/io/formats/obj/ObjWriter.h"
#include "tetvdb/io/formats/off/OffReader.h"
#include "tetvdb/io/formats/off/OffWriter.h"
#include "tetvdb/io/formats/openfoam/OpenFoamReader.h"
#include "tetvdb/io/formats/ply/PlyReader.h"
#include "tetvdb/io/formats/ply/PlyWriter.h"
#include "tetvdb/io/formats/stl/StlReader.h"
#include "tetvdb/io/formats/stl/StlWriter.h"
#include "tetvdb/io/formats/su2/Su2Reader.h"
#include "tetvdb/io/formats/tetgen/TetGenReader.h"
#include "tetvdb/io/formats/threemf/ThreeMfReader.h"
#include "tetvdb/io/formats/threemf/ThreeMfWriter.h"
#include "tetvdb/io/formats/vtk/PvtuReader.h"
#include "tetvdb/io/formats/vtk/VtkHdfReader.h"
#include "tetvdb/io/formats/vtk/VtkReader.h"
#include "tetvdb/io/formats/vtk/VtuReader.h"
#include "tetvdb/io/formats/vtk/VtuWriter.h"
#include "tetvdb/io/formats/xdmf/XdmfReader.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/io/volume/arrays/ArrayFormats.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"

#include <algorithm>

namespace tetvdb {
namespace {

using namespace holds;

using ReadCells = CellMesh (*)(const Source&, const ReadOptions&, Report&, Progress&);

/// The polygons of a file that a reader of cells supports.
template <ReadCells read>
TriangleMesh readFaces(const Source& source, Report& report, Progress& progress) {
  ReadOptions options;
  options.attributes = false;
  options.faces = true;
  return trianglesOfFaces(read(source, options, report, progress), source.path);
}

std::vector<double> timesOfXdmf(const Source& source, Report&, Progress&) {
  return xdmfTimes(source);
}

std::vector<std::string> filesOfXdmf(const Source& source, int) {
  return xdmfFiles(source);
}

Format row(FileFormat id, std::string_view name, std::string_view endings,
           std::string_view description, unsigned holds) {
  Format format;
  format.id = id;
  format.name = name;
  format.endings = endings;
  format.description = description;
  format.holds = holds;
  return format;
}

/// Formats that contain only triangles: their endings suffice if the content is ambiguous.
Format triangles(FileFormat id, std::string_view name, std::string_view endings,
                 std::string_view description, bool (*isContent)(const FileStart&),
                 TriangleMesh (*read)(const Source&, Report&, Progress&),
                 void (*write)(const std::string&, const TriangleMesh&, Progress&)) {
  Format format = row(id, name, endings, description, kTriangles);
  format.isContent = isContent;
  format.isNamed = isAny;
  format.readTriangles = read;
  format.writeTriangles = write;
  return format;
}

/// Formats of solid cells.
Format cells(FileFormat id, std::string_view name, std::string_view endings,
             std::string_view description, unsigned holds, bool (*isContent)(const FileStart&),
             CellMesh (*read)(const Source&, const ReadOptions&, Report&, Progress&)) {
  Format format = row(id, name, endings, description, holds);
  format.isContent = isContent;
  format.readCells = read;
  return format;
}

Format denseArrays(FileFormat id, std::string_view name, std::string_view endings,
                   std::string_view description, bool (*isContent)(const FileStart&),
                   void (*read)(const Source&, const ArraySink&, Progress&), unsigned arrays,
                   void (*write)(const ArrayContent&, Progress&)) {
  Format format = row(id, name, endings, description, kVolume | kArrays);
  format.isContent = isContent;
  format.readArrays = read;
  format.arrays = arrays;
  format.writeArrays = write;
  return format;
}

/// Formats of solid cells or, in files without these, of polygons.
template <ReadCells read>
Format cellsOrFaces(FileFormat id, std::string_view name, std::string_view endings,
                    std::string_view description, unsigned holds,
                    bool (*isContent)(const FileStart&),
                    bool (*hasSolidCells)(const Source&, Report&, Progress&)) {
  Format format =
      cells(id, name, endings, description, holds | kTets | kTriangles, isContent, read);
  format.readTriangles = readFaces<read>;
  format.hasSolidCells = hasSolidCells;
  return format;
}

std::vector<Format> makeTable() {
  std::vector<Format> all;
  // --- triangles ---
  all.push_back(triangles(FileFormat::Stl, "STL", ".stl", "Facets, text or binary", isStl, readStl,
                          writeStl));
  all.back().hasFloatCoordinates = true;
  all.push_back(
      triangles(FileFormat::Obj, "OBJ", ".obj", "Wavefront's polygons", isObj, readObj, writeObj));
  all.push_back(triangles(FileFormat::Off, "OFF", ".off", "Geomview's polygons, text or binary",
                          isOff, readOff, writeOff));
  all.push_back(triangles(FileFormat::Ply, "PLY", ".ply",
                          "Stanford's polygons and strips, text or binary", isPly, readPly,
                          writePly));
  all.push_back(triangles(FileFormat::ThreeMf, "3MF", ".3mf",
                          "Objects to be printed, placed, with units", isThreeMf, readThreeMf,
                          writeThreeMf));
  all.back().hasFloatCoordinates = true;
  all.push_back(triangles(FileFormat::Amf, "AMF", ".amf",
                          "Objects to be printed, placed, with units", isAmf, readAmf, nullptr));
  all.push_back(triangles(FileFormat::Gltf, "glTF", ".gltf .glb",
                          "Scenes, where the build has assimp", isGltf, readGltf, nullptr));
  all.push_back(triangles(FileFormat::Fbx, "FBX", ".fbx", "Scenes, where the build has assimp",
                          isFbx, readFbx, nullptr));
  all.push_back(triangles(FileFormat::Collada, "COLLADA .dae", ".dae",
                          "Scenes, where the build has assimp", isCollada, readCollada, nullptr));
  all.push_back(triangles(FileFormat::ThreeDs, "3DS", ".3ds", "Scenes, where the build has assimp",
                          isThreeDs, readThreeDs, nullptr));

  // --- solid cells ---
  all.push_back(cellsOrFaces<readGmsh>(FileFormat::Gmsh, "Gmsh .msh", ".msh",
                                       "Versions 1, 2, 4.0 and 4.1", kArrays, isGmsh,
                                       gmshHasSolidCells));
  all.back().isNamed = isDamagedGmsh;
  all.back().writeTets = writeGmsh;
  all.back().spoolCells = spoolGmsh;
  all.push_back(cellsOrFaces<readMedit>(FileFormat::Medit, "Medit .mesh", ".mesh", "GMF as text", 0,
                                        isMedit, meditHasSolidCells));
  all.back().isNamed = isDamagedMedit;
  all.back().writeTets = writeMedit;
  all.push_back(cellsOrFaces<readMeditBinary>(FileFormat::MeditBinary, "Medit .meshb", ".meshb",
                                              "GMF in binary", 0, isMeditBinary,
                                              meditBinaryHasSolidCells));
  all.push_back(cells(FileFormat::TetGen, "TetGen .node and .ele", ".ele .node",
                      "Two files side by side", kTets | kArrays, nullptr, readTetGen));
  all.back().isNamed = isAny;
  all.push_back(cellsOrFaces<readNetgen>(FileFormat::Netgen, "Netgen .vol", ".vol",
                                         "Netgen's meshes", 0, isNetgen, netgenHasSolidCells));
  all.back().isNamed = isDamagedNetgen;
  all.push_back(cellsOrFaces<readAbaqus>(FileFormat::Abaqus, "Abaqus .inp", ".inp",
                                         "Decks of Abaqus and CalculiX", 0, isAbaqus,
                                         abaqusHasSolidCells));
  all.back().isNamed = isDamagedAbaqus;
  all.push_back(cellsOrFaces<readNastran>(FileFormat::Nastran, "Nastran .bdf", ".bdf .nas .fem",
                                          "Bulk data of Nastran and OptiStruct", 0, isNastran,
                                          nastranHasSolidCells));
  all.back().isNamed = isDamagedNastran;
  all.push_back(cellsOrFaces<readUcd>(FileFormat::Ucd, "AVS UCD .inp", ".inp .avs .ucd",
                                      "Unstructured cell data, text or binary", kArrays, isUcd,
                                      ucdHasSolidCells));
  all.push_back(cellsOrFaces<readVtk>(FileFormat::Vtk, "VTK .vtk", ".vtk",
                                      "VTK's legacy grids and polygons, text or binary", kArrays,
                                      isVtk, vtkHasSolidCells));
  all.push_back(cellsOrFaces<readVtu>(FileFormat::Vtu, "VTK .vtu", ".vtu",
                                      "VTK XML unstructured grid", kArrays, isVtu,
                                      vtuHasSolidCells));
  all.back().writeTets = writeVtu;
  all.back().spoolCells = spoolVtu;
  all.push_back(cellsOrFaces<readVtu>(FileFormat::Vts, "VTK .vts", ".vts .vtr",
                                      "VTK XML structured and rectilinear grids", kArrays, isVts,
                                      vtuHasSolidCells));
  all.push_back(cellsOrFaces<readPvtu>(FileFormat::Pvtu, "VTK .pvtu", ".pvtu .pvts .pvtr",
                                       "An index of .vtu, .vts or .vtr pieces", kArrays, isPvtu,
                                       pvtuHasSolidCells));
  all.push_back(triangles(FileFormat::Vtp, "VTK .vtp", ".vtp", "VTK XML polygons and strips", isVtp,
                          readFaces<readVtu>, nullptr));
  all.push_back(cellsOrFaces<readVtm>(FileFormat::Vtm, "VTK .vtm", ".vtm .vtmb",
                                      "Blocks, each a file beside it", kArrays, isVtm,
                                      vtmHasSolidCells));
  all.push_back(row(FileFormat::Pvd, "ParaView .pvd", ".pvd", "A sequence: the files of every step",
                    kTets | kTriangles | kArrays | kSteps));
  all.back().isContent = isPvd;
  all.push_back(
      cellsOrFaces<readXdmf>(FileFormat::Xdmf, "XDMF", ".xdmf .xmf",
                             "XML, with numbers in it, in binary files or in HDF5 files beside it",
                             kArrays | kSteps, isXdmf, xdmfHasSolidCells));
  all.back().readTimes = timesOfXdmf;
  all.back().filesOfStep = filesOfXdmf;
  all.back().spoolCells = spoolXdmf;
  all.push_back(cellsOrFaces<readVtkHdf>(FileFormat::VtkHdf, "VTKHDF", ".vtkhdf .hdf",
                                         "VTK's grids and polygons in HDF5", kArrays | kSteps,
                                         isVtkHdf, vtkHdfHasSolidCells));
  all.back().readTimes = vtkHdfTimes;
  all.push_back(cellsOrFaces<readCgns>(FileFormat::Cgns, "CGNS", ".cgns",
                                       "Zones of flow solvers in HDF5 or ADF", kArrays | kSteps,
                                       isCgns, cgnsHasSolidCells));
  all.back().readTimes = cgnsTimes;
  all.push_back(cellsOrFaces<readEnsight>(FileFormat::Ensight, "EnSight Gold", ".case .encas",
                                          "A case that names the files of every step",
                                          kArrays | kSteps, isEnsight, ensightHasSolidCells));
  all.back().readTimes = ensightTimes;
  all.back().filesOfStep = ensightFiles;
  all.push_back(cellsOrFaces<readFrd>(FileFormat::Frd, "CalculiX .frd", ".frd",
                                      "Results of CalculiX, text or binary", kArrays | kSteps,
                                      isFrd, frdHasSolidCells));
  all.back().readTimes = frdTimes;
  all.push_back(cellsOrFaces<readNeu>(FileFormat::Neu, "Gambit .neu", ".neu",
                                      "Gambit neutral files, as for Fluent", 0, isNeu,
                                      neuHasSolidCells));
  all.push_back(cellsOrFaces<readSu2>(FileFormat::Su2, "SU2 .su2", ".su2",
                                      "Meshes of the flow solver SU2", 0, isSu2, su2HasSolidCells));
  all.push_back(cells(FileFormat::OpenFoam, "OpenFOAM", ".foam .openfoam",
                      "The case in the file's folder, or a system/controlDict",
                      kTets | kArrays | kSteps, isOpenFoam, readOpenFoam));
  all.back().isNamed = isAny;
  all.back().readTimes = openFoamTimes;
  all.back().filesOfStep = openFoamFiles;
  all.push_back(cellsOrFaces<readUnv>(FileFormat::Unv, "I-DEAS .unv", ".unv",
                                      "Universal files, as of Salome and NX", 0, isUnv,
                                      unvHasSolidCells));
  all.push_back(cellsOrFaces<readExodus>(FileFormat::Exodus, "Exodus", ".exo .e .exo2 .g",
                                         "Exodus II in netCDF or HDF5", kArrays | kSteps, isExodus,
                                         exodusHasSolidCells));
  all.back().readTimes = exodusTimes;

  // --- volumes ---
  all.push_back(row(FileFormat::Vdb, "OpenVDB .vdb", ".vdb", "Sparse grids", kVolume | kArrays));
  all.back().isContent = isVdb;
  all.back().readVolume = readVdb;
  all.back().writeVolume = writeVdb;
  all.push_back(
      row(FileFormat::Nvdb, "NanoVDB .nvdb", ".nvdb", "Sparse grids for GPUs", kVolume | kArrays));
  all.back().isContent = isNvdb;
  all.back().readVolume = readNvdb;
  all.back().writeVolume = writeNvdb;

  // --- dense arrays ---
  using namespace arrays;
  all.push_back(
      denseArrays(FileFormat::Npy, "NumPy .npy", ".npy", "One array", isNpy, readNpy, 0, writeNpy));
  all.push_back(denseArrays(FileFormat::Npz, "NumPy .npz", ".npz",
                            "Arrays with their transform, dense or sparse", isNpz, readNpz,
                            kSeveral | kCompressed | kSparse, writeNpz));
  all.push_back(denseArrays(FileFormat::VtkImage, "VTK image .vtk", ".vtk",
                            "VTK's legacy structured points, text or binary", isVtkImage,
                            readVtkImage, 0, nullptr));
  all.push_back(denseArrays(FileFormat::Vti, "VTK .vti", ".vti", "VTK XML image data", isVti,
                            readVti, kSeveral | kCompressed, writeVti));
  all.push_back(denseArrays(FileFormat::Nhdr, "NRRD header", ".nhdr",
                            "One array, whose numbers are in another file", isNhdr, readNrrd, 0,
                            nullptr));
  all.push_back(denseArrays(FileFormat::Nrrd, "NRRD", ".nrrd", "One array, for ITK and 3D Slicer",
                            isNrrd, readNrrd, kCompressed, writeNrrd));
  all.push_back(denseArrays(FileFormat::MetaImage, "MetaImage", ".mha .mhd", "One array, of ITK",
                            isMetaImage, readMetaImage, 0, nullptr));
  all.push_back(denseArrays(FileFormat::Nifti, "NIfTI", ".nii",
                            "A medical image, also packed (.nii.gz)", isNifti, readNifti, 0,
                            nullptr));
  all.push_back(denseArrays(FileFormat::Hdf5, "HDF5", ".h5 .hdf5",
                            "A dataset a grid, with attributes", isHdf5, readHdf5Arrays,
                            kSeveral | kCompressed, writeHdf5));
  all.push_back(denseArrays(FileFormat::Tiff, "TIFF", ".tif .tiff", "A stack of pages, for ImageJ",
                            isTiff, readTiff, kCompressed, writeTiff));
  all.push_back(denseArrays(FileFormat::Raw, "raw", ".raw", "Numbers, and a header in JSON beside",
                            nullptr, readRaw, kSeveral, writeRaw));
  all.back().isNamed = isAny;
  all.push_back(denseArrays(FileFormat::Binvox, "binvox", ".binvox", "A mask in runs", isBinvox,
                            readBinvox, kMask, writeBinvox));
  return all;
}

} // namespace

const std::vector<Format>& formats() {
  static const std::vector<Format> table = makeTable();
  return table;
}

const Format& formatOf(FileFormat format) {
  static const Format unknown = row(FileFormat::Unknown, "unknown", "", "", 0);
  for (const Format& row : formats())
    if (row.id == format)
      return row;
  return unknown;
}

std::string_view formatName(FileFormat format) {
  return formatOf(format).name;
}

bool can(const Format& format, FormatUse use) {
  switch (use) {
  case FormatUse::ReadCells:
    return format.readCells != nullptr;
  case FormatUse::SpoolCells:
    return format.spoolCells != nullptr;
  case FormatUse::ReadTriangles:
    return format.readTriangles != nullptr;
  case FormatUse::ReadMesh:
    return (format.holds & (kTets | kTriangles)) != 0;
  case FormatUse::ReadVolume:
    return format.readVolume != nullptr || format.readArrays != nullptr;
  case FormatUse::ReadArrays:
    return format.readArrays != nullptr;
  case FormatUse::ReadSteps:
    return format.readTimes != nullptr;
  case FormatUse::WriteTets:
    return format.writeTets != nullptr;
  case FormatUse::WriteTriangles:
    return format.writeTriangles != nullptr;
  case FormatUse::WriteVolume:
    return format.writeVolume != nullptr;
  case FormatUse::WriteArrays:
    return format.writeArrays != nullptr;
  }
  return false;
}

std::vector<std::string> endingsOf(const Format& format) {
  std::vector<std::string> endings;
  for (std::string_view rest = format.endings; !rest.empty();) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    endings.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return endings;
}

std::vector<std::string> endingsFor(FormatUse use) {
  std::vector<std::string> endings;
  for (const Format& format : formats())
    if (can(format, use))
      for (std::string& ending : endingsOf(format))
        if (std::find(endings.begin(), endings.end(), ending) == endings.end())
          endings.push_back(std::move(ending));
  return endings;
}

std::string endingList(FormatUse use, std::string_view lastWord) {
  const std::vector<std::string> endings = endingsFor(use);
  std::string text;
  for (std::size_t i = 0; i < endings.size(); ++i) {
    if (i > 0)
      text += i + 1 < endings.size() ? ", " : " " + std::string(lastWord) + " ";
    text += endings[i];
  }
  return text;
}

std::string endingOf(std::string_view path) {
  const std::size_t dot = path.find_last_of("./");
  if (dot == path.npos || path[dot] == '/' || dot == 0 || path[dot - 1] == '/')
    return {};
  return lowerCase(path.substr(dot));
}

const Format* formatForEnding(std::string_view path, FormatUse use) {
  const std::string ending = endingOf(path);
  for (const Format& format : formats()) {
    const std::vector<std::string> endings = endingsOf(format);
    if (can(format, use) && std::find(endings.begin(), endings.end(), ending) != endings.end())
      return &format;
  }
  return nullptr;
}

FileFormat sniffFormat(std::string_view bytes, const std::string& path) {
  const FileStart start(bytes, path);
  for (const Format& format : formats())
    if (format.isContent != nullptr && format.isContent(start))
      return format.id;
  for (const Format& format : formats()) {
    const std::vector<std::string> endings = endingsOf(format);
    if (format.isNamed != nullptr &&
        std::find(endings.begin(), endings.end(), start.ending) != endings.end() &&
        format.isNamed(start))
      return format.id;
  }
  return FileFormat::Unknown;
}

std::string describeUnknownFormat(std::string_view bytes, const std::string& path) {
  const FileStart file(bytes, path);
  const auto begins = [&](std::string_view start) {
    return file.head.substr(0, start.size()) == start;
  };
  const auto contains = [&](std::string_view part) {
    return file.head.find(part) != std::string_view::npos;
  };
  const FileFormat found = sniffFormat(bytes, path);
  const Format& format = formatOf(found);
  const std::string name(format.name);
  if (begins(" BDV") && !can(format, FormatUse::ReadVolume))
    return "is an OpenVDB volume, cut off";
  if (found == FileFormat::Hdf5)
    return "is HDF5, but no mesh of its formats: name the .xdmf file beside it, if there is one "
           "('tetvdb "
           "convert' makes a volume of its arrays)";
  if (can(format, FormatUse::ReadVolume))
    return "is a volume (" + name + "), not a mesh ('tetvdb convert' writes it as .vdb)";
  if (format.readTriangles != nullptr && format.readCells == nullptr)
    return "holds triangles (" + name + "), not solid cells";
  if (format.readCells != nullptr)
    return "is a file of cells (" + name + "), not of triangles";
  if (found != FileFormat::Unknown)
    return "is a sequence of other files (" + name + "), not a mesh";
  if (file.ending == ".face" || file.ending == ".poly" || file.ending == ".smesh")
    return "is a TetGen " + file.ending + " file, a surface; name the .node or .ele file";
  if (begins("PK\x03\x04"))
    return "is a ZIP archive; unpack it";
  if (begins("\x1f\x8b"))
    return "is compressed with gzip; unpack it";
  if (begins("BZh") ||
      begins("\xfd"
             "7zXZ") ||
      begins("\x28\xb5\x2f\xfd"))
    return "is compressed; unpack it";
  if (file.start.rfind("iso-10303-21", 0) == 0)
    return "is a STEP model (CAD surfaces); mesh it first";
  if (file.ending == ".msh" && begins("("))
    return "is a Fluent mesh, which is not read; convert it to .vtu or Gmsh's .msh";
  if (begins("MFEM "))
    return "is an MFEM mesh, which is not read; write it as .vtk (mfem::Mesh::PrintVTK)";
  if (begins("libMesh"))
    return "is a libMesh file, which is not read; convert it to Exodus or .msh (meshtool)";
  if (file.ending == ".unv" || file.ending == ".su2")
    return "is a " + file.ending + " mesh, which is not read; convert it to .vtu or .msh";
  if (file.start.rfind("<?xml", 0) == 0 || file.start.rfind("<vtkfile", 0) == 0)
    return contains("VTKFile") ? "is a VTK file of another kind than grids and polygons"
                               : "is an XML file of an unknown kind";
  return isText(file.head) ? "is not a mesh format that is known (text)"
                           : "is not a mesh format that is known (binary data)";
}

} // namespace tetvdb
