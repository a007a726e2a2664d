// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/openfoam/PolyMesh.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/CellRuns.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <array>
#include <limits>

namespace tetvdb::openfoam {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The corners of a face of a cell.
struct Side {
  const std::uint32_t* corners;
  std::uint32_t count;
  bool inward; ///< counter-clockwise seen from within the cell

  std::uint32_t at(std::uint32_t i) const { return corners[i]; }
  /// Where a corner is; `count` if it is none.
  std::uint32_t find(std::uint32_t point) const {
    return static_cast<std::uint32_t>(std::find(corners, corners + count, point) - corners);
  }
};

// The faces of every cell.
class Sides {
public:
  explicit Sides(const PolyMesh& mesh) : mesh_(mesh), begin_(mesh.cellCount() + 1, 0) {
    const auto visit = [&](const auto& f) {
      for (std::size_t i = 0; i < mesh.owner.size(); ++i)
        f(mesh.owner[i], 2 * i);
      for (std::size_t i = 0; i < mesh.neighbour.size(); ++i)
        f(mesh.neighbour[i], 2 * i + 1);
    };
    visit([&](std::uint32_t cell, std::size_t) { ++begin_[cell + std::size_t(1)]; });
    for (std::size_t i = 1; i < begin_.size(); ++i)
      begin_[i] += begin_[i - 1];
    faces_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    visit([&](std::uint32_t cell, std::size_t face) { faces_[next[cell]++] = face; });
  }

  void of(std::size_t cell, std::vector<Side>& sides) const {
    sides.clear();
    for (std::size_t k = begin_[cell]; k < begin_[cell + 1]; ++k) {
      const std::size_t face = faces_[k] / 2, first = mesh_.faces.begin[face];
      sides.push_back({mesh_.faces.corners.data() + first,
                       static_cast<std::uint32_t>(mesh_.faces.begin[face + 1] - first),
                       faces_[k] % 2 != 0});
    }
  }

private:
  const PolyMesh& mesh_;
  std::vector<std::size_t> begin_;
  std::vector<std::size_t> faces_; ///< twice the face, and one more for the neighbour's
};

// The corners in order, counter-clockwise seen from within.
std::vector<std::uint32_t> inward(const Side& side) {
  std::vector<std::uint32_t> corners(side.corners, side.corners + side.count);
  if (!side.inward)
    std::reverse(corners.begin(), corners.end());
  return corners;
}

// The first side of n corners of a cell with so many sides; null where there is none.
const Side* baseOf(const std::vector<Side>& all, std::uint32_t n, std::size_t sides) {
  const auto base =
      std::find_if(all.begin(), all.end(), [&](const Side& side) { return side.count == n; });
  return all.size() == sides && base != all.end() ? &*base : nullptr;
}

// Base and apex, of a tetrahedron or a pyramid with a base of n corners.
bool asPyramid(const std::vector<Side>& sides, std::uint32_t n, std::vector<std::uint32_t>& nodes) {
  const Side* const base = baseOf(sides, n, n + 1);
  if (base == nullptr)
    return false;
  nodes = inward(*base);
  std::uint32_t apex = kNone;
  for (const Side& side : sides) {
    if (&side == base)
      continue;
    if (side.count != 3)
      return false;
    std::uint32_t onBase = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (base->find(side.at(i)) != n)
        ++onBase;
      else if (apex == kNone || apex == side.at(i))
        apex = side.at(i);
      else
        return false;
    }
    if (onBase != 2)
      return false;
  }
  nodes.push_back(apex);
  return apex != kNone;
}

// Base and top, in the same direction, of a prism over a polygon of n corners.
bool asPrism(const std::vector<Side>& sides, std::uint32_t n, std::vector<std::uint32_t>& nodes) {
  const Side* const base = baseOf(sides, n, n + 2);
  if (base == nullptr)
    return false;
  nodes = inward(*base);
  std::vector<std::uint32_t> top(n, kNone);
  const Side* opposite = nullptr;
  for (const Side& side : sides) {
    if (&side == base)
      continue;
    bool meetsBase = false;
    for (std::uint32_t i = 0; i < side.count; ++i) {
      const auto at = static_cast<std::size_t>(
          std::find(nodes.begin(), nodes.begin() + n, side.at(i)) - nodes.begin());
      if (at == n)
        continue;
      meetsBase = true;
      if (side.count != 4)
        return false;
      for (const std::uint32_t next : {side.at((i + 1) % 4), side.at((i + 3) % 4)}) {
        if (base->find(next) != n)
          continue;
        if (top[at] != kNone && top[at] != next)
          return false;
        top[at] = next;
      }
    }
    if (meetsBase)
      continue;
    if (opposite != nullptr || side.count != n)
      return false;
    opposite = &side;
  }
  if (opposite == nullptr)
    return false;
  for (std::uint32_t i = 0; i < n; ++i)
    if (top[i] == kNone || opposite->find(top[i]) == n ||
        std::find(top.begin(), top.begin() + i, top[i]) != top.begin() + i)
      return false;
  nodes.insert(nodes.end(), top.begin(), top.end());
  return true;
}

