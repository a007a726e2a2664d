// SPDX-License-Identifier: Apache-2.0
//
// The lattice is body-centred: corners and centres of cells. Its Delaunay tets are all alike and
// close to regular (4 edges to 2 as sqrt(3) to 2), and no five of its points are cospherical, so
// that shaking it makes no slivers, as it does with corners alone.
#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/tetrahedralize/complex/BackgroundMesh.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr double kMaxPoints = 200000; // at any spacing
constexpr double kPerturb = 0.1;      // of a cell
// Grains: cells narrower than this could round two points to one.
constexpr double kNarrowest = 16;

// Whether no triangle is nearer to a point than a given distance.
class Clearance {
public:
  Clearance(const LatticeSoup& soup, double distance)
      : soup_(soup), squared_(distance * distance), tree_(boxesOf(soup)) {}

  bool holds(const Vec3d& p) const {
    bool near = false;
    tree_.visit([&](const Box& box) { return squaredDistance(box, p) < squared_; },
                [&](std::uint32_t face) {
                  const auto& f = soup_.faces[face];
                  near =
                      nearestOnTriangle(minus(soup_.points[f[0]], p), minus(soup_.points[f[1]], p),
                                        minus(soup_.points[f[2]], p))
                          .squared < squared_;
                  return near;
                });
    return !near;
  }

private:
  static std::vector<Box> boxesOf(const LatticeSoup& soup) {
    std::vector<Box> boxes(soup.faces.size());
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (const std::uint32_t point : soup.faces[i])
        boxes[i].add(soup.points[point]);
    return boxes;
  }
  static double squaredDistance(const Box& box, const Vec3d& p) {
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double away = std::max({box.low[axis] - p[axis], p[axis] - box.high[axis], 0.0});
      squared += away * away;
    }
    return squared;
  }

  const LatticeSoup& soup_;
  double squared_;
  BoxTree tree_;
};

// Cells along each axis.
std::array<std::size_t, 3> countCells(const Box& box, double spacing, double grain) {
  std::array<std::size_t, 3> cells{};
  // As many points as the cubic lattice of that spacing: two to a cell.
  for (double cell = std::max(spacing, grain) * std::cbrt(2.0);; cell *= 1.05) {
    double corners = 1, centres = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double side = box.high[axis] - box.low[axis];
      const double count =
          std::max(1.0, std::floor(std::min(side / cell + 0.5, side / (kNarrowest * grain))));
      centres *= count;
      corners *= count + 1;
      cells[axis] = static_cast<std::size_t>(std::min(count, kMaxPoints));
    }
    if (corners + centres <= kMaxPoints)
      return cells;
  }
}

// A perturbed body-centred lattice over the box: the corners and centres of cells, without the
// box's corners.
std::vector<Vec3d> latticeOver(const Box& box, double spacing, double grain) {
  // In half cells: all even are corners, all odd are centres.
  const std::array<std::size_t, 3> cells = countCells(box, spacing, grain);
  std::vector<Vec3d> between;
  for (std::size_t z = 0; z <= 2 * cells[2]; ++z)
    for (std::size_t y = z % 2; y <= 2 * cells[1]; y += 2)
      for (std::size_t x = z % 2; x <= 2 * cells[0]; x += 2) {
        const std::array<std::size_t, 3> at = {x, y, z};
        Vec3d p{};
        std::size_t sides = 0;
        std::uint64_t random = hashOfIndex(between.size());
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const double cell = (box.high[axis] - box.low[axis]) / static_cast<double>(cells[axis]);
          const double shift = static_cast<double>(random & 0xFFFFFu) / 0x80000 - 1; // [-1, 1)
          random >>= 20;
          p[axis] = box.low[axis] + cell * (0.5 * static_cast<double>(at[axis]) + kPerturb * shift);
          if (at[axis] == 0 || at[axis] == 2 * cells[axis]) {
            p[axis] = at[axis] == 0 ? box.low[axis] : box.high[axis];
            ++sides;
          }
        }
        if (sides < 3)
          between.push_back(roundToGrain(p, grain));
      }
  return between;
}

} // namespace

std::vector<Vec3d> backgroundPoints(const LatticeSoup& soup, double margin, double spacing,
                                    double clearance, Progress& progress) {
  Box box;
  for (const Vec3d& p : soup.points)
    box.add(p);
  // The corners are no points of the soup.
  const double grow = std::max(std::ceil(margin / soup.grain), 1.0) * soup.grain;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] -= grow;
    box.high[axis] += grow;
  }
  std::vector<Vec3d> points;
  for (unsigned corner = 0; corner < 8; ++corner)
    points.push_back({(corner & 1u ? box.high : box.low)[0], (corner & 2u ? box.high : box.low)[1],
                      (corner & 4u ? box.high : box.low)[2]});
  points.insert(points.end(), soup.points.begin(), soup.points.end());

  const std::vector<Vec3d> between = latticeOver(box, spacing, soup.grain);
  // Never nearer than a grain, so that no point is one of the soup's.
  const Clearance clear(soup, std::max(clearance, soup.grain));
  std::vector<std::uint8_t> kept(between.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, between.size(), 256),
                    [&](const auto& range) {
                      progress.check();
                      for (std::size_t i = range.begin(); i < range.end(); ++i)
                        kept[i] = clear.holds(between[i]) ? 1 : 0;
                    });
  for (std::size_t i = 0; i < between.size(); ++i)
    if (kept[i] != 0)
      points.push_back(between[i]);
  return points;
}

} // namespace tetvdb
