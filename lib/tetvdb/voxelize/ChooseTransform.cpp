// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/ChooseTransform.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/voxelize/Slab.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

// Vectors never cross a function that is not inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

// OpenVDB refuses a transform whose determinant is below this (openvdb/math/Maps.h).
constexpr double kMinVoxelVolume = 3e-15;
constexpr double kMinVoxelSide = 1.45e-5; // of cubes, just above
// Voxel coordinates are int32; a margin of two root children is kept at both ends.
constexpr double kMaxIndex = 2147483648.0 - 2 * kRootChildSize;

using Range = tbb::blocked_range<std::size_t>;

typedef double Doubles __attribute__((vector_size(4 * sizeof(double))));
typedef std::int64_t Mask __attribute__((vector_size(4 * sizeof(double))));

WorldBox join(WorldBox a, const WorldBox& b) {
  a.add(b);
  return a;
}

void add(WorldBox& box, const Vec3d& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = std::min(box.min[k], p[k]);
    box.max[k] = std::max(box.max[k], p[k]);
    box.finite = box.finite && std::isfinite(p[k]);
  }
}

// Of `count` points. All but the last are read as four numbers.
TETVDB_MULTIVERSION void addPoints(const Vec3d* points, std::size_t count, WorldBox& box) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Doubles low = {infinity, infinity, infinity, infinity};
  Doubles high = -low;
  Mask infinite{};
  for (std::size_t i = 0; i + 1 < count; ++i) {
    Doubles p;
    std::memcpy(&p, &points[i], sizeof p);
    __builtin_prefetch(points + i + 192); // a page ahead, where processors stop
    low = p < low ? p : low;
    high = p > high ? p : high;
    infinite |= p - p != 0;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    box.min[k] = std::min(box.min[k], low[k]);
    box.max[k] = std::max(box.max[k], high[k]);
    box.finite = box.finite && infinite[k] == 0;
  }
  add(box, points[count - 1]);
}

// The box of all points by blocks.
constexpr std::size_t kBlock = 16384;

std::vector<WorldBox> boxesOfBlocks(const std::vector<Vec3d>& points) {
  std::vector<WorldBox> boxes((points.size() + kBlock - 1) / kBlock);
  tbb::parallel_for(Range(0, boxes.size()), [&](const Range& range) {
    for (std::size_t b = range.begin(); b != range.end(); ++b)
      addPoints(points.data() + b * kBlock, std::min(kBlock, points.size() - b * kBlock), boxes[b]);
  });
  return boxes;
}

// The sides of a box: axes 0 to 2, below, then above.
constexpr std::size_t kSides = 6;
constexpr std::uint32_t kAllSides = (1u << kSides) - 1;

double side(const WorldBox& box, std::size_t s) {
  return s < 3 ? box.min[s] : box.max[s - 3];
}

// A point on each side of the box of all.
std::array<std::uint32_t, kSides> pointsOnSides(const std::vector<Vec3d>& points,
                                                const std::vector<WorldBox>& blocks,
                                                const WorldBox& all) {
  std::array<std::uint32_t, kSides> found{};
  for (std::size_t s = 0; s < kSides; ++s) {
    std::size_t i = 0;
    while (side(blocks[i / kBlock], s) != side(all, s))
      i += kBlock;
    while (points[i][s % 3] != side(all, s))
      ++i;
    found[s] = static_cast<std::uint32_t>(i);
  }
  return found;
}

// Bits of those among `six` that are among `count` numbers.
TETVDB_MULTIVERSION std::uint32_t whichAreIn(const std::uint32_t* numbers, std::size_t count,
                                             const std::array<std::uint32_t, kSides>& six) {
  std::uint32_t bits = 0;
  for (std::size_t s = 0; s < kSides; ++s) {
    std::uint32_t found = 0;
    for (std::size_t k = 0; k < count; ++k)
      found |= static_cast<std::uint32_t>(numbers[k] == six[s]);
    bits |= found << s;
  }
  return bits;
}

// Calls find(begin, end) for parts of the indices until the bits that it returns are all sides'.
// From both ends: vertices are often numbered along an axis.
template <typename Find>
bool allSidesUsed(std::size_t indices, const Find& find) {
  std::atomic<std::uint32_t> used{0};
  const std::size_t chunk = 65536, chunks = (indices + chunk - 1) / chunk;
  tbb::parallel_for(
      Range(0, chunks, 1),
      [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end() && used != kAllSides; ++i) {
          const std::size_t at = i % 2 == 0 ? i / 2 : chunks - 1 - i / 2;
          used |= find(at * chunk, std::min((at + 1) * chunk, indices));
        }
      },
      tbb::simple_partitioner());
  return used == kAllSides;
}

} // namespace

void WorldBox::add(const WorldBox& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    min[k] = std::min(min[k], other.min[k]);
    max[k] = std::max(max[k], other.max[k]);
  }
  finite = finite && other.finite;
}

void WorldBox::grow(double length) {
  for (std::size_t k = 0; k < 3; ++k) {
    min[k] -= length;
    max[k] += length;
  }
}

