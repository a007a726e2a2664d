// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/WindingBand.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kVoxel = static_cast<double>(kUnitsPerVoxel);
// A half counts as passed slightly beyond it (nearestWinding()), and values have an error.
constexpr double kMargin = 3 * kWindingBandError;
// A winding number this close to a half is one: in the plane of a flat sheet it is but for
// rounding.
constexpr double kTie = kWindingBandError / 10;
// Bound on what one cluster or triangle seen from afar is wrong by, as a winding number: errors are
// a hundredth of it as a rule, and of both signs. Where the triangles over the holes are more than
// kManyTriangles, the second.
constexpr double kPartError = 1e-4;
constexpr double kPartErrorOfMany = 1e-3;
constexpr std::size_t kManyTriangles = 4096;
// Clusters smaller than this share of a cube's ball are kept whole while they are near.
constexpr double kKeptWhole = 0.5;
constexpr std::int64_t kSmallestCube = kExpandedVoxels;

// Distance to the nearest half.
double toHalf(double winding) {
  return std::abs(winding - std::floor(winding) - 0.5);
}

double distanceToBox(const LatticePoint& p, const LatticePoint& low, const LatticePoint& high) {
  const auto outside = [](double x, double a, double b) { return std::max({a - x, x - b, 0.0}); };
  return length(
      {outside(p.x, low.x, high.x), outside(p.y, low.y, high.y), outside(p.z, low.z, high.z)});
}

struct Offsets {
  std::array<double, kMaxPointSums> x{}, y{}, z{};
};

// From the centre of the smallest cubes to their farthest voxel.
const Offsets& voxelOffsets() {
  static const Offsets offsets = [] {
    Offsets made;
    for (std::size_t i = 0; i < 64; ++i) {
      made.x[i] = (double(i / 16) - 1.5) * kVoxel;
      made.y[i] = (double(i / 4 % 4) - 1.5) * kVoxel;
      made.z[i] = (double(i % 4) - 1.5) * kVoxel;
    }
    return made;
  }();
  return offsets;
}

double radiusOf(std::int64_t size) {
  return std::sqrt(0.75) * static_cast<double>(size) * kVoxel;
}

} // namespace

// The ball's surface around cubes of a size, and the points at which functions are known there,
// relative to the centre, in whole numbers.
struct WindingBand::Sphere {
  explicit Sphere(std::int64_t size) : radius(radiusOf(size)) {
    for (std::size_t i = 0; i < kExpansionPoints; ++i) {
      const Vec3d& way = expansionDirections()[i];
      offsets.x[i] = std::nearbyint(way[0] * radius);
      offsets.y[i] = std::nearbyint(way[1] * radius);
      offsets.z[i] = std::nearbyint(way[2] * radius);
    }
  }
  PointSums sums(Expansion& values) const {
    return {offsets.x.data(), offsets.y.data(), offsets.z.data(), values.values.data(),
            kExpansionPoints};
  }
  double radius;
  Offsets offsets;
};

std::int32_t nearestWinding(double winding) {
  const double size = std::ceil(std::abs(winding) - 0.5 - kTie);
  return static_cast<std::int32_t>(winding < 0 ? -size : size);
}

void WindingBand::place(const Corner& first, std::int64_t size, Cube& cube) {
  cube.first = first;
  cube.size = size;
  const double half = static_cast<double>(size - 1) / 2;
  cube.centre = {(static_cast<double>(first[0]) + half) * kVoxel,
                 (static_cast<double>(first[1]) + half) * kVoxel,
                 (static_cast<double>(first[2]) + half) * kVoxel};
  cube.clusters.clear();
  cube.triangles.clear();
}

// A cube with what it has of the one around it, and everything else sorted into far and near.
void WindingBand::enter(const Cube& around, std::size_t octant, const Sphere& sphere,
                        Cube& cube) const {
  const std::int64_t half = around.size / 2;
  const auto shift = [&](std::size_t bit) { return (octant & bit) != 0 ? half : 0; };
  place({around.first[0] + shift(4), around.first[1] + shift(2), around.first[2] + shift(1)}, half,
        cube);
  cube.expanded = around.expanded;
  if (around.expanded)
    expandInOctant(around.far, octant, cube.far);
  else
    cube.far.values.fill(0);
  for (const std::uint32_t c : around.clusters)
    sortCluster(c, sphere, cube);
  for (const std::uint32_t t : around.triangles)
    sortTriangle(t, sphere, cube);
}

