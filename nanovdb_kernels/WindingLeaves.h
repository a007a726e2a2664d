// SPDX-License-Identifier: Apache-2.0
//
// The solid angles of the triangles over the holes of an open soup, at the voxels where its winding
// number may pass a half off its faces: a team takes an octant of a leaf, and its members the
// points of the expansion, then the triangles that are near, then the voxels. All decisions and
// sums are those of voxelize/WindingBand.h, in the same order, and so are the bits.
#pragma once

#include "HolesView.h"
#include "KeySpace.h"
#include "Team.h"
#include "tetvdb/geometry/TriangleAngle.h"
#include "tetvdb/geometry/WindingCube.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace tetvdb::nano {

/// Where voxels of leaves have values.
struct WindingValues {
  u32* octants = nullptr;   ///< of a leaf: bit o where octant o has values
  double* values = nullptr; ///< solid angles over 4 pi: 512 a leaf, 64 an octant

  /// Value of voxel (x, y, z) of a leaf; null where there is none.
  TETVDB_HD const double* at(u64 leaf, int x, int y, int z) const {
    const int octant = (x >> 2) << 2 | (y >> 2) << 1 | z >> 2;
    if ((octants[leaf] >> octant & 1) == 0)
      return nullptr;
    return values + leaf * 512 +
           static_cast<u64>(octant * 64 + ((x & 3) * 4 + (y & 3)) * 4 + (z & 3));
  }
};

struct OctantShared {
  static constexpr int kThreads = 64, kOccupancy = 16;
  static constexpr u32 kMaxNear = 768, kMaxWhole = 128;
  double far[kExpansionStride];
  double number[64];    // of 64 triangles
  u32 near[kMaxNear];   // triangles
  u32 whole[kMaxWhole]; // clusters
  u32 nearCount, wholeCount;
  u32 left;     // whether the host has to do it
  u8 isFar[64]; // of 64 triangles
};

/// Arrays of HolesView where the backend computes.
struct PlacedHoles {
  const FillTriangle* triangles;
  const double* areas;
  const TriangleClusters::Cluster* clusters;
  const WindingLeaf* leaves;
  const Expansion* far;
  const u32* near;
  const Vec3d* points;
  const ExpansionTables* tables;
  double tolerance;
};

/// One octant, by one member of a team or all.
class OctantOfLeaf {
public:
  TETVDB_HD OctantOfLeaf(const Team& team, const PlacedHoles& holes, u64 leaf, u64 octant,
                         OctantShared& s)
      : team_(team), holes_(holes), leaf_(holes.leaves[leaf]), s_(s),
        radius_(winding::radiusOf(kSize)) {
    i64 first[3];
    for (int k = 0; k < 3; ++k)
      first[k] = leaf_.first[k] + ((octant >> (2 - k) & 1) != 0 ? kSize : 0);
    centre_ = winding::centreOf(first, kSize);
    if (team.rank() == 0)
      s.nearCount = s.wholeCount = s.left = 0;
    const double* around = holes.far[leaf].values.data();
    for (int j = team.rank(); j < static_cast<int>(kExpansionStride); j += team.size()) {
      double sum = 0;
      for (u64 i = 0; i < kExpansionPoints; ++i)
        sum += holes.tables->octants[octant][i][j] * around[i];
      s.far[j] = sum;
    }
    team.sync();
  }

  /// Adds what is far to the expansion and lists what is near.
  TETVDB_HD void sort() {
    const u32* near = holes_.near + leaf_.near;
    for (u32 i = 0; i < leaf_.clusters; ++i)
      sortCluster(near[i]);
    near += leaf_.clusters;
    for (u32 first = 0; first < leaf_.triangles; first += 64) {
      const u32 count = leaf_.triangles - first < 64 ? leaf_.triangles - first : 64;
      for (u32 k = static_cast<u32>(team_.rank()); k < count; k += static_cast<u32>(team_.size()))
        s_.isFar[k] = isFar(near[first + k]);
      team_.sync();
      for (u32 k = 0; k < count; ++k)
        take(near[first + k], s_.isFar[k] != 0);
      team_.sync();
    }
    team_.sync();
  }