// Usually all points are used, or the first on each side of the box of all points, or some on each
// side. It is then enough to look for these among the indices.
PointBoxes boxesOf(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices) {
  PointBoxes boxes;
  const std::vector<WorldBox> blocks = boxesOfBlocks(points);
  for (const WorldBox& block : blocks)
    boxes.all.add(block);
  boxes.used = boxes.all;
  if (boxes.all.finite && !points.empty()) {
    const std::array<std::uint32_t, kSides> first = pointsOnSides(points, blocks, boxes.all);
    if (allSidesUsed(indices.size(), [&](std::size_t begin, std::size_t end) {
          std::uint32_t bits = 0;
          for (std::size_t k = begin; k < end && bits != kAllSides; k += 1024) // in the first cache
            bits |= whichAreIn(&indices[k], std::min<std::size_t>(end - k, 1024), first);
          return bits;
        }))
      return boxes;
    std::vector<std::uint8_t> sides(points.size());
    tbb::parallel_for(Range(0, points.size(), 65536), [&](const Range& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        for (std::size_t s = 0; s < kSides; ++s)
          sides[i] = static_cast<std::uint8_t>(
              sides[i] | (points[i][s % 3] == side(boxes.all, s) ? 1 << s : 0));
    });
    if (allSidesUsed(indices.size(), [&](std::size_t begin, std::size_t end) {
          std::uint32_t bits = 0;
          for (std::size_t k = begin; k < end; ++k)
            bits |= sides[indices[k]];
          return bits;
        }))
      return boxes;
  }
  boxes.used = tbb::parallel_reduce(
      Range(0, indices.size(), 65536), WorldBox{},
      [&](const Range& range, WorldBox box) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          add(box, points[indices[i]]);
        return box;
      },
      join);
  return boxes;
}

WorldBox boxOfUsed(const std::vector<Vec3d>& points, const std::vector<std::uint32_t>& indices) {
  return boxesOf(points, indices).used;
}

namespace {

double longestSide(const WorldBox& box) {
  const double longest =
      std::max({box.max[0] - box.min[0], box.max[1] - box.min[1], box.max[2] - box.min[2]});
  if (!(longest > 0))
    throw Error(Status::Invalid, "", "all points of the mesh coincide");
  return longest;
}

// The option that an unusable size was given by.
const char* sizeOption(const VoxelizeOptions& options) {
  if (options.voxelSize[0] != 0)
    return "`voxel_size`";
  return options.fit.voxels > 0 ? "`fit`" : "`resolution`";
}

void checkSize(const Vec3d& size, const VoxelizeOptions& options) {
  for (double s : size)
    if (!(s > 0) || !std::isfinite(s))
      throw Error(Status::Usage, "`voxel_size`", fmt::format("{} is not a positive length", s));
  if (size[0] * size[1] * size[2] < kMinVoxelVolume)
    throw Error(
        options.voxelSize[0] == 0 ? Status::Limit : Status::Usage, sizeOption(options),
        fmt::format("a voxel of {:.4g} x {:.4g} x {:.4g} is below OpenVDB's smallest volume, "
                    "{:g} cubic units ({:g} a side)",
                    size[0], size[1], size[2], kMinVoxelVolume, kMinVoxelSide),
        "use larger voxels, or scale the model to a smaller unit: millimetres for metres");
}

// The requested origin, or one with which the box lies within 32-bit index space.
GridTransform placed(const WorldBox& box, const Vec3d& size, const VoxelizeOptions& options) {
  checkSize(size, options);
  GridTransform transform{size, options.origin};
  for (std::size_t k = 0; k < 3; ++k) {
    const double extent = (box.max[k] - box.min[k]) / size[k];
    if (!(extent < 2 * kMaxIndex - kRootChildSize))
      throw Error(
          Status::Limit, sizeOption(options),
          fmt::format("the mesh is {:.4g} voxels long, more than 32-bit index space holds", extent),
          "use larger voxels");
    const double low = (box.min[k] - transform.origin[k]) / size[k];
    const double high = (box.max[k] - transform.origin[k]) / size[k];
    if (low > -kMaxIndex && high < kMaxIndex)
      continue;
    // By whole root children, so that grids of one voxel size stay aligned.
    const double steps = std::floor((low + high) / 2 / kRootChildSize);
    transform.origin[k] += steps * kRootChildSize * size[k];
  }
  return transform;
}

// The centre of the box is that of the voxels 0 to fit.voxels - 1.
GridTransform centred(const WorldBox& box, double size, const VoxelizeOptions& options) {
  checkSize({size, size, size}, options);
  GridTransform transform{{size, size, size}, {}};
  for (std::size_t k = 0; k < 3; ++k)
    transform.origin[k] = box.min[k] + (box.max[k] - box.min[k]) / 2 -
                          size * (static_cast<double>(options.fit.voxels) - 1) / 2;
  return transform;
}

// The first of the sizes longest / voxels, the two next to it, and longest / (voxels - k lattice
// units), k = 1, 2, 4, ..., whose transform is right: rounding to the lattice adds up to a unit to
// a box, and so one voxel too many.
template <typename TransformOf, typename IsRight>
GridTransform smallestRight(double longest, double voxels, const TransformOf& transformOf,
                            const IsRight& isRight) {
  double size = longest / voxels;
  for (int neighbour = 0; neighbour < 3; ++neighbour, size = std::nextafter(size, 2 * size))
    if (const GridTransform transform = transformOf(size); isRight(transform))
      return transform;
  for (double less = kVoxelsPerUnit; less <= 0.5; less *= 2)
    if (const GridTransform transform = transformOf(longest / (voxels - less)); isRight(transform))
      return transform;
  throw Error(Status::Limit, "",
              "the mesh lies so far from the origin that its coordinates do not have the digits to "
              "place voxels of that size",
              "move it to the origin, or use larger voxels");
}

GridTransform byResolution(const WorldBox& box, const VoxelizeOptions& options, BoxEnds ends) {
  if (options.resolution < 1)
    throw Error(Status::Usage, "`resolution`", "must be 1 or more");
  const double longest = longestSide(box);
  return smallestRight(
      longest, options.resolution,
      [&](double size) {
        size = std::max(size, kMinVoxelSide);
        return placed(box, {size, size, size}, options);
      },
      [&](const GridTransform& transform) {
        return isWithinResolution(box, transform, options.resolution, ends);
      });
}

GridTransform byFit(const WorldBox& box, const VoxelizeOptions& options) {
  const FitBox& fit = options.fit;
  if (fit.padding < 0 || fit.padding > (fit.voxels - 1) / 2)
    throw Error(Status::Usage, "`padding`",
                fmt::format("{} voxels on each side leave none of {} for the model", fit.padding,
                            fit.voxels),
                "give less than half of the voxels of `fit`");
  return smallestRight(
      longestSide(box), fit.voxels - 2 * fit.padding,
      [&](double size) { return centred(box, size, options); },
      [&](const GridTransform& transform) { return isWithinFit(box, transform, fit); });
}

} // namespace

