// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FillHoles.h"

#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FairPatch.h"
#include "tetvdb/surface/PlaneHoles.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/TriangulateLoop.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace tetvdb {
namespace {

// Curved holes of fewer edges are filled without new points.
constexpr std::size_t kFewestFairEdges = 7;

class Filling {
public:
  Filling(TriangleMesh& mesh, HolePatches patches, Progress& progress)
      : mesh_(mesh), patches_(patches), progress_(progress), edges_(mesh), holes_(mesh, edges_) {}

  HoleFilling run(bool planeOnly) {
    HoleFilling filling;
    std::vector<std::uint32_t> added;
    for (const std::vector<std::size_t>& group : holes_.groups()) {
      progress_.check();
      if (fillInPlane(group, added, filling) || planeOnly)
        continue;
      for (const std::size_t loop : group)
        fillInSpace(loop, added, filling);
    }
    takeBackCrossing(added, filling);
    mesh_.triangles.insert(mesh_.triangles.end(), added.begin(), added.end());
    mesh_.faceCount = mesh_.triangleCount();
    if (dropsPoints_)
      dropUnusedPoints(mesh_);
    return filling;
  }

private:
  bool isTaken(std::uint32_t a, std::uint32_t b) const { return holes_.isTaken(a, b); }

  bool fillInPlane(const std::vector<std::size_t>& group, std::vector<std::uint32_t>& added,
                   HoleFilling& filling) {
    FilledHole hole;
    hole.edges = holes_.edgesOf(group);
    const std::size_t first = added.size();
    if (!holes_.triangulate(group, added))
      return false;
    finish(hole, added, first, filling);
    return true;
  }

  void fillInSpace(std::size_t index, std::vector<std::uint32_t>& added, HoleFilling& filling) {
    const BoundaryLoop& loop = holes_.loops()[index];
    SpaceLoop space;
    space.points = loop.points;
    for (const std::uint32_t side : loop.sides)
      space.beyond.push_back(edges_.opposite(side));
    FilledHole hole;
    hole.edges = loop.points.size();
    const std::size_t first = added.size();
    if (!triangulateLoop(
            mesh_.points, space, [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); },
            added, progress_))
      triangulateLoop(
          mesh_.points, space, [](std::uint32_t, std::uint32_t) { return false; }, added,
          progress_);
    if (patches_ != HolePatches::Plain && loop.points.size() >= kFewestFairEdges)
      fair(loop, added, first, hole, filling.holes.size());
    finish(hole, added, first, filling);
  }

  // Refines and fairs the faces from `first` on, over a loop.
  void fair(const BoundaryLoop& loop, std::vector<std::uint32_t>& added, std::size_t first,
            FilledHole& hole, std::size_t number) {
    HolePatch patch;
    const auto begin = added.begin() + static_cast<std::ptrdiff_t>(first);
    for (auto c = begin; c != added.end(); c += 3)
      patch.faces.push_back({c[0], c[1], c[2]});
    findFacesAtLoops();
    std::vector<std::uint32_t> around;
    for (const std::uint32_t point : loop.points)
      around.insert(around.end(), facesAt_[point].begin(), facesAt_[point].end());
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    for (const std::uint32_t face : around)
      patch.around.push_back(cornersOf(mesh_.triangles, face));
    hole.points = fairPatch(
        mesh_.points, patch, patches_ == HolePatches::Smooth ? Fairness::Smooth : Fairness::Taut,
        [&](std::uint32_t a, std::uint32_t b) { return isTaken(a, b); }, progress_);
    if (hole.points == 0)
      return;
    fairHoles_.push_back({number, {begin, added.end()}});
    added.erase(begin, added.end());
    for (const HolePatch::Corners& c : patch.faces)
      added.insert(added.end(), c.begin(), c.end());
  }