  /// WindingBand::mayPassHalf().
  TETVDB_HD bool mayPassHalf() {
    const double reach = winding::reachOf(kSize), max = winding::kMaxChange;
    const ExpansionRange range = rangeOf(holes_.tables->rule, s_.far, reach / radius_);
    double change = range.change;
    forNear(
        [&](const FillTriangle& t, u32 index) {
          return winding::changeOf(seenFrom(centre_, t), holes_.areas[index], t.weight, reach);
        },
        change, max);
    for (u32 i = 0; i < s_.wholeCount && change < max; ++i)
      change += winding::changeOf(holes_.clusters[s_.whole[i]], centre_, reach);
    if (!(change < max))
      return true;
    double midpoint = range.midpoint;
    const Vec3d here{0, 0, 0};
    forNear([&](const FillTriangle& t, u32) { return angleAt(t, here); }, midpoint,
            std::numeric_limits<double>::infinity());
    addWhole(here, midpoint);
    return winding::mayPass(midpoint, change);
  }

  /// Solid angle at a voxel.
  TETVDB_HD double valueAt(int voxel) {
    double sum = 0;
    for (u64 i = 0; i < kExpansionPoints; ++i)
      sum += holes_.tables->voxels[i][voxel] * s_.far[i];
    const Vec3d at = winding::voxelOffset(static_cast<std::size_t>(voxel));
    for (u32 i = 0; i < s_.nearCount; ++i)
      sum += angleAt(holes_.triangles[s_.near[i]], at);
    addWhole(at, sum);
    return sum;
  }

private:
  static constexpr i64 kSize = static_cast<i64>(kExpandedVoxels);

  TETVDB_HD bool isFar(u32 triangle) const {
    return winding::isFar(seenFrom(centre_, holes_.triangles[triangle]), holes_.areas[triangle],
                          radius_, holes_.tolerance);
  }

  TETVDB_HD void take(u32 triangle, bool far) {
    if (far)
      addFar(holes_.triangles[triangle]);
    else if (team_.rank() == 0)
      list(triangle, s_.near, OctantShared::kMaxNear, s_.nearCount);
  }
  TETVDB_HD void list(u32 index, u32* all, u32 max, u32& count) {
    if (count < max)
      all[count++] = index;
    else
      s_.left = 1;
  }

  // Compare addFarSolidAngles().
  TETVDB_HD void addFar(const FillTriangle& t) {
    const SeenTriangle seen = seenFrom(centre_, t);
    const double scale = 1 / radius_;
    const FloatTriangle triangle(seen, static_cast<float>(static_cast<double>(t.weight)), scale);
    for (u32 j = static_cast<u32>(team_.rank()); j < kExpansionPoints;
         j += static_cast<u32>(team_.size())) {
      const Vec3d& p = holes_.points[j];
      s_.far[j] +=
          static_cast<double>(triangle.angle(static_cast<float>((seen.a[0] - p[0]) * scale),
                                             static_cast<float>((seen.a[1] - p[1]) * scale),
                                             static_cast<float>((seen.a[2] - p[2]) * scale)));
    }
  }

  // The clusters' tree, the first child before the second: visit() returns whether to look at the
  // parts.
  template <typename Visit, typename Triangle>
  TETVDB_HD void descend(u32 index, const Visit& visit, const Triangle& triangle) {
    u32 waiting[40]; // at most one a level: 2^32 triangles are halved 30 times
    int count = 0;
    waiting[count++] = index;
    while (count > 0) {
      const u32 i = waiting[--count];
      const TriangleClusters::Cluster& cluster = holes_.clusters[i];
      if (!visit(cluster, i))
        continue;
      if (cluster.second != 0) {
        waiting[count++] = cluster.second;
        waiting[count++] = i + 1;
        continue;
      }
      for (u32 t = cluster.begin; t != cluster.end; ++t)
        triangle(t);
    }
  }

