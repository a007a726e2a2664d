// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/ByteReader.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/NumberParser.h"
#include "tetvdb/io/OffReader.h"
#include "tetvdb/io/StlReader.h"
#include "tetvdb/io/TriangleReader.h"

#include <algorithm>
#include <cctype>
#include <utility>

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

/// A 3MF file is a ZIP archive that holds a model; names stand at its beginning and in its
/// directory at the end.
bool is3mf(std::string_view bytes) {
  constexpr std::size_t directory = 65536;
  return startsWith(bytes, "PK\x03\x04") &&
         (contains(bytes.substr(0, kLook), ".model") ||
          contains(bytes.substr(bytes.size() - std::min(bytes.size(), directory)), ".model"));
}

/// Whether every line begins with a word of OBJ files, a vertex or a face among them.
bool isObj(std::string_view head) {
  constexpr std::string_view known[] = {"v", "vt", "vn", "vp",     "f",      "l", "p",
                                        "g", "o",  "s",  "mtllib", "usemtl", "mg"};
  bool found = false;
  NumberParser in(head, "", '#');
  while (!in.atEnd()) {
    const std::string_view word = in.word();
    if (std::find(std::begin(known), std::end(known), word) == std::end(known))
      return found && in.atEnd(); // a word that was cut off where looking ends
    double number = 0;
    found = found || ((word == "v" || word == "f") && in.tryReal(number));
    for (std::string_view rest = in.line(); !rest.empty() && rest.back() == '\\';)
      rest = in.line();
  }
  return found;
}

MeshFormat sniffTriangles(std::string_view bytes, std::string_view text,
                          const std::string& ending) {
  const std::string_view head = bytes.substr(0, kLook);
  if (startsWith(head, "glTF") || (startsWith(text, "{") && contains(head, "\"asset\"")))
    return MeshFormat::Gltf;
  if (startsWith(head, "Kaydara FBX") || startsWith(text, "; FBX"))
    return MeshFormat::Fbx;
  if (startsWith(text, "ply\n") || startsWith(text, "ply\r"))
    return MeshFormat::Ply;
  if (startsWith(text, "<") && contains(head, "<COLLADA"))
    return MeshFormat::Collada;
  if (is3mf(bytes))
    return MeshFormat::ThreeMf;
  if (startsWith(lowered(text.substr(0, 5)), "solid") && isTextStl(bytes))
    return MeshFormat::Stl;
  NumberParser words(bytes, "", '#');
  words.seek(bytes.size() - text.size());
  words.skipSpace();
  if (hasOffKeyword(bytes.substr(words.position())))
    return MeshFormat::Off;
  if (ending == "obj" || isObj(text))
    return MeshFormat::Obj;
  return MeshFormat::Unknown;
}

/// By the name, where the content says nothing.
MeshFormat triangleFormatOf(std::string_view ending) {
  constexpr std::pair<std::string_view, MeshFormat> endings[] = {
      {"stl", MeshFormat::Stl},     {"off", MeshFormat::Off},    {"ply", MeshFormat::Ply},
      {"3mf", MeshFormat::ThreeMf}, {"glb", MeshFormat::Gltf},   {"gltf", MeshFormat::Gltf},
      {"fbx", MeshFormat::Fbx},     {"dae", MeshFormat::Collada}};
  for (const auto& [known, format] : endings)
    if (known == ending)
      return format;
  return MeshFormat::Unknown;
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
  case MeshFormat::Xdmf:
    return "XDMF";
  case MeshFormat::Stl:
    return "STL";
  case MeshFormat::Obj:
    return "OBJ";
  case MeshFormat::Off:
    return "OFF";
  case MeshFormat::Ply:
    return "PLY";
  case MeshFormat::ThreeMf:
    return "3MF";
  case MeshFormat::Gltf:
    return "glTF";
  case MeshFormat::Fbx:
    return "FBX";
  case MeshFormat::Collada:
    return "COLLADA .dae";
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
  if (isBinaryStlBySize(bytes))
    return MeshFormat::Stl;
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
  if (const MeshFormat triangles = sniffTriangles(bytes, text, ending);
      triangles != MeshFormat::Unknown)
    return triangles;
  if (startsWith(text, "<") && contains(lowered(head), "<xdmf"))
    return MeshFormat::Xdmf;
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
  return triangleFormatOf(ending);
}

std::string describeUnknownFormat(std::string_view bytes, const std::string& path) {
  const std::string_view head = bytes.substr(0, kLook);
  const std::string ending = extension(path);
  const std::string start = lowered(head.substr(0, 32));
  if (const MeshFormat format = sniffMeshFormat(bytes, path); holdsTriangles(format))
    return "holds triangles (" + std::string(formatName(format)) + "), not solid cells";
  if (startsWith(head, " BDV"))
    return "is an OpenVDB volume, not a mesh";
  if (startsWith(head, "NanoVDB"))
    return "is a NanoVDB volume, not a mesh";
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