bool isWithinResolution(const WorldBox& box, const GridTransform& transform, int voxels,
                        BoxEnds ends) {
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = snapToLattice(box.min[k], transform.origin[k], transform.voxelSize[k]);
    const double high = snapToLattice(box.max[k], transform.origin[k], transform.voxelSize[k]);
    // A half-open interval that is no longer than `voxels` has no more centres, wherever it lies.
    if (ends == BoxEnds::OneIn && high - low > voxels * static_cast<double>(kUnitsPerVoxel))
      return false;
    if (ends == BoxEnds::BothIn && floorVoxel(high + 1) - ceilVoxel(low - 1) >= voxels)
      return false;
  }
  return true;
}

bool isWithinFit(const WorldBox& box, const GridTransform& transform, const FitBox& fit) {
  constexpr double half = static_cast<double>(kUnitsPerVoxel) / 2;
  for (std::size_t k = 0; k < 3; ++k) {
    const double low = snapToLattice(box.min[k], transform.origin[k], transform.voxelSize[k]);
    const double high = snapToLattice(box.max[k], transform.origin[k], transform.voxelSize[k]);
    if (low < (2.0 * fit.padding - 1) * half ||
        high > (2.0 * (static_cast<double>(fit.voxels) - fit.padding) - 1) * half)
      return false;
  }
  return true;
}

GridTransform chooseTransform(const WorldBox& box, const VoxelizeOptions& options, BoxEnds ends) {
  for (double c : options.origin)
    if (!std::isfinite(c))
      throw Error(Status::Usage, "`origin`", "not a finite number");
  if (!box.finite)
    throw Error(Status::Invalid, "", "a coordinate of the mesh is not a finite number",
                "repair the mesh");
  const Vec3d& h = options.voxelSize;
  if (h[0] != 0 || h[1] != 0 || h[2] != 0)
    return placed(box, h, options);
  return options.fit.voxels > 0 ? byFit(box, options) : byResolution(box, options, ends);
}

void reportTransform(const GridTransform& transform, const VoxelizeOptions& options,
                     Report& report) {
  if (options.voxelSize[0] == 0 && options.fit.voxels == 0 &&
      transform.voxelSize[0] == kMinVoxelSide)
    report.warn("smallest-voxels",
                fmt::format("the mesh has fewer than {} voxels on a side: OpenVDB has none smaller "
                            "than {:g} units; scale the model to a smaller unit, for example by "
                            "1000 from metres to millimetres",
                            options.resolution, kMinVoxelSide));
  if (transform.origin == options.origin || options.fit.voxels > 0)
    return;
  report.warn("origin-moved",
              fmt::format("the mesh lies outside 32-bit index space; the origin was moved to "
                          "{}, {}, {}, a multiple of {} voxels",
                          transform.origin[0], transform.origin[1], transform.origin[2],
                          kRootChildSize));
}

} // namespace tetvdb
