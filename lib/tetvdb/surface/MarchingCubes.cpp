// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/MarchingCubes.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoundaryEdgeSums.h"
#include "tetvdb/geometry/BoundaryWinding.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CubeTable.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr double kMargin = 0.05; ///< of the distance between voxels, at both ends
/// Extension of the segment at both ends, to cross faces that pass through a voxel's centre.
constexpr double kReach = 1e-6;

// A block's vertices: one on every crossed edge that begins in the block.
struct Block {
  Vec3i origin;
  /// Bit 8 y + z of [8 axis + x]: the edge from voxel (x, y, z) along the axis is crossed.
  std::array<std::uint64_t, 24> crossed{};
  std::array<std::uint16_t, 24> before{}; ///< vertices of the words before this one
  std::uint32_t vertices = 0, triangles = 0, cubes = 0;
  std::size_t firstVertex = 0, firstTriangle = 0, firstCube = 0;

  std::uint32_t vertex(int axis, int x, int y, int z) const {
    const auto word = static_cast<std::size_t>(8 * axis + x);
    const std::uint64_t below = (std::uint64_t(1) << (8 * y + z)) - 1;
    return static_cast<std::uint32_t>(firstVertex) + before[word] +
           static_cast<std::uint32_t>(__builtin_popcountll(crossed[word] & below));
  }
};

// A vertex on an edge from `voxel`, relative to its block, that meets no face.
struct HoleVertex {
  std::size_t vertex;
  Vec3i voxel;
  std::size_t axis;
};

unsigned cubeCase(const BlockSamples& samples, int x, int y, int z) {
  unsigned inside = 0;
  for (int corner = 0; corner < 8; ++corner)
    inside |= unsigned(samples.isInside(x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)))
              << corner;
  return inside;
}

bool isUniform(const BlockSamples& samples) {
  const std::uint16_t first = samples.inside[0];
  return (first == 0 || first == 0x1FF) &&
         std::all_of(samples.inside.begin(), samples.inside.end(),
                     [&](std::uint16_t row) { return row == first; });
}

template <class Visit>
void forEachVoxel(const Visit& visit) {
  for (int x = 0; x < kBlock; ++x)
    for (int y = 0; y < kBlock; ++y)
      for (int z = 0; z < kBlock; ++z)
        visit(x, y, z);
}

// Computes the crossed edges and the numbers of vertices and triangles.
void count(const BlockSamples& samples, Block& block) {
  forEachVoxel([&](int x, int y, int z) {
    const bool here = samples.isInside(x, y, z);
    const std::uint64_t bit = std::uint64_t(1) << (8 * y + z);
    for (int axis = 0; axis < 3; ++axis)
      if (samples.isInside(x + (axis == 0), y + (axis == 1), z + (axis == 2)) != here)
        block.crossed[static_cast<std::size_t>(8 * axis + x)] |= bit;
    const auto triangles =
        static_cast<std::uint32_t>(cubeTable()[cubeCase(samples, x, y, z)].size() / 3);
    block.triangles += triangles;
    block.cubes += triangles > 0;
  });
  for (std::size_t word = 0; word < 24; ++word) {
    block.before[word] = static_cast<std::uint16_t>(block.vertices);
    block.vertices += static_cast<std::uint32_t>(__builtin_popcountll(block.crossed[word]));
  }
}

// The hit at which a ray from outside to inside finally enters the solid: where the number of
// entered minus left faces last rises above 0. If it never does, since faces may have any
// orientation, the first hit. Null without hits.
const TriangleScene::Hit* entrance(const std::vector<TriangleScene::Hit>& hits, bool backward) {
  if (hits.empty())
    return nullptr;
  int depth = 0;
  const TriangleScene::Hit* found = backward ? &hits.back() : &hits.front();
  const auto pass = [&](const TriangleScene::Hit& hit) {
    const bool entering = hit.leaving == backward;
    depth += entering ? 1 : -1;
    if (entering && depth == 1)
      found = &hit;
  };
  if (backward)
    std::for_each(hits.rbegin(), hits.rend(), pass);
  else
    std::for_each(hits.begin(), hits.end(), pass);
  return found;
}

