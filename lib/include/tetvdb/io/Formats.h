// SPDX-License-Identifier: Apache-2.0
//
// The file formats, one row each. Opening, messages, help texts, folder scans, the add-ons, the
// documents' test and the fuzz targets read this table: a new format is a reader or writer, a
// sample for its tests, a fuzz target and a row.
//
//   const tetvdb::Format& format = tetvdb::formatOf(tetvdb::sniffFormat(bytes, path));
//   if (can(format, tetvdb::FormatUse::ReadCells)) ...
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/io/source/FileFormat.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

struct ArrayContent; // io/volume/arrays/ArrayWriters.h
struct CellMesh;
struct FileStart; // io/FormatSignatures.h
struct ReadOptions;
struct Source;
struct TetMesh;
struct TriangleMesh;
class Volume;

/// What files of a format may hold: a sum of these.
namespace holds {
constexpr unsigned kTets = 1;      ///< tetrahedra or other solid cells
constexpr unsigned kTriangles = 2; ///< triangles or polygons
constexpr unsigned kVolume = 4;    ///< voxels
constexpr unsigned kArrays = 8;    ///< named values on points, cells or voxels
constexpr unsigned kSteps = 16;    ///< several steps of time
} // namespace holds

/// One file format. Null functions: not read, not written.
struct Format {
  FileFormat id = FileFormat::Unknown;
  std::string_view name;        ///< for messages and reports: "Gmsh .msh"
  std::string_view endings;     ///< lower case, the usual one first: ".gltf .glb"
  std::string_view description; ///< one line, without a full stop
  unsigned holds = 0;

  /// Whether the content is that of this format. Null: only the name tells.
  bool (*isContent)(const FileStart&) = nullptr;
  /// Whether a file whose name has one of the endings, and whose content is that of no format, is
  /// taken for this one; its reader says what is wrong with it. Null: it is not.
  bool (*isNamed)(const FileStart&) = nullptr;

  CellMesh (*readCells)(const Source&, const ReadOptions&, Report&, Progress&) = nullptr;
  TriangleMesh (*readTriangles)(const Source&, Report&, Progress&) = nullptr;
  Volume (*readVolume)(const std::string& path, Progress&) = nullptr;
  /// Of formats that hold both, and of these only: whether a file has solid cells. Looks at the
  /// kinds of cells, at the first solid one where they stand in turn, and at no values; throws
  /// where it cannot tell.
  bool (*hasSolidCells)(const Source&, Report&, Progress&) = nullptr;
  /// The times of a file's steps in their order; empty where it has none. Null where kSteps is not
  /// in `holds`, and for files that name others (.pvd).
  std::vector<double> (*readTimes)(const Source&, Report&, Progress&) = nullptr;

  void (*writeTets)(const std::string& path, const TetMesh&, Progress&) = nullptr;
  void (*writeTriangles)(const std::string& path, const TriangleMesh&, Progress&) = nullptr;
  void (*writeVolume)(const std::string& path, const Volume&, Progress&) = nullptr;
  void (*writeArrays)(const ArrayContent&, Progress&) = nullptr;
  unsigned arrays = 0; ///< of a format of arrays: what io/volume/arrays/ArrayFormats.h names
};

/// What may be done with files of a format.
enum class FormatUse : std::uint8_t {
  ReadCells,
  ReadTriangles,
  ReadMesh, ///< cells or triangles, or a sequence of such files
  ReadVolume,
  ReadSteps, ///< several steps in one file
  WriteTets,
  WriteTriangles,
  WriteVolume,
  WriteArrays ///< dense arrays of a volume
};

/// All rows, in the order in which content is looked at.
const std::vector<Format>& formats();

/// The row of a format; that of Unknown has no endings and can nothing.
const Format& formatOf(FileFormat format);

/// "Gmsh .msh" and so on; "unknown".
std::string_view formatName(FileFormat format);

bool can(const Format& format, FormatUse use);

/// A row's endings, each on its own.
std::vector<std::string> endingsOf(const Format& format);

/// The endings of all formats with that use, each once, in the table's order.
std::vector<std::string> endingsFor(FormatUse use);

/// The same as text: ".msh, .mesh or .vtu".
std::string endingList(FormatUse use, std::string_view lastWord = "or");

/// ".vtu" of "a/b.VTU"; empty where the name has no ending (".vtu" alone has none).
std::string endingOf(std::string_view path);

/// The format that has the use and to one of whose endings `path` ends, in any case; null where
/// there is none.
const Format* formatForEnding(std::string_view path, FormatUse use);

/// The format of a file by its first bytes; its name decides only what the content leaves open
/// (TetGen's .node and .ele have no signature). Unknown where neither tells.
FileFormat sniffFormat(std::string_view bytes, const std::string& path);

/// What a file that is no mesh of solid cells looks like, as the end of a sentence: "holds
/// triangles (STL), not solid cells".
std::string describeUnknownFormat(std::string_view bytes, const std::string& path);

} // namespace tetvdb
