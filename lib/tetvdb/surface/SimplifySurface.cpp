// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SimplifySurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/surface/CollapseEdges.h"
#include "tetvdb/surface/CubeRegions.h"
#include "tetvdb/surface/MergeFlatFaces.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SimplifyState.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = SimplifyState::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRegionEdges = 20;        ///< side of a small region, in mean edge lengths
constexpr double kLargerRegions = 3;       ///< times that, of the regions that come after them
constexpr double kFlatShare = 0.1;         ///< of the tolerance, of mergeFlatFaces()
constexpr double kFlatShareOutward = 0.01; ///< the same, with fewer faces in the end
constexpr int kRounds = 3;               ///< in which intersections are excluded where they came up
constexpr std::size_t kSerial = 1 << 14; ///< vertices; smaller meshes are one region

// One pass: vertices by cubes of space, the cubes in parallel.
class Pass {
public:
  /// Cubes of this side, one of their corners at `corner` sides; infinity: one region.
  Pass(SimplifyState& surface, double side, double corner) : s_(surface) {
    CubeRegions cubes = divideByCubes(s_.points, s_.mesh.points.size(), side, corner);
    regionOf_ = std::move(cubes.regionOf);
    regions_.resize(cubes.count);
    for (std::uint32_t i = 0; i < regions_.size(); ++i)
      regions_[i].number = i;
    gather();
  }

  std::size_t regions() const { return regions_.size(); }

  /// Collapses the edges of every region; new intersections are excluded at every step (`guarded`)
  /// or looked for afterwards. They are rare, and where most edges collapse, excluding them takes
  /// longer than all else: regions in which some come up are collapsed once more from the start,
  /// and they are excluded where they came up, or everywhere if that leaves some.
  template <class Done>
  void run(std::size_t max, bool guarded, Progress& progress, const Done& done) {
    if (guarded) {
      collapseAll(everywhere(), max, progress, done);
    } else {
      const Before before(s_);
      const std::vector<CollapseRegion> regions = regions_;
      collapseAll(BoxTree(std::vector<Box>{}), max, progress, done);
      std::vector<std::vector<Box>> found(regions_.size()); // boxes of faces that intersect others
      std::vector<std::uint32_t> again(regions_.size());
      std::iota(again.begin(), again.end(), 0u);
      for (int round = 0; round <= kRounds; ++round) {
        again = addIntersections(again, found, progress);
        tbb::parallel_for(std::size_t(0), again.size(), [&](std::size_t i) {
          const std::uint32_t region = again[i];
          regions_[region] = regions[region];
          restore(region, before);
          collapseEdges(s_, regions_[region], regionOf_,
                        round < kRounds ? BoxTree(found[region]) : everywhere(), max, progress);
        });
      }
    }
    s_.features = std::move(mixedFeatures_);
    for (const CollapseRegion& region : regions_)
      s_.features.insert(s_.features.end(), region.features.begin(), region.features.end());
    std::sort(s_.features.begin(), s_.features.end());
  }

private:
  /// What a pass changes of the surface.
  struct Before {
    std::vector<std::uint32_t> triangles;
    std::vector<char> isGone, isTested;
    std::vector<Quadric> quadrics;
    std::vector<std::uint32_t> firstGone, nextGone;

    explicit Before(const SimplifyState& s)
        : triangles(s.mesh.triangles), isGone(s.isGone), isTested(s.isTested), quadrics(s.quadrics),
          firstGone(s.firstGone), nextGone(s.nextGone) {}
  };

  static BoxTree everywhere() {
    Box all;
    all.add(Vec3d{-kInfinity, -kInfinity, -kInfinity});
    all.add(Vec3d{kInfinity, kInfinity, kInfinity});
    return BoxTree(std::vector<Box>{all});
  }

  template <class Done>
  void collapseAll(const BoxTree& guarded, std::size_t max, Progress& progress, const Done& done) {
    tbb::parallel_for(std::size_t(0), regions_.size(), [&](std::size_t i) {
      collapseEdges(s_, regions_[i], regionOf_, guarded, max, progress);
      done();
    });
  }

