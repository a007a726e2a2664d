// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/CheckMesh.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Multiversion.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {
namespace {

constexpr std::size_t kGrain = std::size_t(1) << 14;

[[noreturn]] void fail(const std::string& what) {
  throw Error(Status::Invalid, "mesh in memory", what, "build it again from its source");
}

std::string text(std::size_t number) {
  return std::to_string(number);
}

// Without branches, so that several numbers are compared at once.
TETVDB_MULTIVERSION bool anyAtLeast(std::uint32_t limit, const std::uint32_t* numbers,
                                    std::size_t count) {
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < count; ++i)
    any |= static_cast<std::uint32_t>(numbers[i] >= limit);
  return any != 0;
}

// A difference from itself is 0 for finite numbers only.
TETVDB_MULTIVERSION bool anyInfinite(const double* numbers, std::size_t count) {
  std::uint64_t any = 0;
  for (std::size_t i = 0; i < count; ++i)
    any |= static_cast<std::uint64_t>(!(numbers[i] - numbers[i] == 0));
  return any != 0;
}

// Whether isWrong(begin, end) for a part of the numbers below `n`.
template <typename IsWrong>
bool anyWrong(std::size_t n, const IsWrong& isWrong) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, kGrain), false,
      [&](const tbb::blocked_range<std::size_t>& range, bool wrong) {
        return wrong || isWrong(range.begin(), range.end());
      },
      std::logical_or<>());
}

// The first i below `n` for which isWrong(i), or n.
template <typename IsWrong>
std::size_t firstWrong(std::size_t n, const IsWrong& isWrong) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, n, kGrain), n,
      [&](const tbb::blocked_range<std::size_t>& range, std::size_t first) {
        for (std::size_t i = range.begin(); i < std::min(range.end(), first); ++i)
          if (isWrong(i))
            return i;
        return first;
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

void checkPoints(const std::vector<Vec3d>& points) {
  if (!anyWrong(points.size(), [&](std::size_t begin, std::size_t end) {
        return anyInfinite(points[begin].data(), 3 * (end - begin));
      }))
    return;
  const std::size_t wrong = firstWrong(points.size(), [&](std::size_t i) {
    const Vec3d& p = points[i];
    return !(std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]));
  });
  if (wrong < points.size())
    fail("point " + text(wrong) + " has a coordinate that is not finite");
}

// `corners` indices a cell.
void checkIndices(const std::vector<std::uint32_t>& indices, std::size_t corners, const char* cell,
                  std::size_t points) {
  if (indices.size() % corners != 0)
    fail(text(indices.size()) + " indices are no whole number of " + cell + "s of " +
         text(corners));
  const auto limit = static_cast<std::uint32_t>(
      std::min<std::size_t>(points, std::numeric_limits<std::uint32_t>::max()));
  if (!anyWrong(indices.size(), [&](std::size_t begin, std::size_t end) {
        return anyAtLeast(limit, &indices[begin], end - begin);
      }))
    return;
  const std::size_t wrong =
      firstWrong(indices.size(), [&](std::size_t i) { return indices[i] >= points; });
  if (wrong < indices.size())
    fail(std::string(cell) + " " + text(wrong / corners) + " uses point " + text(indices[wrong]) +
         ", but there are " + text(points) + ", numbered from 0");
}

void checkCurved(const CurvedCells& curved, std::size_t tets, std::size_t points) {
  if (curved.empty())
    return;
  if (curved.cellOfTet.size() != tets || curved.corners.size() != tets)
    fail("its cells with shape functions are of " + text(curved.cellOfTet.size()) +
         " tets, but there are " + text(tets));
  const std::size_t node =
      firstWrong(curved.nodes.size(), [&](std::size_t i) { return curved.nodes[i] >= points; });
  if (node < curved.nodes.size())
    fail("a cell with shape functions uses point " + text(curved.nodes[node]) + ", but there are " +
         text(points) + ", numbered from 0");
  const std::size_t cell = firstWrong(curved.cells.size(), [&](std::size_t i) {
    const std::size_t count = nodeCount(curved.cells[i].shape);
    return curved.nodes.size() < count || curved.cells[i].first > curved.nodes.size() - count;
  });
  if (cell < curved.cells.size())
    fail("cell " + text(cell) + " with shape functions" + " has nodes beyond the last");
  const std::size_t tet = firstWrong(tets, [&](std::size_t t) {
    const std::uint32_t of = curved.cellOfTet[t];
    if (of == CurvedCells::kLinear)
      return false;
    if (of >= curved.cells.size())
      return true;
    const auto& places = curved.corners[t];
    return *std::max_element(places.begin(), places.end()) >= placeCount(curved.cells[of].shape);
  });
  if (tet < tets)
    fail("tet " + text(tet) +
         " is of a cell with shape functions, or a place in it, that is not there");
}

} // namespace

void checkMesh(const TriangleMesh& mesh) {
  checkIndices(mesh.triangles, 3, "triangle", mesh.points.size());
  checkPoints(mesh.points);
}

void checkMesh(const TetMesh& mesh) {
  checkIndices(mesh.tets, 4, "tet", mesh.points.size());
  checkPoints(mesh.points);
  const std::size_t tets = mesh.tetCount();
  if (!mesh.cellOfTet.empty() && mesh.cellOfTet.size() != tets)
    fail("it says the cell of " + text(mesh.cellOfTet.size()) + " tets, but there are " +
         text(tets));
  if (!mesh.regions.empty()) {
    const std::size_t wrong =
        firstWrong(tets, [&](std::size_t t) { return mesh.cell(t) >= mesh.regions.size(); });
    if (wrong < tets)
      fail("tet " + text(wrong) + " is of cell " + text(mesh.cell(wrong)) + ", but " +
           text(mesh.regions.size()) + " cells have a region");
  }
  checkCurved(mesh.curved, tets, mesh.points.size());
}

} // namespace tetvdb