// The kind of a cell, and its nodes in VTK's order; a polyhedron's faces.
const CellKind& kindOf(const std::vector<Side>& sides, std::vector<std::uint32_t>& nodes) {
  static const CellKind tetra{"tetrahedron", CellType::Tetra, 4, 4};
  static const CellKind pyramid{"pyramid", CellType::Pyramid, 5, 5};
  static const CellKind wedge{"wedge", CellType::Wedge, 6, 6};
  static const CellKind hexahedron{"hexahedron", CellType::Hexahedron, 8, 8};
  static const CellKind polyhedron{"polyhedron", CellType::Polyhedron, 0, 0};
  switch (sides.size()) {
  case 4:
    if (asPyramid(sides, 3, nodes))
      return tetra;
    break;
  case 5:
    if (asPyramid(sides, 4, nodes))
      return pyramid;
    if (asPrism(sides, 3, nodes))
      return wedge;
    break;
  case 6:
    if (asPrism(sides, 4, nodes))
      return hexahedron;
    break;
  default:
    break;
  }
  nodes = {static_cast<std::uint32_t>(sides.size())};
  for (const Side& side : sides) {
    nodes.push_back(side.count);
    nodes.insert(nodes.end(), side.corners, side.corners + side.count);
  }
  return polyhedron;
}

} // namespace

std::size_t PolyMesh::cellCount() const {
  std::size_t count = 0;
  for (const std::vector<std::uint32_t>* cells : {&owner, &neighbour})
    for (const std::uint32_t cell : *cells)
      count = std::max(count, cell + std::size_t(1));
  return count;
}

void check(const PolyMesh& mesh, const std::string& where) {
  const auto fail = [&](const std::string& what) {
    throw Error(Status::Invalid, where, what, kCut);
  };
  if (mesh.points.empty())
    fail("the mesh has no points");
  for (const Vec3d& p : mesh.points)
    if (!isFinite(p))
      fail("a point has coordinates that are not finite");
  const std::size_t faces = mesh.faces.count();
  if (mesh.owner.size() != faces || mesh.neighbour.size() > faces)
    fail("the mesh has " + std::to_string(faces) + " faces, but " +
         std::to_string(mesh.owner.size()) + " owners and " +
         std::to_string(mesh.neighbour.size()) + " neighbours of them");
  for (std::size_t i = 0; i < faces; ++i)
    if (mesh.faces.begin[i + 1] - mesh.faces.begin[i] < 3)
      fail("face " + std::to_string(i) + " has fewer than three corners");
  for (const std::uint32_t corner : mesh.faces.corners)
    if (corner >= mesh.points.size())
      fail("a face refers to point " + std::to_string(corner) + " of " +
           std::to_string(mesh.points.size()));
  // Every cell has four faces or more, which bounds their number.
  const std::size_t cells = mesh.cellCount();
  if (cells == 0 || cells > 2 * faces)
    fail("the mesh has " + std::to_string(faces) + " faces and " + std::to_string(cells) +
         " cells");
  std::vector<std::uint32_t> sides(cells, 0);
  for (const std::vector<std::uint32_t>* of : {&mesh.owner, &mesh.neighbour})
    for (const std::uint32_t cell : *of)
      ++sides[cell];
  for (std::size_t i = 0; i < cells; ++i)
    if (sides[i] < 4)
      fail("cell " + std::to_string(i) + " has " + std::to_string(sides[i]) + " faces");
}

void append(const PolyMesh& from, CellMesh& to) {
  const auto first = static_cast<std::uint32_t>(to.points.size());
  to.points.insert(to.points.end(), from.points.begin(), from.points.end());
  const Sides all(from);
  std::vector<Side> sides;
  std::vector<std::uint32_t> nodes;
  const std::size_t cells = from.cellCount();
  for (std::size_t cell = 0; cell < cells; ++cell) {
    all.of(cell, sides);
    const CellKind& kind = kindOf(sides, nodes);
    if (kind.type != CellType::Polyhedron) {
      for (const std::uint32_t node : nodes)
        to.nodes.push_back(first + node);
      appendCells(to, kind);
      continue;
    }
    for (std::size_t at = 1; at < nodes.size();) {
      const std::size_t end = at + 1 + nodes[at];
      for (++at; at < end; ++at)
        nodes[at] += first;
    }
    to.nodes.insert(to.nodes.end(), nodes.begin(), nodes.end());
    const auto size = static_cast<std::uint32_t>(nodes.size());
    if (to.runs.empty() || to.runs.back().type != kind.type || to.runs.back().nodesPerCell != size)
      to.runs.push_back({kind.type, size, 0, kind.name, false});
    ++to.runs.back().count;
  }
}

} // namespace tetvdb::openfoam