  // Adds the boxes of faces within the `asked` regions that intersect others to those of their
  // region; returns the regions that have some. A region's own vertices stay within its cube, so
  // that faces of two regions do not meet: one of two faces that do has all corners in one region.
  std::vector<std::uint32_t> addIntersections(const std::vector<std::uint32_t>& asked,
                                              std::vector<std::vector<Box>>& boxes,
                                              Progress& progress) const {
    if (asked.empty())
      return {};
    std::vector<char> isAsked(regions_.size(), 0);
    for (const std::uint32_t region : asked)
      isAsked[region] = 1;
    std::vector<std::uint32_t> corners;
    std::vector<char> looked;
    for (std::uint32_t face = 0; face < s_.isGone.size(); ++face) {
      if (s_.isGone[face])
        continue;
      const std::uint32_t* v = &s_.mesh.triangles[3 * std::size_t(face)];
      corners.insert(corners.end(), v, v + 3);
      looked.push_back(isAsked[regionOf_[v[0]]] != 0 &&
                       isFaceWithin(regionOf_[v[0]], v, regionOf_));
    }
    std::vector<std::uint32_t> regions;
    for (const std::uint32_t i : facesThatMeetOthers(s_.mesh.points, corners, looked, progress)) {
      const std::uint32_t* v = &corners[3 * std::size_t(i)];
      Box box;
      for (std::size_t k = 0; k < 3; ++k)
        box.add(s_.mesh.points[v[k]]);
      boxes[regionOf_[v[0]]].push_back(box);
      regions.push_back(regionOf_[v[0]]);
    }
    std::sort(regions.begin(), regions.end());
    regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
    return regions;
  }

  // Faces with corners in other regions have not changed.
  void restore(std::uint32_t region, const Before& before) {
    for (const std::uint32_t face : regions_[region].faces) {
      const std::uint32_t* v = &before.triangles[3 * std::size_t(face)];
      if (!isFaceWithin(region, v, regionOf_))
        continue;
      for (std::size_t k = 0; k < 3; ++k) {
        s_.mesh.triangles[3 * std::size_t(face) + k] = v[k];
        s_.quadrics[v[k]] = before.quadrics[v[k]];
        s_.isTested[v[k]] = before.isTested[v[k]];
      }
      s_.isGone[face] = before.isGone[face];
      s_.firstGone[face] = before.firstGone[face];
      for (std::uint32_t p = before.firstGone[face]; p != kNone; p = before.nextGone[p])
        s_.nextGone[p] = before.nextGone[p];
    }
  }

  std::array<std::uint32_t, 3> regionsOf(std::size_t face) const {
    const std::uint32_t* v = &s_.mesh.triangles[3 * face];
    return {regionOf_[v[0]], regionOf_[v[1]], regionOf_[v[2]]};
  }

