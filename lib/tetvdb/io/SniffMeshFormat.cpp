// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/ByteReader.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/NumberParser.h"

#include <algorithm>
#include <cctype>

namespace tetvdb {
namespace {

constexpr std::size_t kLook = 4096; // bytes that are looked at

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// "vtu" of "a/b.vtu"; empty where there is none.
std::string extension(const std::string& path) {
  const std::size_t slash = path.find_last_of('/');
  const std::size_t dot = path.find_last_of('.');
  if (dot == path.npos || (slash != path.npos && dot < slash))
    return {};
  return lowered(std::string_view(path).substr(dot + 1));
}

bool isText(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t' && c != '\f';
  });
}

bool isMeditBinary(std::string_view bytes) {
  if (bytes.size() < 8)
    return false;
  for (const bool swap : {false, true})
    if (loadNumber<std::int32_t>(bytes.data(), swap) == 1) {
      const auto version = loadNumber<std::int32_t>(bytes.data() + 4, swap);
      return version >= 1 && version <= 4;
    }
  return false;
}

/// Comments, then five whole numbers: nodes, cells, and data components of three kinds.
bool isUcd(std::string_view head) {
  NumberParser in(head, "", '#');
  std::int64_t number = 0;
  for (int i = 0; i < 5; ++i)
    if (!in.tryInteger(number) || number < 0)
      return false;
  return true;
}

} // namespace

std::string_view formatName(MeshFormat format) {
  switch (format) {
  case MeshFormat::Gmsh:
    return "Gmsh .msh";
  case MeshFormat::Medit:
    return "Medit .mesh";
  case MeshFormat::MeditBinary:
    return "Medit .meshb";
  case MeshFormat::TetGen:
    return "TetGen .node and .ele";
  case MeshFormat::Netgen:
    return "Netgen .vol";
  case MeshFormat::Abaqus:
    return "Abaqus .inp";
  case MeshFormat::Ucd:
    return "AVS UCD .inp";
  case MeshFormat::Vtk:
    return "VTK .vtk";
  case MeshFormat::Vtu:
    return "VTK .vtu";
  case MeshFormat::Pvtu:
    return "VTK .pvtu";
  case MeshFormat::Exodus:
    return "Exodus";
  case MeshFormat::Unknown:
    break;
  }
  return "unknown";
}

MeshFormat sniffMeshFormat(std::string_view bytes, const std::string& path) {
  const std::string_view head = bytes.substr(0, kLook);
  const std::string ending = extension(path);
  if (startsWith(head, "CDF\x01") || startsWith(head, "CDF\x02") || startsWith(head, "CDF\x05") ||
      startsWith(head, "\x89HDF\r\n"))
    return MeshFormat::Exodus;
  if (isMeditBinary(head))
    return MeshFormat::MeditBinary;
  if (startsWith(head, "\x07") && (ending == "inp" || ending == "avs" || ending == "ucd"))
    return MeshFormat::Ucd; // the binary form

  std::string_view text = head;
  if (startsWith(text, "\xef\xbb\xbf"))
    text.remove_prefix(3);
  while (!text.empty() && static_cast<unsigned char>(text[0]) <= ' ')
    text.remove_prefix(1);
  const std::string start = lowered(text.substr(0, 24));
  if (startsWith(start, "# vtk datafile") || startsWith(start, "#vtk datafile"))
    return MeshFormat::Vtk;
  if (startsWith(start, "<?xml") || startsWith(start, "<vtkfile") || startsWith(start, "<!--")) {
    if (contains(head, "PUnstructuredGrid"))
      return MeshFormat::Pvtu;
    if (contains(head, "UnstructuredGrid"))
      return MeshFormat::Vtu;
    return MeshFormat::Unknown;
  }
  for (const char* section : {"$MeshFormat", "$NOD", "$Comments", "$PhysicalNames", "$Nodes"})
    if (startsWith(text, section))
      return MeshFormat::Gmsh;
  NumberParser words(head, "", '#');
  const std::string_view first = words.word();
  if (first == "MeshVersionFormatted")
    return MeshFormat::Medit;
  if (first == "mesh3d")
    return MeshFormat::Netgen;
  if (startsWith(text, "*"))
    return MeshFormat::Abaqus;
  if (ending == "node" || ending == "ele")
    return MeshFormat::TetGen;
  if ((ending == "inp" || ending == "avs" || ending == "ucd") && isUcd(head))
    return MeshFormat::Ucd;
  // Damaged beyond its first words: the reader says what is wrong.
  if (ending == "mesh" && isText(head) && contains(head, "Vertices"))
    return MeshFormat::Medit;
  if (ending == "vol" && contains(head, "dimension"))
    return MeshFormat::Netgen;
  if (ending == "msh" && contains(head, "$Nodes"))
    return MeshFormat::Gmsh;
  if (ending == "inp" && contains(lowered(head), "*node"))
    return MeshFormat::Abaqus;
  return MeshFormat::Unknown;
}

std::string describeUnknownFormat(std::string_view bytes, const std::string& path) {
  const std::string_view head = bytes.substr(0, kLook);
  const std::string ending = extension(path);
  const std::string start = lowered(head.substr(0, 32));
  const auto triangles = [](const char* what) {
    return std::string("holds triangles (") + what + "), not solid cells";
  };
  if (startsWith(head, " BDV"))
    return "is an OpenVDB volume, not a mesh";
  if (startsWith(head, "NanoVDB"))
    return "is a NanoVDB volume, not a mesh";
  if (startsWith(start, "solid") || ending == "stl")
    return triangles("STL");
  if (startsWith(start, "ply"))
    return triangles("PLY");
  if (startsWith(start, "off") || startsWith(start, "coff"))
    return triangles("OFF");
  if (startsWith(head, "glTF") || ending == "gltf")
    return triangles("glTF");
  if (startsWith(start, "kaydara fbx"))
    return triangles("FBX");
  if (ending == "obj")
    return triangles("OBJ");
  if (ending == "3mf")
    return triangles("3MF");
  if (ending == "face" || ending == "poly" || ending == "smesh")
    return "is a TetGen ." + ending + " file, a surface; name the .node or .ele file";
  if (startsWith(head, "PK\x03\x04"))
    return "is a ZIP archive; unpack it";
  if (startsWith(head, "\x1f\x8b"))
    return "is compressed with gzip; unpack it";
  if (startsWith(head, "BZh") ||
      startsWith(head, "\xfd"
                       "7zXZ") ||
      startsWith(head, "\x28\xb5\x2f\xfd"))
    return "is compressed; unpack it";
  if (startsWith(start, "iso-10303-21"))
    return "is a STEP model (CAD surfaces); mesh it first";
  if (ending == "msh" && startsWith(head, "("))
    return "is a Fluent mesh, which is not read; convert it to .vtu or Gmsh's .msh";
  if (contains(head, "BEGIN BULK") || ending == "bdf" || ending == "nas")
    return "is a Nastran deck, which is not read; convert it to .vtu or .msh";
  if (startsWith(start, "<?xml") || startsWith(start, "<vtkfile"))
    return contains(head, "VTKFile") ? "is a VTK file of another kind than UnstructuredGrid"
                                     : "is an XML file of an unknown kind";
  return isText(head) ? "is not a mesh format that is known (text)"
                      : "is not a mesh format that is known (binary data)";
}

} // namespace tetvdb