class Marching {
public:
  Marching(const SolidSamples& samples, const SampledShape& original, Progress& progress,
           MarchedCubes* marched)
      : samples_(samples), original_(original), progress_(progress), marched_(marched) {}

  TriangleMesh run() {
    findBlocks();
    TriangleMesh mesh;
    mesh.points.resize(numberVertices());
    if (marched_ != nullptr) {
      marched_->contacts.assign(mesh.points.size(), {});
      marched_->cubes.assign(cubes_, {});
    }
    forEachBlock(0.2, 0.6, [&](const Block& block) { place(block, mesh.points); });
    separate(mesh.points);
    mesh.triangles.resize(3 * triangles_);
    forEachBlock(0.8, 0.2, [&](const Block& block) { connect(block, mesh.triangles.data()); });
    mesh.faceCount = mesh.triangleCount();
    return mesh;
  }

private:
  template <class Work>
  void forEachBlock(double from, double share, const Work& work) {
    std::atomic<std::size_t> done{0};
    tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t i) {
      work(blocks_[i]);
      const std::size_t now = ++done;
      if (now % 64 == 0)
        progress_.update(from +
                         share * static_cast<double>(now) / static_cast<double>(blocks_.size()));
    });
  }

  void findBlocks() {
    const std::vector<Vec3i> candidates = samples_.blocks(progress_);
    std::vector<char> isCrossed(candidates.size(), 0);
    std::vector<Block> counted(candidates.size());
    tbb::parallel_for(std::size_t(0), candidates.size(), [&](std::size_t i) {
      BlockSamples block;
      samples_.load(candidates[i], block);
      if (isUniform(block))
        return;
      isCrossed[i] = 1;
      counted[i].origin = candidates[i];
      count(block, counted[i]);
      progress_.check();
    });
    for (std::size_t i = 0; i < candidates.size(); ++i)
      if (isCrossed[i])
        blocks_.push_back(counted[i]);
  }

  std::size_t numberVertices() {
    std::size_t vertices = 0;
    for (Block& block : blocks_) {
      block.firstVertex = vertices;
      block.firstTriangle = triangles_;
      block.firstCube = cubes_;
      vertices += block.vertices;
      triangles_ += block.triangles;
      cubes_ += block.cubes;
    }
    if (vertices >= std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "the surface has more than 2^32 vertices",
                  "use larger voxels");
    return vertices;
  }

  Vec3d world(const Vec3d& index) const {
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = samples_.transform.origin[axis] + index[axis] * samples_.transform.voxelSize[axis];
    return p;
  }

  // Calls visit(vertex, voxel, axis) for the vertices of a block in order.
  template <class Visit>
  static void forEachVertex(const Block& block, const Visit& visit) {
    std::size_t vertex = block.firstVertex;
    for (int word = 0; word < 24; ++word)
      for (std::uint64_t bits = block.crossed[static_cast<std::size_t>(word)]; bits != 0;
           bits &= bits - 1) {
        const int bit = __builtin_ctzll(bits);
        visit(vertex++, Vec3i{word % 8, bit / 8, bit % 8}, static_cast<std::size_t>(word / 8));
      }
  }

  Vec3d onEdge(const Block& block, const Vec3i& voxel, std::size_t axis, double t) const {
    Vec3d index;
    for (std::size_t k = 0; k < 3; ++k)
      index[k] = double(block.origin[k]) + voxel[k];
    index[axis] += t;
    return world(index);
  }

  // The position at which the distance to the scene passes the given one, by bisection.
  template <class Position>
  double passage(const Position& position, bool startInside) const {
    double low = 0, high = 1;
    for (int step = 0; step < 12; ++step) {
      const double midpoint = (low + high) / 2;
      const bool inside =
          original_.scene->closest(position(midpoint), original_.distance).distance <
          original_.distance;
      (inside == startInside ? low : high) = midpoint;
    }
    return (low + high) / 2;
  }

  void place(const Block& block, std::vector<Vec3d>& points) const {
    BlockSamples samples;
    samples_.load(block.origin, samples);
    std::vector<TriangleScene::Hit> hits;
    std::vector<HoleVertex> holes;
    forEachVertex(block, [&](std::size_t vertex, const Vec3i& v, std::size_t axis) {
      const bool startInside = samples.isInside(v[0], v[1], v[2]);
      const Vec3i voxel{block.origin[0] + v[0], block.origin[1] + v[1], block.origin[2] + v[2]};
      double t = samples_.passage(voxel, axis, startInside);
      if (std::isnan(t))
        t = original_.scene != nullptr ? onOriginal(block, v, axis, vertex, startInside, hits)
            : samples_.hasHeights()    ? whereHeightsPass(samples, v, axis)
                                       : 0.5;
      if (std::isnan(t) && original_.boundary != nullptr)
        holes.push_back({vertex, v, axis});
      if (std::isnan(t))
        t = 0.5;
      points[vertex] = onEdge(block, v, axis, std::clamp(t, kMargin, 1 - kMargin));
    });
    if (!holes.empty())
      placeInHoles(block, holes, points);
  }

  // NaN if no face is met.
  double onOriginal(const Block& block, const Vec3i& v, std::size_t axis, std::size_t vertex,
                    bool startInside, std::vector<TriangleScene::Hit>& hits) const {
    if (original_.distance > 0)
      return passage([&](double at) { return onEdge(block, v, axis, at); }, startInside);
    Vec3d direction{0, 0, 0};
    direction[axis] = samples_.transform.voxelSize[axis];
    original_.scene->crossings(onEdge(block, v, axis, -kReach), direction, 1 + 2 * kReach, hits);
    const TriangleScene::Hit* hit = entrance(hits, startInside);
    if (hit == nullptr)
      return std::numeric_limits<double>::quiet_NaN();
    const double t = hit->t - kReach;
    if (marched_ != nullptr)
      marched_->contacts[vertex] = contactAt(onEdge(block, v, axis, t), *hit, axis, startInside);
    return t;
  }

  // Places vertices where the winding number, evaluated for all together, passes 0.5.
  void placeInHoles(const Block& block, const std::vector<HoleVertex>& holes,
                    std::vector<Vec3d>& points) const {
    constexpr auto unit = static_cast<double>(kUnitsPerVoxel);
    constexpr double half = kBlock / 2.0;
    const auto numberOf = [](const Vec3i& v) {
      return (std::size_t(v[0]) * kSamples + std::size_t(v[1])) * kSamples + std::size_t(v[2]);
    };
    const auto next = [](const HoleVertex& hole) {
      Vec3i v = hole.voxel;
      ++v[hole.axis];
      return v;
    };
    std::array<std::uint16_t, std::size_t(kSamples) * kSamples * kSamples> place{}; // plus one
    for (const HoleVertex& hole : holes)
      place[numberOf(hole.voxel)] = place[numberOf(next(hole))] = 1;
    BoundaryPoints centres;
    for (int x = 0; x < kSamples; ++x)
      for (int y = 0; y < kSamples; ++y)
        for (int z = 0; z < kSamples; ++z) {
          std::uint16_t& at = place[numberOf({x, y, z})];
          if (at == 0)
            continue;
          centres.x.push_back((block.origin[0] + x) * unit);
          centres.y.push_back((block.origin[1] + y) * unit);
          centres.z.push_back((block.origin[2] + z) * unit);
          at = static_cast<std::uint16_t>(centres.size());
        }
    original_.boundary->at({(block.origin[0] + half) * unit, (block.origin[1] + half) * unit,
                            (block.origin[2] + half) * unit},
                           std::sqrt(3.0) * half * unit, centres);
    for (const HoleVertex& hole : holes) {
      const double t = halfCrossing(centres.sum[place[numberOf(hole.voxel)] - 1u],
                                    centres.sum[place[numberOf(next(hole))] - 1u]);
      points[hole.vertex] =
          onEdge(block, hole.voxel, hole.axis, std::clamp(t, kMargin, 1 - kMargin));
    }
  }

  static double whereHeightsPass(const BlockSamples& samples, const Vec3i& v, std::size_t axis) {
    const double start = samples.heightAt(v[0], v[1], v[2]);
    const double end = samples.heightAt(v[0] + (axis == 0), v[1] + (axis == 1), v[2] + (axis == 2));
    return start / (start - end);
  }

  // Faces may have any orientation: the normal is directed to the voxel outside.
  ShapeContact contactAt(const Vec3d& point, const TriangleScene::Hit& hit, std::size_t axis,
                         bool startInside) const {
    Vec3d n = original_.scene->normal(hit.triangle);
    if ((n[axis] > 0) != startInside)
      n = times(n, -1);
    return {point, {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])}};
  }

  void connect(const Block& block, std::uint32_t* triangles) const {
    BlockSamples samples;
    samples_.load(block.origin, samples);
    std::array<const Block*, 8> around{};
    around[0] = &block;
    std::uint32_t* next = triangles + 3 * block.firstTriangle;
    std::size_t cube = block.firstCube;
    forEachVoxel([&](int x, int y, int z) {
      const CubeTriangles& corners = cubeTable()[cubeCase(samples, x, y, z)];
      if (marched_ != nullptr && !corners.empty())
        marched_->cubes[cube++] = {{block.origin[0] + x, block.origin[1] + y, block.origin[2] + z},
                                   static_cast<std::uint8_t>(corners.size() / 3)};
      for (const int edge : corners) {
        const Vec3i start = cubeEdgeStart(edge);
        const int vx = x + start[0], vy = y + start[1], vz = z + start[2];
        const auto neighbour = static_cast<std::size_t>(vx >> 3 | vy >> 3 << 1 | vz >> 3 << 2);
        if (around[neighbour] == nullptr)
          around[neighbour] = find(block.origin, vx >> 3, vy >> 3, vz >> 3);
        *next++ = around[neighbour]->vertex(edge / 4, vx & 7, vy & 7, vz & 7);
      }
    });
  }

  // Blocks are in ascending order. Every crossed edge begins in one of them.
  const Block* find(const Vec3i& origin, int dx, int dy, int dz) const {
    const Vec3i at{origin[0] + kBlock * dx, origin[1] + kBlock * dy, origin[2] + kBlock * dz};
    return &*std::lower_bound(blocks_.begin(), blocks_.end(), at,
                              [](const Block& b, const Vec3i& o) { return b.origin < o; });
  }

  // Vertices differ by at least a twentieth of a voxel along one axis. If floats are not finer than
  // that, vertices that are equal move to the midpoint.
  void separate(std::vector<Vec3d>& points) {
    if (points.empty() || floatsAreFine(points))
      return;
    const std::vector<std::uint32_t> equal = equalAsFloats(points);
    std::vector<char> isEqual(points.size(), 0);
    for (const std::uint32_t v : equal)
      isEqual[v] = 1;
    for (const Block& block : blocks_)
      forEachVertex(block, [&](std::size_t vertex, const Vec3i& voxel, std::size_t axis) {
        if (isEqual[vertex])
          points[vertex] = onEdge(block, voxel, axis, 0.5);
      });
    if (!equalAsFloats(points).empty())
      throw Error(Status::Limit, "",
                  "the surface is so far from the origin that 32-bit floats, as in STL, cannot "
                  "tell its vertices apart",
                  "move the model nearer to the origin or use larger voxels");
  }

  bool floatsAreFine(const std::vector<Vec3d>& points) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double far = 0;
      for (const Vec3d& p : points)
        far = std::max(far, std::abs(p[axis]));
      if (!(far * 0x1p-22 < kMargin * samples_.transform.voxelSize[axis]) || far > 1e38)
        return false;
    }
    return true;
  }

  const SolidSamples& samples_;
  const SampledShape original_;
  Progress& progress_;
  MarchedCubes* marched_; ///< may be null
  std::vector<Block> blocks_;
  std::size_t triangles_ = 0, cubes_ = 0;
};

} // namespace

TriangleMesh marchCubes(const SolidSamples& samples, const SampledShape& original,
                        Progress& progress, MarchedCubes* marched) {
  return Marching(samples, original, progress, marched).run();
}

} // namespace tetvdb