  // Sorts faces by the regions of their corners. Faces of more than one region do not change, and
  // may intersect faces of others.
  void gather() {
    std::vector<std::uint32_t> staying;
    for (std::uint32_t face = 0; face < s_.isGone.size(); ++face) {
      if (s_.isGone[face])
        continue;
      const auto [a, b, c] = regionsOf(face);
      regions_[a].faces.push_back(face);
      if (b != a)
        regions_[b].faces.push_back(face);
      if (c != a && c != b)
        regions_[c].faces.push_back(face);
      if (a != b || a != c)
        staying.push_back(face);
    }
    for (const VertexPair& edge : s_.features) {
      regions_[regionOf_[edge[0]]].features.push_back(edge);
      if (regionOf_[edge[0]] != regionOf_[edge[1]]) {
        regions_[regionOf_[edge[1]]].features.push_back(edge);
        mixedFeatures_.push_back(edge);
      }
    }
    std::vector<Box> boxes(staying.size());
    for (std::size_t i = 0; i < staying.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        boxes[i].add(s_.mesh.points[s_.mesh.triangles[3 * std::size_t(staying[i]) + k]]);
    const BoxTree tree(std::move(boxes));
    tbb::parallel_for(std::size_t(0), regions_.size(), [&](std::size_t i) {
      const auto region = static_cast<std::uint32_t>(i);
      Box box;
      for (const std::uint32_t face : regions_[i].faces)
        for (std::size_t k = 0; k < 3; ++k)
          if (const std::uint32_t v = s_.mesh.triangles[3 * std::size_t(face) + k];
              regionOf_[v] == region)
            box.add(s_.mesh.points[v]);
      tree.visit([&](const Box& other) { return other.meets(box); },
                 [&](std::uint32_t item) {
                   const auto [a, b, c] = regionsOf(staying[item]);
                   if (a != region && b != region && c != region)
                     regions_[i].others.push_back(staying[item]);
                   return false;
                 });
      std::sort(regions_[i].others.begin(), regions_[i].others.end());
    });
  }

  SimplifyState& s_;
  std::vector<std::uint32_t> regionOf_; ///< by vertex
  std::vector<CollapseRegion> regions_;
  std::vector<VertexPair> mixedFeatures_; ///< between regions
};

// First cubes, then cubes that contain the borders of the first ones, then larger cubes twice, then
// still larger ones, then the whole: regions are collapsed in parallel, and the fewer edges an
// intersection undoes the better. What is left for the whole, on one thread, is little.
// Each pass tries vertices that the ones before could not move, or whose faces have changed since.
// A number of faces needs a single pass, since only the whole determines which collapses are the
// cheapest.
void collapse(SimplifyState& surface, std::size_t maxFaces, Progress& progress) {
  std::vector<std::pair<double, double>> passes;
  if (maxFaces == 0 && surface.quadrics.size() > kSerial) {
    const double side = kRegionEdges * surface.meanEdge;
    const double large = kLargerRegions * side;
    passes = {
        {side, 0.0}, {side, 0.5}, {large, 0.25}, {large, 0.75}, {kLargerRegions * large, 0.5}};
  }
  passes.emplace_back(kInfinity, 0.0);
  const std::size_t live = surface.liveFaces();
  const std::size_t max = maxFaces == 0 ? live : live > maxFaces ? (live - maxFaces + 1) / 2 : 0;
  for (std::size_t i = 0; i < passes.size(); ++i) {
    Pass pass(surface, passes[i].first, passes[i].second);
    std::atomic<std::size_t> done{0};
    const bool fewCollapses = i > 0 && i + 1 == passes.size(); // those across borders of cubes
    pass.run(max, fewCollapses, progress, [&] {
      progress.update((static_cast<double>(i) +
                       static_cast<double>(++done) / static_cast<double>(pass.regions())) /
                      static_cast<double>(passes.size()));
    });
  }
}

// Leaves out removed faces and vertices that no face uses.
void compact(TriangleMesh& mesh, const std::vector<char>& isGone) {
  std::vector<std::uint32_t> number(mesh.points.size(), kNone), triangles;
  for (std::size_t face = 0; face < isGone.size(); ++face)
    if (!isGone[face])
      for (std::size_t k = 0; k < 3; ++k) {
        triangles.push_back(mesh.triangles[3 * face + k]);
        number[triangles.back()] = 0;
      }
  std::vector<Vec3d> points;
  for (std::size_t v = 0; v < number.size(); ++v)
    if (number[v] != kNone) {
      number[v] = static_cast<std::uint32_t>(points.size());
      points.push_back(mesh.points[v]);
    }
  for (std::uint32_t& v : triangles)
    v = number[v];
  mesh.points = std::move(points);
  mesh.triangles = std::move(triangles);
  mesh.faceCount = mesh.triangleCount();
}

TriangleMesh simplified(const TriangleMesh& mesh, const SimplifyOptions& options,
                        Progress& progress) {
  SimplifyState state(mesh, options);
  collapse(state, options.faces, progress);
  if (options.faces > 0 && !state.features.empty()) {
    state.features.clear();
    std::fill(state.isTested.begin(), state.isTested.end(), 0);
    collapse(state, options.faces, progress);
  }
  compact(state.mesh, state.isGone);
  return std::move(state.mesh);
}

} // namespace

void simplifySurface(TriangleMesh& mesh, const SimplifyOptions& options, Progress& progress) {
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance) ||
      (options.tolerance == 0 && options.faces == 0))
    throw Error(Status::Usage, "simplify", "needs a tolerance above zero or a number of faces");
  if (mesh.triangles.empty())
    return;
  SimplifyOptions rest = options;
  // Where most faces can go, those of flat regions go faster without tests of distances.
  if (options.faces == 0 && options.featureDegrees >= 180)
    rest.tolerance -=
        mergeFlatFaces(mesh, (options.outward ? kFlatShareOutward : kFlatShare) * options.tolerance,
                       options.outward, progress);
  mesh = simplified(mesh, rest, progress);
}

} // namespace tetvdb