  TETVDB_HD void sortCluster(u32 index) {
    descend(
        index,
        [&](const TriangleClusters::Cluster& cluster, u32 i) {
          const winding::Sorted sorted =
              winding::sortedCluster(cluster, centre_, radius_, holes_.tolerance);
          if (sorted == winding::Sorted::Far) {
            const Vec3d centre = from(centre_, cluster.centre);
            for (u32 j = static_cast<u32>(team_.rank()); j < kExpansionPoints;
                 j += static_cast<u32>(team_.size()))
              s_.far[j] += cluster.moments.angle(minus(centre, holes_.points[j]));
          } else if (sorted == winding::Sorted::Whole && team_.rank() == 0) {
            list(i, s_.whole, OctantShared::kMaxWhole, s_.wholeCount);
          }
          return sorted == winding::Sorted::Parts;
        },
        [&](u32 t) { take(t, isFar(t)); });
  }

  // Adds f of the near triangles to `sum`, in their order, until it reaches `max`.
  template <typename F>
  TETVDB_HD void forNear(const F& f, double& sum, double max) {
    for (u32 first = 0; first < s_.nearCount && sum < max; first += 64) {
      const u32 count = s_.nearCount - first < 64 ? s_.nearCount - first : 64;
      for (u32 k = static_cast<u32>(team_.rank()); k < count; k += static_cast<u32>(team_.size()))
        s_.number[k] = f(holes_.triangles[s_.near[first + k]], s_.near[first + k]);
      team_.sync();
      for (u32 k = 0; k < count && sum < max; ++k)
        sum += s_.number[k];
      team_.sync();
    }
  }

  // Of one triangle seen from the centre's surroundings.
  TETVDB_HD double angleAt(const FillTriangle& t, const Vec3d& at) {
    const SeenTriangle seen = seenFrom(centre_, t);
    const double angle =
        weightedAngle(seen.a[0] - at[0], seen.a[1] - at[1], seen.a[2] - at[2], seen.b[0] - at[0],
                      seen.b[1] - at[1], seen.b[2] - at[2], seen.c[0] - at[0], seen.c[1] - at[1],
                      seen.c[2] - at[2], t.weight);
    if (angle != angle)
      s_.left = 1;
    return angle;
  }

  TETVDB_HD void addWhole(const Vec3d& at, double& sum) {
    for (u32 k = 0; k < s_.wholeCount; ++k)
      descend(
          s_.whole[k],
          [&](const TriangleClusters::Cluster& cluster, u32) {
            const bool whole = winding::byMoments(cluster, centre_, radius_, holes_.tolerance);
            if (whole)
              sum += cluster.moments.angle(minus(from(centre_, cluster.centre), at));
            return !whole;
          },
          [&](u32 t) { sum += angleAt(holes_.triangles[t], at); });
  }

  const Team& team_;
  const PlacedHoles& holes_;
  const WindingLeaf& leaf_;
  OctantShared& s_;
  double radius_;
  LatticePoint centre_{};
};

template <typename Backend>
class WindingLeaves {
public:
  WindingLeaves(Backend& backend, const HolesView& view, const KeySpace& space)
      : b_(backend), view_(view), space_(space) {}

  /// The values in the leaves of a share; valid as long as the backend's temporaries.
  WindingValues run(const RootShare& share) {
    b_.require(view_.leafCount * (sizeof(WindingLeaf) + sizeof(Expansion) + 512 * sizeof(double)));
    place();
    values_.octants = b_.template temp<u32>(view_.leafCount);
    values_.values = b_.template temp<double>(512 * view_.leafCount);
    b_.zero(values_.octants, view_.leafCount * sizeof(u32));
    left_ = b_.template temp<u32>(8 * view_.leafCount);
    leftCount_ = b_.template temp<u32>(1);
    b_.zero(leftCount_, sizeof(u32));
    evaluate(share);
    takeLeft();
    return values_;
  }
  const WindingLeaf* leaves() const { return holes_.leaves; }

  // Public for nvcc alone, as in LevelBuilder.

