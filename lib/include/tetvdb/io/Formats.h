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
struct ArraySink;    // io/volume/arrays/StoredArray.h
struct CellMesh;
struct FileStart; // io/FormatSignatures.h
struct ReadOptions;
struct Source;
class SpooledMesh; // mesh/SpooledMesh.h
struct TetMesh;
struct TriangleMesh;
class Volume;

/// The content of a format's files: a sum of these values.
namespace holds {
constexpr unsigned kTets = 1;      ///< tetrahedra or other solid cells
constexpr unsigned kTriangles = 2; ///< triangles or polygons
constexpr unsigned kVolume = 4;    ///< voxels
constexpr unsigned kArrays = 8;    ///< named values on points, cells or voxels
constexpr unsigned kSteps = 16;    ///< several time steps
} // namespace holds

/// One file format. Null functions: not read, or not written.
struct Format {
  FileFormat id = FileFormat::Unknown;
  std::string_view name;        ///< for messages and reports: "Gmsh .msh"
  std::string_view endings;     ///< lower case, the usual one first: ".gltf .glb"
  std::string_view description; ///< one line, without a full stop
  unsigned holds = 0;
  /// Coordinates of triangles are 32-bit floats in files, or in the programs that print them.
  bool hasFloatCoordinates = false;

  /// Whether the content is of this format. Null: only the name decides.
  bool (*isContent)(const FileStart&) = nullptr;
  /// Whether a file with one of the endings, whose content is of no format, is treated as this
  /// format; its reader reports the defect. Null: it is not.
  bool (*isNamed)(const FileStart&) = nullptr;

  CellMesh (*readCells)(const Source&, const ReadOptions&, Report&, Progress&) = nullptr;
  /// The tets of a file that may be larger than memory.
  void (*spoolCells)(const Source&, const ReadOptions&, SpooledMesh&, Report&, Progress&) = nullptr;
  TriangleMesh (*readTriangles)(const Source&, Report&, Progress&) = nullptr;
  Volume (*readVolume)(const std::string& path, Progress&) = nullptr;
  /// Passes the arrays of a file to the sink, one at a time.
  void (*readArrays)(const Source&, const ArraySink&, Progress&) = nullptr;
  /// Only for formats with both: whether a file has solid cells. Reads the types of cells, up to
  /// the first solid one if they are stored in sequence, and no values; throws if it cannot be
  /// determined.
  bool (*hasSolidCells)(const Source&, Report&, Progress&) = nullptr;
  /// The times of a file's steps in order; empty if it has none. Null if kSteps is not in `holds`,
  /// and for files that name others (.pvd).
  std::vector<double> (*readTimes)(const Source&, Report&, Progress&) = nullptr;
  /// The other files that are read for a step (-1: the last); null for formats of a single file.
  std::vector<std::string> (*filesOfStep)(const Source&, int step) = nullptr;

  void (*writeTets)(const std::string& path, const TetMesh&, Progress&) = nullptr;
  void (*writeTriangles)(const std::string& path, const TriangleMesh&, Progress&) = nullptr;
  void (*writeVolume)(const std::string& path, const Volume&, Progress&) = nullptr;
  void (*writeArrays)(const ArrayContent&, Progress&) = nullptr;
  unsigned arrays = 0; ///< of an array format: the constants of io/volume/arrays/ArrayFormats.h
};

/// The uses of a format's files.
enum class FormatUse : std::uint8_t {
  ReadCells,
  ReadTriangles,
  ReadMesh,   ///< cells or triangles, or a sequence of such files
  ReadVolume, ///< grids or arrays
  ReadArrays, ///< dense arrays
  SpoolCells, ///< tets, without the whole mesh in memory
  ReadSteps,  ///< several steps in one file
  WriteTets,
  WriteTriangles,
  WriteVolume,
  WriteArrays ///< dense arrays of a volume
};

/// All rows, in the order in which content is tested.
const std::vector<Format>& formats();

/// The row of a format; that of Unknown has no endings and no uses.
const Format& formatOf(FileFormat format);

/// "Gmsh .msh" and so on; "unknown".
std::string_view formatName(FileFormat format);

bool can(const Format& format, FormatUse use);

/// The endings of a row, separately.
std::vector<std::string> endingsOf(const Format& format);

/// The endings of all formats with that use, without repetition, in the table's order.
std::vector<std::string> endingsFor(FormatUse use);

/// The same as text: ".msh, .mesh or .vtu".
std::string endingList(FormatUse use, std::string_view lastWord = "or");

/// ".vtu" of "a/b.VTU"; empty if the name has no ending (".vtu" has none).
std::string endingOf(std::string_view path);

/// The format with the use and an ending that matches `path`, in any case; null if there is
/// none.
const Format* formatForEnding(std::string_view path, FormatUse use);

/// The format of a file by its first bytes. The name decides only if the content is ambiguous
/// (TetGen's .node and .ele have no signature). Unknown if neither decides.
FileFormat sniffFormat(std::string_view bytes, const std::string& path);

/// Describes a file that is not a mesh of solid cells, as the end of a sentence: "holds triangles
/// (STL), not solid cells".
std::string describeUnknownFormat(std::string_view bytes, const std::string& path);

} // namespace tetvdb
