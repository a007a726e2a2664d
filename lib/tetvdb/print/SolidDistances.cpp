// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/SolidDistances.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/volume/VoxelBox.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <tbb/concurrent_vector.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

using FloatLeaf = openvdb::FloatTree::LeafNodeType;

constexpr double kMargin = 2;                 // voxels around those that may be in the range
constexpr double kSlack = 1e-9;               // relative: above the rounding error of a distance
constexpr std::int32_t kParallel = 16;        // blocks of more voxels are halved in parallel
constexpr std::int32_t kLongestBox = 1 << 28; // voxels along the box

struct Block {
  openvdb::Coord first;
  std::int32_t size = 0;
};

// Blocks of voxels, halved down to one voxel where distances may be in the range: distances within
// a block differ from its midpoint's by at most the distance to it.
class Descent {
public:
  using LeafSink = std::function<void(std::unique_ptr<FloatLeaf>)>;
  /// A block that is entirely farther, entirely closer, or on the other side.
  using RestSink = std::function<void(const Block&, bool far, bool beside)>;
  using Side = std::function<bool(const openvdb::Coord& at)>;

  // `low`, `high`: voxels.
  Descent(const TriangleScene& scene, const GridTransform& transform, const VoxelBox& box,
          double low, double high, const Side& isWanted, const LeafSink& sink, const RestSink& rest,
          Progress& progress)
      : scene_(scene), transform_(transform), box_(box), low_(low), high_(high),
        isWanted_(isWanted), sink_(sink), rest_(rest), progress_(progress),
        leaves_(std::max(1.0, box.voxels() / double(FloatLeaf::SIZE))) {}

  void run() {
    Block block{openvdb::Coord(box_.low.data()), kLeafSize};
    for (std::size_t k = 0; k < 3; ++k)
      while (static_cast<std::uint64_t>(block.size) < box_.size(k))
        block.size *= 2;
    descend(block, nullptr);
  }

private:
  enum class Place : std::uint8_t { Between, Near, Far };

  struct Nearest {
    Vec3d point;
    double distance; // voxels, from the query point
  };

  Vec3d midpointOf(const Block& block) const {
    Vec3d p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = transform_.origin[k] +
             transform_.voxelSize[k] * (block.first[k] + 0.5 * (block.size - 1));
    return p;
  }

  double voxels(double length) const { return length / transform_.voxelSize[0]; }

  // `near`, unless null: a point of the surface close to the nearest one.
  Nearest nearestTo(const Vec3d& p, const Nearest* near) const {
    if (near == nullptr) {
      const TriangleScene::Closest closest = scene_.closest(p);
      return {closest.point, voxels(closest.distance)};
    }
    const double bound = length(minus(near->point, p));
    const TriangleScene::Closest closest = scene_.closest(p, bound * (1 + kSlack));
    if (closest.distance < bound)
      return {closest.point, voxels(closest.distance)};
    return {near->point, voxels(bound)};
  }

  // `distance` is the midpoint's, and voxel centres are at most `half` from it.
  Place placeOf(double distance, double half) const {
    const double slack = kSlack * (distance + half);
    if (distance + half + slack < low_)
      return Place::Near;
    return distance - half - slack > high_ ? Place::Far : Place::Between;
  }

  static double halfOf(const Block& block) { return std::sqrt(0.75) * (block.size - 1); }

  static Block eighth(const Block& block, int i) {
    const std::int32_t half = block.size / 2;
    return {block.first.offsetBy((i >> 2 & 1) * half, (i >> 1 & 1) * half, (i & 1) * half), half};
  }

