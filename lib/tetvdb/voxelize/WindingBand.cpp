// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/WindingBand.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/WindingCube.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// Bound on what one cluster or triangle seen from afar is wrong by, as a winding number: errors are
// a hundredth of it as a rule, and of both signs. Where the triangles over the holes are more than
// kManyTriangles, the second.
constexpr double kPartError = 1e-4;
constexpr double kPartErrorOfMany = 1e-3;
constexpr std::size_t kManyTriangles = 4096;
constexpr std::int64_t kSmallestCube = kExpandedVoxels;

struct Offsets {
  std::array<double, kMaxPointSums> x{}, y{}, z{};
};

// From the centre of the smallest cubes to their farthest voxel.
const Offsets& voxelOffsets() {
  static const Offsets offsets = [] {
    Offsets made;
    for (std::size_t i = 0; i < 64; ++i) {
      const Vec3d offset = winding::voxelOffset(i);
      made.x[i] = offset[0];
      made.y[i] = offset[1];
      made.z[i] = offset[2];
    }
    return made;
  }();
  return offsets;
}

} // namespace

// The ball's surface around cubes of a size, and the points at which functions are known there,
// relative to the centre, in whole numbers.
struct WindingBand::Sphere {
  explicit Sphere(std::int64_t size) : radius(winding::radiusOf(size)) {
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

void WindingBand::place(const Corner& first, std::int64_t size, Cube& cube) {
  cube.first = first;
  cube.size = size;
  cube.centre = winding::centreOf(first.data(), size);
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
  const winding::Sorted sorted =
      winding::sortedCluster(cluster, cube.centre, sphere.radius, tolerance_);
  if (sorted == winding::Sorted::Far) {
    addMoments(cluster, cube.centre, sphere.sums(cube.far));
    cube.expanded = true;
  } else if (sorted == winding::Sorted::Whole) {
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
  if (winding::isFar(seen, fill_.area(index), sphere.radius, tolerance_)) {
    addFarSolidAngles(seen, triangle.weight, sphere.radius, sphere.sums(cube.far));
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
  if (winding::byMoments(cluster, cube.centre, winding::radiusOf(cube.size), tolerance_)) {
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

} // namespace

// From its value at the centre and bounds on its change within the cube.
bool WindingBand::mayPassHalf(const Cube& cube) const {
  if (cube.size >= kLeafSize)
    progress_.check();
  const double reach = winding::reachOf(cube.size), max = winding::kMaxChange;
  const ExpansionRange range = rangeOf(cube.far, reach / winding::radiusOf(cube.size));
  double change = range.change;
  for (std::size_t i = 0; i < cube.triangles.size() && change < max; ++i) {
    const std::uint32_t t = cube.triangles[i];
    change += winding::changeOf(seenFrom(cube.centre, fill_.triangle(t)), fill_.area(t),
                                fill_.triangle(t).weight, reach);
  }
  for (std::size_t i = 0; i < cube.clusters.size() && change < max; ++i)
    change += winding::changeOf(fill_.clusters()[cube.clusters[i]], cube.centre, reach);
  if (!(change < max))
    return true;
  const double zero = 0;
  double midpoint = range.midpoint;
  const AddAtPoints add{fill_, cube.centre, {&zero, &zero, &zero, &midpoint, 1}};
  for (const std::uint32_t t : cube.triangles)
    add.triangle(t);
  for (const std::uint32_t c : cube.clusters)
    addCluster(c, cube, add);
  return winding::mayPass(midpoint, change);
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

std::vector<WindingBand::Cube> WindingBand::leavesOf(const NodeIndex& node) const {
  const auto found = nodes_.find(node);
  return found == nodes_.end() ? std::vector<Cube>() : descend({found->second}, kLeafSize);
}

WindingBand::Node WindingBand::enter(const NodeIndex& node) const {
  Node entered;
  const std::int64_t x = std::int64_t(node[0]) * kNodeSize;
  for (Cube& cube : leavesOf(node))
    entered.leaves_[static_cast<std::size_t>((cube.first[0] - x) / kLeafSize)].push_back(
        std::move(cube));
  return entered;
}

std::array<Vec3d, kExpansionPoints> WindingBand::octantPoints() {
  const Sphere sphere(kSmallestCube);
  std::array<Vec3d, kExpansionPoints> points{};
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {sphere.offsets.x[i], sphere.offsets.y[i], sphere.offsets.z[i]};
  return points;
}

WindingBand::Octants::Octants(const WindingBand& band)
    : band_(band), sphere_(std::make_unique<const Sphere>(kSmallestCube)) {}
WindingBand::Octants::~Octants() = default;

bool WindingBand::Octants::evaluate(const Cube& leaf, std::size_t octant, Cube& scratch,
                                    VoxelValues& values) const {
  band_.enter(leaf, octant, *sphere_, scratch);
  if (!band_.mayPassHalf(scratch))
    return false;
  band_.evaluateVoxels(scratch, values);
  return true;
}

bool WindingBand::evaluate(const Node& node, int slab, SlabBits& flags,
                           std::vector<double>& values) const {
  std::fill_n(&flags.rows[0][0], 2 * kSlabRows, std::uint64_t(0));
  const Octants octants(*this);
  bool any = false;
  VoxelValues sums;
  Cube cube;
  for (const Cube& leaf : node.leaves_[static_cast<std::size_t>(slab)])
    for (std::size_t octant = 0; octant < 8; ++octant) {
      if (!octants.evaluate(leaf, octant, cube, sums))
        continue;
      any = true;
      const auto x0 = static_cast<std::size_t>(cube.first[0] - leaf.first[0]);
      const auto y0 = static_cast<std::size_t>(cube.first[1] & (kNodeSize - 1));
      const auto z0 = static_cast<std::size_t>(cube.first[2] & (kNodeSize - 1));
      for (std::size_t i = 0; i < sums.size(); i += kExpandedVoxels) {
        const std::size_t row = (x0 + i / 16) * kNodeSize + y0 + i / 4 % 4;
        flags.rows[row][z0 / 64] |= lowBits(kExpandedVoxels) << (z0 % 64);
        for (std::size_t z = 0; z < kExpandedVoxels; ++z)
          values[row * kNodeSize + z0 + z] = sums[i + z];
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
  for (double& value : values)
    value /= 4 * kPi;
}

} // namespace tetvdb