  void evaluate(const RootShare& share) {
    const PlacedHoles holes = holes_;
    const WindingValues values = values_;
    const KeySpace space = space_;
    u32 *left = left_, *leftCount = leftCount_;
    b_.template forTeams<OctantShared>(
        8 * view_.leafCount, 64, TETVDB_KERNEL(const Team& team, u64 item, OctantShared& s) {
          const u64 leaf = item / 8;
          if (!share.has(space, 0, placeOf(space, holes.leaves[leaf])))
            return;
          OctantOfLeaf octant(team, holes, leaf, item % 8, s);
          octant.sort();
          const bool needed = octant.mayPassHalf();
          team.sync();
          if (needed && s.left == 0)
            for (int v = team.rank(); v < 64; v += team.size())
              values.values[item * 64 + static_cast<u64>(v)] = octant.valueAt(v) / (4 * kPi);
          team.sync();
          if (team.rank() == 0) {
            if (s.left != 0)
              left[addTo(leftCount, u32(1))] = static_cast<u32>(item);
            else if (needed)
              orInto(values.octants + leaf, u32(1) << (item % 8));
          }
          team.sync();
        });
  }

  void scatter(const u32* places, const double* numbers, u64 count) {
    const WindingValues all = values_;
    b_.forEach(
        64 * count, TETVDB_KERNEL(u64 i) {
          const u32 item = places[i / 64];
          all.values[u64(item) * 64 + i % 64] = numbers[i];
          if (i % 64 == 0)
            orInto(all.octants + item / 8, u32(1) << (item % 8));
        });
  }

  /// Of a leaf.
  TETVDB_HD static Place placeOf(const KeySpace& space, const WindingLeaf& leaf) {
    return {static_cast<u64>((leaf.first[0] >> 3) - space.base[0]),
            static_cast<u64>((leaf.first[1] >> 3) - space.base[1]),
            static_cast<u64>((leaf.first[2] >> 3) - space.base[2])};
  }

private:
  template <typename T>
  const T* placed(const T* from, u64 count) {
    T* to = b_.template temp<T>(count);
    b_.upload(to, from, count * sizeof(T));
    return to;
  }

  void place() {
    holes_.triangles = placed(view_.triangles, view_.triangleCount);
    holes_.areas = placed(view_.areas, view_.triangleCount);
    holes_.clusters = placed(view_.clusters, view_.clusterCount);
    holes_.leaves = placed(view_.leaves, view_.leafCount);
    holes_.far = placed(view_.far, view_.leafCount);
    holes_.near = placed(view_.near, view_.nearCount);
    holes_.points = placed(view_.points, kExpansionPoints);
    holes_.tables = placed(view_.tables, 1);
    holes_.tolerance = view_.tolerance;
  }

  // The octants that are left, by the host.
  void takeLeft() {
    const u64 count = b_.read(leftCount_);
    if (count == 0)
      return;
    constexpr u64 kAtOnce = u64(1) << 16;
    std::vector<u32> octants(count);
    b_.download(octants.data(), left_, count);
    std::sort(octants.begin(), octants.end());
    std::vector<double> values(64 * std::min(count, kAtOnce));
    const auto needed = std::make_unique<bool[]>(std::min(count, kAtOnce));
    u32* places = b_.template temp<u32>(std::min(count, kAtOnce));
    double* numbers = b_.template temp<double>(values.size());
    for (u64 first = 0; first < count; first += kAtOnce) {
      const u64 some = std::min(kAtOnce, count - first);
      view_.evaluator->evaluate(octants.data() + first, some, needed.get(), values.data());
      u64 kept = 0;
      for (u64 i = 0; i < some; ++i)
        if (needed[i]) {
          std::copy_n(values.data() + 64 * i, 64, values.data() + 64 * kept);
          octants[kept++] = octants[first + i];
        }
      b_.upload(places, octants.data(), kept * sizeof(u32));
      b_.upload(numbers, values.data(), 64 * kept * sizeof(double));
      scatter(places, numbers, kept);
      b_.await();
    }
  }

  Backend& b_;
  const HolesView& view_;
  KeySpace space_;
  PlacedHoles holes_{};
  WindingValues values_;
  u32 *left_ = nullptr, *leftCount_ = nullptr;
};

} // namespace tetvdb::nano