void WindingBand::sortCluster(std::uint32_t index, const Sphere& sphere, Cube& cube) const {
  const TriangleClusters::Cluster& cluster = fill_.clusters()[index];
  const double radius = sphere.radius;
  const double away = length(from(cube.centre, cluster.centre));
  const double distance =
      std::max(away - cluster.radius, distanceToBox(cube.centre, cluster.low, cluster.high));
  const bool far =
      distance > radius &&
      expansionError(distance / radius, cluster.area / (radius * radius)) <= tolerance_;
  if (far && cluster.momentsError(away - radius) <= tolerance_) {
    addMoments(cluster, cube.centre, sphere.sums(cube.far));
    cube.expanded = true;
  } else if (!far && cluster.radius < kKeptWhole * radius) {
    cube.clusters.push_back(index);
  } else if (cluster.second != 0) {
    sortCluster(index + 1, sphere, cube);
    sortCluster(cluster.second, sphere, cube);
  } else {
    for (std::uint32_t t = cluster.begin; t != cluster.end; ++t)
      sortTriangle(t, sphere, cube);
  }
}

void WindingBand::sortTriangle(std::uint32_t index, const Sphere& sphere, Cube& cube) const {
  const FillTriangle& triangle = fill_.triangle(index);
  const SeenTriangle seen = seenFrom(cube.centre, triangle);
  const double radius = sphere.radius, relativeArea = fill_.area(index) / (radius * radius);
  const double distance = std::sqrt(nearestOnTriangle(seen.a, seen.b, seen.c).squared);
  if (distance > radius && expansionError(distance / radius, relativeArea) <= tolerance_) {
    addFarSolidAngles(seen, triangle.weight, radius, sphere.sums(cube.far));
    cube.expanded = true;
  } else {
    cube.triangles.push_back(index);
  }
}

// The triangles of a near cluster, or those of its child clusters that can be approximated in all
// of the cube: add.triangle(index) or add.cluster(cluster).
template <typename Add>
void WindingBand::addCluster(std::uint32_t index, const Cube& cube, const Add& add) const {
  const TriangleClusters::Cluster& cluster = fill_.clusters()[index];
  const double away = length(from(cube.centre, cluster.centre)) - radiusOf(cube.size);
  if (cluster.momentsError(away) <= tolerance_) {
    add.cluster(cluster);
  } else if (cluster.second != 0) {
    addCluster(index + 1, cube, add);
    addCluster(cluster.second, cube, add);
  } else {
    for (std::uint32_t t = cluster.begin; t != cluster.end; ++t)
      add.triangle(t);
  }
}

namespace {

// Adds to the values at points.
struct AddAtPoints {
  const TriangleClusters& fill;
  const LatticePoint& centre;
  PointSums points;

  void cluster(const TriangleClusters::Cluster& c) const { addMoments(c, centre, points); }
  void triangle(std::uint32_t t) const {
    addSolidAngles(seenFrom(centre, fill.triangle(t)), fill.triangle(t).weight, points);
  }
};

// How far the part of an edge from a to b in a solid angle gets within `reach` of 0. Its gradient
// is the field of a current along the edge: f / d around the edge's line, at a distance d from it,
// with f between 0 and 2, so that it changes by at most twice the angle that one gets around the
// line; and at a distance h from the edge itself at most 2 / h or length / h^2, here integrated
// outwards.
double changeByEdge(const Vec3d& a, const Vec3d& b, double reach) {
  const double h = std::sqrt(nearestOnSegment(a, b).squared), left = h - reach;
  if (!(left > 0))
    return std::numeric_limits<double>::infinity();
  const Vec3d edge = minus(b, a), moment = cross(a, b);
  const double square = dot(edge, edge), span = std::sqrt(square);
  const double q = reach / left;
  // ln(1 + q) <= q (6 + q) / (6 + 4 q)
  double change = std::min(2 * q * (6 + q) / (6 + 4 * q), span * reach / (h * left));
  // asin(x) <= pi x / (2 + sqrt(1 - x^2))
  const double squaredDistance = dot(moment, moment) / square;
  const double cosine = 1 - reach * reach / squaredDistance;
  if (cosine > 0)
    change =
        std::min(change, 2 * kPi * reach / std::sqrt(squaredDistance) / (2 + std::sqrt(cosine)));
  return change;
}

// How far a triangle's solid angle gets within `reach` of 0, but for jumps by 4 pi where the
// triangle is crossed.
double changeOf(const SeenTriangle& t, double area, double weight, double reach) {
  const double byEdges =
      changeByEdge(t.a, t.b, reach) + changeByEdge(t.b, t.c, reach) + changeByEdge(t.c, t.a, reach);
  const double distance = std::sqrt(nearestOnTriangle(t.a, t.b, t.c).squared);
  // The gradient is at most 2 area / distance^3.
  const double left = distance - reach;
  const double byArea = left > 0 ? area * (1 / (left * left) - 1 / (distance * distance))
                                 : std::numeric_limits<double>::infinity();
  return std::min(weight * byEdges, byArea);
}

} // namespace