  void findFacesAtLoops() {
    if (!facesAt_.empty())
      return;
    for (const BoundaryLoop& loop : holes_.loops())
      for (const std::uint32_t point : loop.points)
        facesAt_[point];
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
      if (const auto at = facesAt_.find(mesh_.triangles[i]); at != facesAt_.end())
        at->second.push_back(static_cast<std::uint32_t>(i / 3));
  }

  static HolePatch::Corners cornersOf(const std::vector<std::uint32_t>& corners, std::size_t face) {
    return {corners[3 * face], corners[3 * face + 1], corners[3 * face + 2]};
  }

  // Restores the plain patch where faired patches intersect other faces.
  void takeBackCrossing(std::vector<std::uint32_t>& added, HoleFilling& filling) {
    if (fairHoles_.empty())
      return;
    std::vector<char> looked;
    std::vector<std::uint32_t> corners, hole; // the latter by face, fairHoles_.size(): none
    const auto add = [&](const HolePatch::Corners& c, std::size_t number) {
      if (areCollinear(mesh_.points[c[0]], mesh_.points[c[1]], mesh_.points[c[2]]))
        return;
      corners.insert(corners.end(), c.begin(), c.end());
      hole.push_back(static_cast<std::uint32_t>(number));
      looked.push_back(number < fairHoles_.size());
    };
    for (std::size_t face = 0; face < mesh_.triangleCount(); ++face)
      add(cornersOf(mesh_.triangles, face), fairHoles_.size());
    for (std::size_t i = 0, face = 0, fair = 0; i < filling.holes.size(); ++i) {
      while (fair < fairHoles_.size() && fairHoles_[fair].number < i)
        ++fair;
      const bool isFair = fair < fairHoles_.size() && fairHoles_[fair].number == i;
      for (std::size_t k = 0; k < filling.holes[i].faces; ++k, ++face)
        add(cornersOf(added, face), isFair ? fair : fairHoles_.size());
    }
    std::vector<char> crosses(fairHoles_.size(), 0);
    for (const std::uint32_t face : facesThatMeetOthers(mesh_.points, corners, looked, progress_))
      crosses[hole[face]] = 1;
    for (std::size_t i = fairHoles_.size(); i-- > 0;) {
      if (crosses[i] == 0)
        continue;
      FilledHole& filled = filling.holes[fairHoles_[i].number];
      std::size_t before = 0;
      for (std::size_t k = 0; k < fairHoles_[i].number; ++k)
        before += filling.holes[k].faces;
      const std::vector<std::uint32_t>& plain = fairHoles_[i].plain;
      const auto begin = added.begin() + static_cast<std::ptrdiff_t>(3 * before);
      added.insert(added.erase(begin, begin + static_cast<std::ptrdiff_t>(3 * filled.faces)),
                   plain.begin(), plain.end());
      filled.faces = plain.size() / 3;
      filled.points = 0;
      dropsPoints_ = true;
    }
  }

  void finish(FilledHole& hole, const std::vector<std::uint32_t>& added, std::size_t first,
              HoleFilling& filling) {
    hole.faces = (added.size() - first) / 3;
    holes_.take(added, first);
    filling.holes.push_back(hole);
  }

  TriangleMesh& mesh_;
  const HolePatches patches_;
  Progress& progress_;
  const EdgeTable edges_;
  PlaneHoles holes_;
  struct FairHole {
    std::size_t number;               ///< of the filled hole
    std::vector<std::uint32_t> plain; ///< its faces before fairing
  };
  std::vector<FairHole> fairHoles_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> facesAt_; ///< points of loops
  bool dropsPoints_ = false;
};

} // namespace

HoleFilling fillHoles(TriangleMesh& mesh, Progress& progress, HolePatches patches) {
  return Filling(mesh, patches, progress).run(false);
}

HoleFilling fillPlaneHoles(TriangleMesh& mesh, Progress& progress) {
  return Filling(mesh, HolePatches::Plain, progress).run(true);
}

} // namespace tetvdb
