// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/FormatSignatures.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/formats/off/OffReader.h"
#include "tetvdb/io/formats/stl/StlReader.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/GunzipBytes.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <iterator>

namespace tetvdb {
namespace {

constexpr std::size_t kLook = 4096; // bytes that are read

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::string_view withoutMarkAndSpace(std::string_view text) {
  if (startsWith(text, "\xef\xbb\xbf"))
    text.remove_prefix(3);
  while (!text.empty() && static_cast<unsigned char>(text[0]) <= ' ')
    text.remove_prefix(1);
  return text;
}

bool isLegacyVtk(const FileStart& file) {
  return startsWith(file.start, "# vtk datafile") || startsWith(file.start, "#vtk datafile");
}

bool isVtkXml(const FileStart& file) {
  return startsWith(file.start, "<?xml") || startsWith(file.start, "<vtkfile") ||
         startsWith(file.start, "<!--");
}
/// Whether its type is `type`.
bool isVtkXmlOf(const FileStart& file, const std::string& type) {
  return isVtkXml(file) && contains(file.head, "<VTKFile") &&
         (contains(file.head, '"' + type + '"') || contains(file.head, "'" + type + "'"));
}

/// By the name of a group, which is near the beginning of most files, or by the file's ending.
bool isHdf5With(const FileStart& file, std::string_view group, std::string_view ending) {
  constexpr std::size_t look = std::size_t(1) << 20;
  return startsWith(file.head, "\x89HDF\r\n") &&
         (file.ending == ending || contains(file.bytes.substr(0, look), group));
}

/// Names are at the beginning of a ZIP archive and in its directory at the end.
bool isZipWith(const FileStart& file, std::string_view name) {
  constexpr std::size_t directory = 65536;
  return startsWith(file.head, "PK\x03\x04") &&
         (contains(file.head, name) ||
          contains(file.bytes.substr(file.bytes.size() - std::min(file.bytes.size(), directory)),
                   name));
}

/// The first word of the file, after comments that begin with '#'.
std::string_view firstWord(const FileStart& file) {
  NumberParser words(file.head, "", '#');
  return words.word();
}

} // namespace

FileStart::FileStart(std::string_view all, const std::string& path)
    : bytes(all), head(all.substr(0, kLook)), text(withoutMarkAndSpace(head)),
      start(lowerCase(text.substr(0, 32))), ending(endingOf(path)) {}

bool isText(std::string_view head) {
  return std::none_of(head.begin(), head.end(), [](char c) {
    return static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\r' && c != '\t' && c != '\f';
  });
}

// --- Volumes ------------------------------------------------------------------------------------

bool isVdb(const FileStart& file) {
  return startsWith(file.head, std::string_view(" BDV\0\0\0\0", 8));
}

bool isNvdb(const FileStart& file) {
  return startsWith(file.head, "NanoVDB");
}

bool isNpy(const FileStart& file) {
  return startsWith(file.head, "\x93NUMPY");
}

bool isNpz(const FileStart& file) {
  return isZipWith(file, ".npy");
}

bool isVtkImage(const FileStart& file) {
  return isLegacyVtk(file) && contains(lowerCase(file.head), "dataset structured_points");
}

bool isVti(const FileStart& file) {
  return isVtkXmlOf(file, "ImageData");
}

bool isNhdr(const FileStart& file) {
  return isNrrd(file) && file.ending == ".nhdr";
}

bool isNrrd(const FileStart& file) {
  return startsWith(file.head, "NRRD000");
}

/// Of no other format: the last of those in HDF5.
bool isHdf5(const FileStart& file) {
  return startsWith(file.head, "\x89HDF\r\n");
}

bool isMetaImage(const FileStart& file) {
  return (startsWith(file.start, "objecttype") || startsWith(file.start, "ndims")) &&
         contains(file.head, "ElementDataFile");
}

/// As it is, or packed with gzip.
bool isNifti(const FileStart& file) {
  constexpr std::size_t magic = 344, look = magic + 4;
  std::string_view head = file.head;
  std::string unpacked;
  if (startsWith(head, "\x1f\x8b")) {
    try {
      unpacked = gunzip(head, look, "");
    } catch (const Error&) {
      return false;
    }
    head = unpacked;
  }
  return head.size() >= look &&
         (startsWith(head.substr(magic), "n+1") || startsWith(head.substr(4), "n+2"));
}

bool isTiff(const FileStart& file) {
  using namespace std::string_view_literals;
  for (const std::string_view magic : {"II*\0"sv, "MM\0*"sv, "II+\0"sv, "MM\0+"sv})
    if (startsWith(file.head, magic))
      return true;
  return false;
}

bool isBinvox(const FileStart& file) {
  return startsWith(file.head, "#binvox");
}

// --- Triangles ----------------------------------------------------------------------------------

bool isStl(const FileStart& file) {
  return isBinaryStlBySize(file.bytes) ||
         (startsWith(file.start, "solid") && isTextStl(file.bytes));
}

/// Whether every line begins with a word of OBJ files, including a vertex or a face.
bool isObj(const FileStart& file) {
  constexpr std::string_view known[] = {"v", "vt", "vn", "vp",     "f",      "l", "p",
                                        "g", "o",  "s",  "mtllib", "usemtl", "mg"};
  bool found = false;
  NumberParser in(file.text, "", '#');
  while (!in.atEnd()) {
    const std::string_view word = in.word();
    if (std::find(std::begin(known), std::end(known), word) == std::end(known))
      return found && in.atEnd(); // the last word may be truncated
    double number = 0;
    found = found || ((word == "v" || word == "f") && in.tryReal(number));
    for (std::string_view rest = in.line(); !rest.empty() && rest.back() == '\\';)
      rest = in.line();
  }
  return found;
}

bool isOff(const FileStart& file) {
  NumberParser words(file.bytes, "", '#');
  words.seek(static_cast<std::size_t>(file.text.data() - file.bytes.data()));
  words.skipSpace();
  return hasOffKeyword(file.bytes.substr(words.position()));
}

bool isPly(const FileStart& file) {
  return startsWith(file.text, "ply\n") || startsWith(file.text, "ply\r");
}

bool isThreeMf(const FileStart& file) {
  return isZipWith(file, ".model");
}

bool isAmf(const FileStart& file) {
  return (startsWith(file.text, "<") &&
          (contains(file.head, "<amf") || contains(file.head, "<AMF"))) ||
         isZipWith(file, ".amf");
}

bool isGltf(const FileStart& file) {
  return startsWith(file.head, "glTF") ||
         (startsWith(file.text, "{") && contains(file.head, "\"asset\""));
}

bool isFbx(const FileStart& file) {
  return startsWith(file.head, "Kaydara FBX") || startsWith(file.text, "; FBX");
}

bool isCollada(const FileStart& file) {
  return startsWith(file.text, "<") && contains(file.head, "<COLLADA");
}

// The main chunk, of which the first is the version or the editor's data.
bool isThreeDs(const FileStart& file) {
  return startsWith(file.head, "MM") && file.head.size() >= 8 &&
         (file.head.substr(6, 2) == std::string_view("\x02\0", 2) ||
          file.head.substr(6, 2) == "==");
}

// --- Solid cells --------------------------------------------------------------------------------

bool isGmsh(const FileStart& file) {
  for (const char* section : {"$MeshFormat", "$NOD", "$Comments", "$PhysicalNames", "$Nodes"})
    if (startsWith(file.text, section))
      return true;
  return false;
}

bool isMedit(const FileStart& file) {
  return firstWord(file) == "MeshVersionFormatted";
}

bool isMeditBinary(const FileStart& file) {
  if (file.bytes.size() < 8)
    return false;
  for (const bool swap : {false, true})
    if (loadNumber<std::int32_t>(file.bytes.data(), swap) == 1) {
      const auto version = loadNumber<std::int32_t>(file.bytes.data() + 4, swap);
      return version >= 1 && version <= 4;
    }
  return false;
}

bool isNetgen(const FileStart& file) {
  return firstWord(file) == "mesh3d";
}

bool isAbaqus(const FileStart& file) {
  return startsWith(file.text, "*");
}

/// The control section may be long.
bool isNastran(const FileStart& file) {
  if (!isText(file.head))
    return false;
  const std::string start = lowerCase(file.bytes.substr(0, std::size_t(1) << 16));
  return contains(start, "begin bulk") || contains(start, "begin,bulk") ||
         (contains(start, "\ngrid") && contains(start, "enddata"));
}

/// The binary form by its first byte; the text by comments and then five integers: nodes, cells,
/// and data components of three kinds. Both require one of the usual names.
bool isUcd(const FileStart& file) {
  if (file.ending != ".inp" && file.ending != ".avs" && file.ending != ".ucd")
    return false;
  if (startsWith(file.head, "\x07"))
    return true;
  NumberParser in(file.head, "", '#');
  std::int64_t number = 0;
  for (int i = 0; i < 5; ++i)
    if (!in.tryInteger(number) || number < 0)
      return false;
  return true;
}

bool isVtk(const FileStart& file) {
  return isLegacyVtk(file) && !isVtkImage(file);
}

bool isVtu(const FileStart& file) {
  return isVtkXml(file) && contains(file.head, "UnstructuredGrid") &&
         !contains(file.head, "PUnstructuredGrid");
}

bool isVts(const FileStart& file) {
  return isVtkXmlOf(file, "StructuredGrid") || isVtkXmlOf(file, "RectilinearGrid");
}

bool isPvtu(const FileStart& file) {
  return isVtkXml(file) &&
         (contains(file.head, "PUnstructuredGrid") || isVtkXmlOf(file, "PStructuredGrid") ||
          isVtkXmlOf(file, "PRectilinearGrid"));
}

bool isVtp(const FileStart& file) {
  return isVtkXmlOf(file, "PolyData");
}

bool isVtm(const FileStart& file) {
  return isVtkXml(file) && (contains(file.head, "vtkMultiBlockDataSet") ||
                            contains(file.head, "vtkPartitionedDataSetCollection"));
}

bool isPvd(const FileStart& file) {
  return isVtkXml(file) && contains(file.head, "<VTKFile") && contains(file.head, "<Collection");
}

bool isXdmf(const FileStart& file) {
  return startsWith(file.text, "<") && contains(lowerCase(file.head), "<xdmf");
}

bool isVtkHdf(const FileStart& file) {
  return isHdf5With(file, "VTKHDF", ".vtkhdf");
}

bool isCgns(const FileStart& file) {
  return isHdf5With(file, "CGNSLibraryVersion", ".cgns") ||
         contains(file.head.substr(0, 64), "ADF Database");
}

bool isEnsight(const FileStart& file) {
  // "FORMAT", then "type: ensight gold"; comments may come first.
  const std::string head = lowerCase(file.head);
  const std::size_t type = head.find("type:");
  return isText(file.head) && type != head.npos && head.find("format") < type &&
         contains(std::string_view(head).substr(type, 64), "ensight");
}

bool isFrd(const FileStart& file) {
  return startsWith(file.head, "    1C") || startsWith(file.head, "    1U") ||
         startsWith(file.head, "    2C");
}

bool isNeu(const FileStart& file) {
  return contains(file.head.substr(0, 512), "CONTROL INFO") &&
         contains(file.head.substr(0, 512), "GAMBIT NEUTRAL");
}

bool isSu2(const FileStart& file) {
  return isText(file.head) && (contains(file.head, "NDIME=") || contains(file.head, "NDIME ="));
}

/// A `controlDict`; a .foam file is known by its name.
bool isOpenFoam(const FileStart& file) {
  return isText(file.head) && contains(file.head, "FoamFile") && contains(file.head, "controlDict");
}

/// A line "-1", and one with a number.
bool isUnv(const FileStart& file) {
  NumberParser in(file.head, "");
  std::int64_t first = 0, number = 0;
  return isText(file.head) && in.tryInteger(first) && first == -1 && trimmed(in.line()).empty() &&
         in.tryInteger(number) && number > 0;
}

/// HDF5 of no other format, but for arrays, which are told by their endings and lack the count of
/// nodes.
bool isExodus(const FileStart& file) {
  const bool isArrays = file.ending == ".h5" || file.ending == ".hdf5";
  return startsWith(file.head, "CDF\x01") || startsWith(file.head, "CDF\x02") ||
         startsWith(file.head, "CDF\x05") ||
         isHdf5With(file, "num_nod", isArrays ? "none" : file.ending);
}

// --- By the name --------------------------------------------------------------------------------

bool isAny(const FileStart&) {
  return true;
}

bool isDamagedGmsh(const FileStart& file) {
  return contains(file.head, "$Nodes");
}

bool isDamagedMedit(const FileStart& file) {
  return isText(file.head) && contains(file.head, "Vertices");
}

bool isDamagedNetgen(const FileStart& file) {
  return contains(file.head, "dimension");
}

bool isDamagedAbaqus(const FileStart& file) {
  return contains(lowerCase(file.head), "*node");
}

bool isDamagedNastran(const FileStart& file) {
  return isText(file.head);
}

} // namespace tetvdb