// From its value at the centre and bounds on its change within the cube.
bool WindingBand::mayPassHalf(const Cube& cube) const {
  if (cube.size >= kLeafSize)
    progress_.check();
  const double steps = static_cast<double>(cube.size - 1) / 2;
  const double reach = kVoxel * std::sqrt(2 * steps * steps + (steps + 1) * (steps + 1));
  const ExpansionRange range = rangeOf(cube.far, reach / radiusOf(cube.size));
  const double max = 2 * kPi - 4 * kPi * kMargin;
  double change = range.change;
  for (std::size_t i = 0; i < cube.triangles.size() && change < max; ++i) {
    const std::uint32_t t = cube.triangles[i];
    change += changeOf(seenFrom(cube.centre, fill_.triangle(t)), fill_.area(t),
                       fill_.triangle(t).weight, reach);
  }
  for (std::size_t i = 0; i < cube.clusters.size() && change < max; ++i) {
    const TriangleClusters::Cluster& c = fill_.clusters()[cube.clusters[i]];
    const double left = std::max(length(from(cube.centre, c.centre)) - c.radius,
                                 distanceToBox(cube.centre, c.low, c.high)) -
                        reach;
    change += left > 0 ? c.area * reach * (2 * left + reach) /
                             (left * left * (left + reach) * (left + reach))
                       : max;
  }
  if (!(change < max))
    return true;
  const double zero = 0;
  double midpoint = range.midpoint;
  const AddAtPoints add{fill_, cube.centre, {&zero, &zero, &zero, &midpoint, 1}};
  for (const std::uint32_t t : cube.triangles)
    add.triangle(t);
  for (const std::uint32_t c : cube.clusters)
    addCluster(c, cube, add);
  return toHalf(midpoint / (4 * kPi)) <= change / (4 * kPi) + kMargin;
}

// The parts of cubes down to `size` that may pass a half.
std::vector<WindingBand::Cube> WindingBand::descend(std::vector<Cube> cubes,
                                                    std::int64_t size) const {
  while (!cubes.empty() && cubes.front().size > size) {
    const Sphere sphere(cubes.front().size / 2);
    std::vector<std::vector<Cube>> parts(cubes.size());
    tbb::parallel_for(std::size_t(0), cubes.size(), [&](std::size_t i) {
      Cube part;
      for (std::size_t octant = 0; octant < 8; ++octant) {
        enter(cubes[i], octant, sphere, part);
        if (mayPassHalf(part))
          parts[i].push_back(part);
      }
    });
    cubes.clear();
    for (std::vector<Cube>& some : parts)
      std::move(some.begin(), some.end(), std::back_inserter(cubes));
  }
  return cubes;
}

