// SPDX-License-Identifier: Apache-2.0
//
// A mesh of linear cells that is not in memory: points, tets and arrays lie in temporary files
// without names.
#pragma once

#include "tetvdb/core/FileSpool.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/TetMesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <utility>
#include <vector>

namespace tetvdb {

/// An array over the points or solid cells of a SpooledMesh, with the number type of the
/// alternative `type` of Attribute::Values.
struct SpooledArray {
  std::string name;
  Attribute::On on = Attribute::On::Points;
  std::uint32_t components = 1;
  std::size_t type = 0;
  std::unique_ptr<FileSpool> values;

  std::size_t bytesEach() const; ///< of the numbers of one point or cell
};

/// An array without values, of the number type `type`.
Attribute emptyAttribute(const SpooledArray& array);
/// The bytes of an array's numbers.
std::pair<const void*, std::size_t> bytesOf(const Attribute::Values& values);

/// Solid cells in the file's order: tets, or cells that splitSpooled() cuts into tets.
class SpooledMesh {
public:
  /// The files are made in `folder`.
  explicit SpooledMesh(const std::string& folder)
      : points(folder), tets(folder), cellOfTet(folder), corners(folder), types(folder),
        firstCorners(folder), regions(folder), folder_(folder) {}

  FileSpool points;       ///< Vec3d, all finite
  FileSpool tets;         ///< four std::uint32_t each, below the number of points
  FileSpool cellOfTet;    ///< std::uint32_t, one a tet; empty: tet i is cell i
  FileSpool corners;      ///< of the cells, std::uint32_t, below the number of points
  FileSpool types;        ///< CellType, one a cell; empty: all are tets
  FileSpool firstCorners; ///< std::uint64_t, one a cell: the place of its first corner
  FileSpool regions;      ///< std::int32_t, one a cell; empty where the input has none
  std::vector<SpooledArray> arrays;
  std::vector<UnreadArray> unread;
  std::map<std::string, std::size_t> cells; ///< of the file, by the name of their kind

  const std::string& folder() const { return folder_; }
  std::size_t pointCount() const { return points.count<Vec3d>(); }
  std::size_t tetCount() const { return tets.count<std::uint32_t>() / 4; }
  std::size_t cellCount() const {
    return types.size() > 0 ? types.count<CellType>()
                            : std::max(tetCount(), corners.count<std::uint32_t>() / 4);
  }
  /// Whether values at points are those of shape functions (TetMesh::curved).
  bool hasShapes() const { return firstCorners.size() > 0; }
  /// How many corners a cell of the type has; 0 where it has no place in a spooled mesh.
  static std::size_t cornersOf(CellType type);
  /// Adds cells by their corners. Throws Error(Limit) for more than 2^32 - 2 cells, Error(Write).
  void addCells(CellType type, const std::uint32_t* nodes, std::size_t count);
  /// A new array; null where there is one of that name.
  SpooledArray* add(const std::string& name, Attribute::On on, std::uint32_t components,
                    std::size_t type);
  SpooledArray* find(const std::string& name, Attribute::On on);

  /// After the last number. Throws Error(Write).
  void finish();
  /// Gives mapped pages back where the process has more than `maxResident` bytes in memory.
  void releaseAbove(std::size_t maxResident) const noexcept;

private:
  std::string folder_;
};

/// Makes the tets of all cells that were added, after the last of them and of the arrays: those of
/// splitCells(). Keeps the corners where an array of the points needs them. Warns of cells that are
/// not convex. Throws Error(Limit) for more than 2^32 - 2 tets, Error(Write).
void splitSpooled(SpooledMesh& mesh, Report& report, Progress& progress);

/// The tets begin <= t < end with corners of their own: tet t - begin has the points
/// 4 (t - begin) + 0 to 3.
TetMesh cornersOf(const SpooledMesh& mesh, std::size_t begin, std::size_t end);

/// Calls take(make(begin, end)) for ranges of tets: make() in parallel, take() in their order, one
/// after the other. The ranges are the same for any number of threads.
template <typename Make, typename Take>
void eachTetRange(const SpooledMesh& mesh, std::size_t maxResident, Progress& progress,
                  const Make& make, const Take& take) {
  constexpr std::size_t kRange = std::size_t(1) << 12;
  using Made = decltype(make(std::size_t(0), std::size_t(0)));
  const std::size_t count = mesh.tetCount();
  const std::size_t window =
      kRange * 16 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  for (std::size_t begin = 0; begin < count; begin += window) {
    progress.update(static_cast<double>(begin) / static_cast<double>(count));
    const std::size_t end = std::min(begin + window, count);
    std::vector<Made> made((end - begin + kRange - 1) / kRange);
    tbb::parallel_for(std::size_t(0), made.size(), [&](std::size_t i) {
      const std::size_t from = begin + i * kRange;
      made[i] = make(from, std::min(from + kRange, end));
      mesh.releaseAbove(maxResident);
    });
    for (Made& one : made)
      take(std::move(one));
  }
}

} // namespace tetvdb