  bool meetsBox(const Block& block) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (block.first[k] > box_.high[k])
        return false;
    return true; // blocks begin at the box's low corner
  }

  void passed(const Block& block) {
    const std::uint64_t along = static_cast<std::uint64_t>(block.size / kLeafSize);
    progress_.update(
        std::min(1.0, static_cast<double>(passed_ += along * along * along) / leaves_));
  }

  void descend(const Block& block, const Nearest* near) {
    const Nearest nearest = nearestTo(midpointOf(block), near);
    const double half = halfOf(block);
    const Place place = placeOf(nearest.distance, half);
    // Blocks without a face between their voxels are on one side.
    const bool isBeside = nearest.distance > half * (1 + kSlack) && !isWanted_(block.first);
    if (place != Place::Between || isBeside) {
      rest_(block, place == Place::Far, isBeside);
      passed(block);
      return;
    }
    if (block.size == kLeafSize) {
      auto leaf = std::make_unique<FloatLeaf>(block.first, 0.0f, true);
      fill(block, nearest, leaf->buffer().data());
      sink_(std::move(leaf));
      passed(block);
      return;
    }
    const auto one = [&](int i) {
      if (const Block child = eighth(block, i); meetsBox(child))
        descend(child, &nearest);
    };
    if (block.size > kParallel) {
      tbb::parallel_for(0, 8, one);
    } else {
      for (int i = 0; i < 8; ++i)
        one(i);
    }
  }

  // The voxels of a block within a leaf; the others are 0.
  void fill(const Block& block, const Nearest& nearest, float* leaf) const {
    for (int i = 0; i < 8; ++i) {
      const Block child = eighth(block, i);
      const Vec3d p = midpointOf(child);
      // From the block's midpoint to that of an eighth: bounds without a search.
      const double above = voxels(length(minus(nearest.point, p)));
      const double below = nearest.distance - std::sqrt(0.1875) * block.size;
      const double half = halfOf(child);
      if (above + half + kSlack * above < low_)
        continue;
      if (below - half - kSlack * nearest.distance > high_) {
        put(child, high_, leaf);
        continue;
      }
      const Nearest own = nearestTo(p, &nearest);
      const Place place = placeOf(own.distance, half);
      if (place == Place::Far)
        put(child, high_, leaf);
      else if (place == Place::Between && child.size > 1)
        fill(child, own, leaf);
      else if (place == Place::Between)
        put(child, own.distance, leaf);
    }
  }

  static void put(const Block& block, double distance, float* leaf) {
    const auto square = static_cast<float>(distance * distance);
    const openvdb::Coord at = block.first & (kLeafSize - 1);
    for (std::int32_t x = at.x(); x < at.x() + block.size; ++x)
      for (std::int32_t y = at.y(); y < at.y() + block.size; ++y)
        for (std::int32_t z = at.z(); z < at.z() + block.size; ++z)
          leaf[(x * kLeafSize + y) * kLeafSize + z] = square;
  }

  const TriangleScene& scene_;
  const GridTransform& transform_;
  const VoxelBox& box_;
  const double low_, high_;
  const Side& isWanted_;
  const LeafSink& sink_;
  const RestSink& rest_;
  Progress& progress_;
  const double leaves_;
  std::atomic<std::uint64_t> passed_{0};
};

std::int32_t leafBelow(double voxel) {
  return static_cast<std::int32_t>(std::floor(voxel / kLeafSize)) * kLeafSize;
}

// Whole leaves around the points within `reach` voxels of the mesh.
VoxelBox boxAround(const TriangleMesh& mesh, const GridTransform& transform, double reach) {
  const WorldBox world = boxOf(mesh, {});
  VoxelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double size = transform.voxelSize[k];
    const double low = (world.min[k] - transform.origin[k]) / size - reach;
    const double high = (world.max[k] - transform.origin[k]) / size + reach;
    if (high - low > kLongestBox)
      throw Error(Status::Limit, "", "the solid is more than 2^28 voxels long",
                  "use a larger `voxel_size`");
    box.low[k] = leafBelow(low);
    box.high[k] = leafBelow(high) + kLeafSize - 1;
  }
  return box;
}