WindingBand::WindingBand(const TriangleClusters& fill, const Progress& progress)
    : fill_(fill), progress_(progress),
      tolerance_(4 * kPi *
                 (fill.triangleCount() > kManyTriangles ? kPartErrorOfMany : kPartError)) {
  if (fill.empty())
    return;
  // Outside a ball the winding number is below 0.45: solid angles are at most area / distance^2.
  const TriangleClusters::Cluster& all = fill.clusters().front();
  const double radius = (all.radius + std::sqrt(all.area / (4 * kPi * 0.45))) * kVoxelsPerUnit + 2;
  const double centre[3] = {all.centre.x, all.centre.y, all.centre.z};
  Corner low{}, high{};
  std::int64_t longest = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double c = centre[k] * kVoxelsPerUnit;
    low[k] = static_cast<std::int64_t>(std::floor((c - radius) / kNodeSize));
    high[k] = static_cast<std::int64_t>(std::floor((c + radius) / kNodeSize));
    longest = std::max(longest, high[k] - low[k] + 1);
  }
  std::int64_t size = kNodeSize;
  while (size < longest * kNodeSize)
    size *= 2;
  // Eight cubes of a power of two hold the ball wherever it lies: parts of one that is around them.
  Cube start;
  Corner first{};
  for (std::size_t k = 0; k < 3; ++k)
    first[k] = (low[k] * kNodeSize >= 0 ? low[k] * kNodeSize / size
                                        : -((-low[k] * kNodeSize + size - 1) / size)) *
               size;
  place(first, 2 * size, start);
  start.clusters.push_back(0);
  std::vector<Cube> cubes;
  cubes.push_back(std::move(start));
  cubes = descend(std::move(cubes), kNodeSize);
  constexpr std::int64_t kLast = std::numeric_limits<std::int32_t>::max() / kNodeSize;
  for (Cube& cube : cubes) {
    NodeIndex index{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (cube.first[k] < -kLast * kNodeSize || cube.first[k] > kLast * kNodeSize)
        throw Error(Status::Limit, "", "the mesh leaves 32-bit index space at this voxel size",
                    "use larger voxels");
      index[k] = static_cast<std::int32_t>(cube.first[k] / kNodeSize);
    }
    nodes_.emplace(index, std::move(cube));
  }
}

std::vector<NodeIndex> WindingBand::nodes() const {
  std::vector<NodeIndex> found;
  found.reserve(nodes_.size());
  for (const auto& node : nodes_)
    found.push_back(node.first);
  return found;
}

WindingBand::Node WindingBand::enter(const NodeIndex& node) const {
  Node entered;
  const auto found = nodes_.find(node);
  if (found == nodes_.end())
    return entered;
  const std::int64_t x = found->second.first[0];
  for (Cube& cube : descend({found->second}, kLeafSize))
    entered.leaves_[static_cast<std::size_t>((cube.first[0] - x) / kLeafSize)].push_back(
        std::move(cube));
  return entered;
}

bool WindingBand::evaluate(const Node& node, int slab, SlabBits& flags,
                           std::vector<double>& values) const {
  std::fill_n(&flags.rows[0][0], 2 * kSlabRows, std::uint64_t(0));
  const Sphere sphere(kSmallestCube);
  bool any = false;
  VoxelValues sums;
  Cube cube;
  for (const Cube& leaf : node.leaves_[static_cast<std::size_t>(slab)])
    for (std::size_t octant = 0; octant < 8; ++octant) {
      enter(leaf, octant, sphere, cube);
      if (!mayPassHalf(cube))
        continue;
      any = true;
      evaluateVoxels(cube, sums);
      const auto x0 = static_cast<std::size_t>(cube.first[0] - leaf.first[0]);
      const auto y0 = static_cast<std::size_t>(cube.first[1] & (kNodeSize - 1));
      const auto z0 = static_cast<std::size_t>(cube.first[2] & (kNodeSize - 1));
      for (std::size_t i = 0; i < sums.size(); i += kExpandedVoxels) {
        const std::size_t row = (x0 + i / 16) * kNodeSize + y0 + i / 4 % 4;
        flags.rows[row][z0 / 64] |= lowBits(kExpandedVoxels) << (z0 % 64);
        for (std::size_t z = 0; z < kExpandedVoxels; ++z)
          values[row * kNodeSize + z0 + z] = sums[i + z] / (4 * kPi);
      }
    }
  return any;
}

void WindingBand::evaluateVoxels(const Cube& cube, VoxelValues& values) const {
  expandAtVoxels(cube.far, values);
  const Offsets& at = voxelOffsets();
  const AddAtPoints add{
      fill_, cube.centre, {at.x.data(), at.y.data(), at.z.data(), values.data(), values.size()}};
  for (const std::uint32_t t : cube.triangles)
    add.triangle(t);
  for (const std::uint32_t c : cube.clusters)
    addCluster(c, cube, add);
}

} // namespace tetvdb
