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
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = SimplifyState::kNone;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRegionEdges = 64;      ///< side of a region, in mean edge lengths
constexpr double kFlatShare = 0.1;       ///< of the tolerance, of mergeFlatFaces()
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
  /// longer than all else: regions in which some come up are collapsed once more from the start.
  template <class Done>
  void run(std::size_t max, bool guarded, Progress& progress, const Done& done) {
    const Before before = guarded ? Before() : Before(s_);
    const std::vector<CollapseRegion> regions = guarded ? std::vector<CollapseRegion>() : regions_;
    tbb::parallel_for(std::size_t(0), regions_.size(), [&](std::size_t i) {
      collapseEdges(s_, regions_[i], regionOf_, guarded, max, progress);
      done();
    });
    if (!guarded) {
      const std::vector<std::uint32_t> again = regionsWithIntersections(progress);
      tbb::parallel_for(std::size_t(0), again.size(), [&](std::size_t i) {
        regions_[again[i]] = regions[again[i]];
        restore(again[i], before);
        collapseEdges(s_, regions_[again[i]], regionOf_, true, max, progress);
      });
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
    std::vector<char> isGone;
    std::vector<Quadric> quadrics;
    std::vector<std::uint32_t> firstGone, nextGone;

    Before() = default;
    explicit Before(const SimplifyState& s)
        : triangles(s.mesh.triangles), isGone(s.isGone), quadrics(s.quadrics),
          firstGone(s.firstGone), nextGone(s.nextGone) {}
  };

  // A region's own vertices stay within its cube, so that faces of two regions do not meet: one of
  // two faces that do has all corners in one region.
  std::vector<std::uint32_t> regionsWithIntersections(Progress& progress) const {
    std::vector<std::uint32_t> faces, corners, regions;
    for (std::uint32_t face = 0; face < s_.isGone.size(); ++face)
      if (!s_.isGone[face]) {
        faces.push_back(face);
        for (std::size_t k = 0; k < 3; ++k)
          corners.push_back(s_.mesh.triangles[3 * std::size_t(face) + k]);
      }
    for (const std::uint32_t i : facesThatMeetOthers(s_.mesh.points, corners, {}, progress)) {
      const std::uint32_t* v = &s_.mesh.triangles[3 * std::size_t(faces[i])];
      if (isFaceWithin(regionOf_[v[0]], v, regionOf_))
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

// First cubes, then cubes that contain the borders of the first ones, then the whole. A number of
// faces needs a single pass, since only the whole determines which collapses are the cheapest.
void collapse(SimplifyState& surface, std::size_t maxFaces, Progress& progress) {
  std::vector<std::pair<double, double>> passes;
  if (maxFaces == 0 && surface.quadrics.size() > kSerial) {
    const double side = kRegionEdges * surface.meanEdge;
    passes = {{side, 0.0}, {side, 0.5}};
  }
  passes.push_back({kInfinity, 0.0});
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
  if (options.faces == 0 && options.featureDegrees >= 180 && !options.outward)
    rest.tolerance -= mergeFlatFaces(mesh, kFlatShare * options.tolerance, progress);
  mesh = simplified(mesh, rest, progress);
}

} // namespace tetvdb