// Sets voxels on the other side to zero.
void keepSide(FloatLeaf& leaf, const openvdb::BoolTree& inside, bool wanted) {
  const auto* mask = inside.probeConstLeaf(leaf.origin());
  const bool all = mask == nullptr && inside.isValueOn(leaf.origin());
  float* values = leaf.buffer().data();
  for (openvdb::Index i = 0; i < FloatLeaf::SIZE; ++i)
    if ((mask != nullptr ? mask->isValueOn(i) : all) != wanted)
      values[i] = 0;
}

} // namespace

SolidDistances::SolidDistances(const TriangleMesh& mesh, const GridTransform& transform,
                               std::size_t maxMemory, Report& report, Progress& progress)
    : mesh_(mesh), scene_(mesh) {
  VoxelizeOptions options;
  options.voxelSize = transform.voxelSize;
  options.origin = transform.origin;
  options.grids = {GridKind::Mask};
  options.allowEmpty = true;
  options.maxMemory = maxMemory;
  const Voxelization made = voxelize(mesh, {}, options, report, progress);
  transform_ = made.transform;
  inside_ = openvdb::gridPtrCast<openvdb::BoolGrid>(made.volume.grids().all.front());
}

openvdb::FloatGrid::Ptr SolidDistances::between(SolidSide side, double low, double high,
                                                Progress& progress) const {
  const double voxel = transform_.voxelSize[0];
  const auto far = static_cast<float>(high / voxel * (high / voxel));
  const bool inside = side == SolidSide::Inside;
  const openvdb::BoolTree& mask = inside_->constTree();
  tbb::concurrent_vector<std::unique_ptr<FloatLeaf>> leaves;
  tbb::concurrent_vector<Block> blocks; // blocks with other values than the background
  const VoxelBox box = boxAround(mesh_, transform_, inside ? 0 : high / voxel + kMargin);
  const Descent::LeafSink sink = [&](std::unique_ptr<FloatLeaf> leaf) {
    keepSide(*leaf, mask, inside);
    leaves.push_back(std::move(leaf));
  };
  const Descent::Side isWanted = [&](const openvdb::Coord& at) {
    return mask.isValueOn(at) == inside;
  };
  const Descent::RestSink rest = [&](const Block& block, bool isFar, bool isBeside) {
    if (inside == (isFar && !isBeside))
      blocks.push_back(block);
  };
  Descent(scene_, transform_, box, low / voxel, high / voxel, isWanted, sink, rest, progress).run();
  auto grid = openvdb::FloatGrid::create(inside ? 0.0f : far);
  for (const Block& block : blocks)
    grid->tree().fill(openvdb::CoordBBox::createCube(block.first, block.size), inside ? far : 0.0f,
                      false);
  for (auto& leaf : leaves)
    grid->tree().addLeaf(leaf.release());
  grid->setTransform(makeTransform(transform_));
  return grid;
}

GridTransform offsetTransform(const TriangleMesh& mesh, double voxel) {
  constexpr double kOffFaces = 0.38; // voxels from the box's sides to the nearest centres
  VoxelizeOptions options;
  options.voxelSize.fill(voxel);
  options.origin = minus(boxOf(mesh, {}).min, times(options.voxelSize, kOffFaces));
  return chooseTransform(mesh, options);
}

void requireMemory(const TriangleMesh& mesh, double voxel, double bytesPerSquare,
                   std::size_t maxMemory) {
  constexpr double kRoom = 1.05; // margin, so that the reported size suffices
  const double bytes = bytesPerSquare * areaOf(mesh) / (voxel * voxel);
  const auto memory = static_cast<double>(maxMemory > 0 ? maxMemory : availableBytes());
  if (bytes > memory)
    throw Error(Status::Limit, "",
                fmt::format("a surface in voxels of {:.4g} needs about {:.0f} MB, there are {:.0f}",
                            voxel, bytes / 1e6, memory / 1e6),
                fmt::format("use `voxel_size={:.3g}` or larger, or raise `max_memory`",
                            voxel * std::sqrt(bytes / memory) * kRoom));
}

} // namespace tetvdb
