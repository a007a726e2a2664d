// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CloseComponents.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FacePatches.h"
#include "tetvdb/surface/PlaneHoles.h"
#include "tetvdb/surface/SampleBox.h"
#include "tetvdb/surface/WindingField.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = EdgeTable::kNone;
constexpr double kMaxLost = 0.01, kMaxGained = 0.1;                  // relative to a solid's volume
constexpr double kHalf = 0.5, kSureInside = 0.6, kSureOutside = 0.4; // winding numbers
constexpr double kMaxOthers = 0.25;        // absolute winding number of what stays open, at a hole
constexpr std::size_t kEnoughInside = 256; // samples
constexpr std::size_t kMinSamples = 512, kMaxSamples = 8192, kSamplesTogether = 256;
constexpr double kMaxWork = 2e8; // solid angles of boundary edges
// Minimum volume of a solid over its area to the power of 1.5; a ball has 0.094.
constexpr double kMinVolume = 1e-5;
// Holes that are not plane: filling them is quadratic.
constexpr std::size_t kMaxEdges = 1000;

// Components that annular holes join.
struct Solid {
  std::vector<std::uint32_t> faces;  ///< of the given mesh
  bool hasFlat = false;              ///< a plane hole
  std::size_t curvedEdges = 0;       ///< of other holes
  std::vector<std::uint32_t> points; ///< of the given mesh, ascending
  TriangleMesh mesh;                 ///< of these points, then new ones; the faces, then new ones
  std::vector<FilledHole> holes;
  bool isClosed = false; ///< the holes may be closed

  std::size_t cornerCount() const { return 3 * faces.size(); } ///< without those of new faces
};

bool isFlat(const TriangleMesh& mesh) {
  double volume = 0, area = 0;
  const Vec3d& origin = mesh.points[mesh.triangles[0]];
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d a = minus(mesh.points[mesh.triangles[i]], origin);
    const Vec3d b = minus(mesh.points[mesh.triangles[i + 1]], origin);
    const Vec3d c = minus(mesh.points[mesh.triangles[i + 2]], origin);
    volume += dot(a, cross(b, c)) / 6;
    area += length(cross(minus(b, a), minus(c, a))) / 2;
  }
  return !(volume > kMinVolume * std::pow(area, 1.5));
}

// Of points and all triangles from a corner to a corner.
TriangleMesh partOf(const TriangleMesh& mesh, std::size_t from, std::size_t to) {
  TriangleMesh part;
  part.points = mesh.points;
  part.triangles.assign(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(from),
                        mesh.triangles.begin() + static_cast<std::ptrdiff_t>(to));
  part.faceCount = part.triangleCount();
  return part;
}

// Whether the winding numbers of a solid by itself enclose about the same with the new faces.
bool staysTheSame(const Solid& solid, std::size_t solids, Progress& progress) {
  if (isFlat(solid.mesh))
    return false;
  const TriangleMesh given = partOf(solid.mesh, 0, solid.cornerCount());
  const TriangleMesh added = partOf(solid.mesh, solid.cornerCount(), solid.mesh.triangles.size());
  const WindingField ofOpen(given), ofAdded(added);
  Box box;
  for (const Vec3d& p : solid.mesh.points)
    box.add(p);
  const double angles = double(ofOpen.anglesPerPoint() + ofAdded.anglesPerPoint());
  const auto samples = static_cast<std::size_t>(
      std::clamp(kMaxWork / (angles * double(solids)), double(kMinSamples), double(kMaxSamples)));
  struct Sample {
    double open, closed;
  };
  std::array<Sample, kSamplesTogether> found{};
  std::size_t before = 0, after = 0, lost = 0, gained = 0;
  for (std::size_t begin = 0; begin < samples && after < kEnoughInside; begin += found.size()) {
    const std::size_t count = std::min(found.size(), samples - begin);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 16), [&](const auto& range) {
      progress.check();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Vec3d p = pointInBox(box, begin + i);
        found[i].open = ofOpen.at(p);
        found[i].closed = found[i].open + ofAdded.at(p);
      }
    });
    for (std::size_t i = 0; i < count && after < kEnoughInside; ++i) {
      const auto [open, closed] = found[i];
      before += open > kHalf;
      after += closed > kHalf;
      lost += open > kSureInside && closed <= kHalf;
      gained += open < kSureOutside && closed > kHalf;
    }
  }
  return after > 0 && double(lost) <= kMaxLost * double(before) &&
         double(gained) <= kMaxGained * double(before);
}

// A point on each hole: the midpoint of its largest face.
std::vector<Vec3d> pointsOnHoles(const Solid& solid) {
  std::vector<Vec3d> points;
  const std::uint32_t* c = solid.mesh.triangles.data() + solid.cornerCount();
  for (const FilledHole& hole : solid.holes) {
    double largest = -1;
    points.emplace_back();
    for (std::size_t k = 0; k < hole.faces; ++k, c += 3) {
      const Vec3d &p = solid.mesh.points[c[0]], &q = solid.mesh.points[c[1]],
                  &r = solid.mesh.points[c[2]];
      const double area = length(cross(minus(q, p), minus(r, p)));
      if (area <= largest)
        continue;
      largest = area;
      points.back() = times(plus(plus(p, q), r), 1.0 / 3);
    }
  }
  return points;
}

class Closing {
public:
  Closing(const TriangleMesh& mesh, Progress& progress) : mesh_(mesh), progress_(progress) {}

  const std::vector<Solid>& run() {
    findSolids();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, solids_.size(), 1),
                      [&](const auto& range) {
                        for (std::size_t i = range.begin(); i != range.end(); ++i) {
                          progress_.check();
                          close(solids_[i]);
                        }
                      });
    while (leaveWhereOthersMeet() || leaveWhatOthersNeed())
      progress_.check();
    return solids_;
  }

private:
  // Those with a hole that may be closed, in the order of their first holes.
  void findSolids() {
    const EdgeTable edges(mesh_);
    const PlaneHoles holes(mesh_, edges);
    const auto isFlat = [&](const auto& group) { return holes.isFlat(group); };
    if (holes.groups().empty())
      return;
    const FacePatches patches = findPatches(mesh_.triangleCount(), edges, progress_);
    isSingle_ = patches.partCount == 1;
    if (isSingle_ && std::none_of(holes.groups().begin(), holes.groups().end(), isFlat))
      return;
    DisjointSets sets(patches.partCount);
    const auto setOf = [&](std::uint32_t face) {
      const std::uint32_t patch = patches.patchOf[face]; // kNone: a face with a repeated point
      return patch == kNone ? kNone : sets.find(patches.partOf[patch]);
    };
    const auto setOfLoop = [&](std::size_t loop) {
      return setOf(EdgeTable::faceOf(holes.loops()[loop].sides[0]));
    };
    for (const std::vector<std::size_t>& group : holes.groups())
      for (const std::size_t loop : group)
        sets.join(setOfLoop(group[0]), setOfLoop(loop));
    std::vector<std::uint32_t> number(patches.partCount, kNone);
    for (const std::vector<std::size_t>& group : holes.groups()) {
      std::uint32_t& solid = number[setOfLoop(group[0])];
      if (solid == kNone) {
        solid = static_cast<std::uint32_t>(solids_.size());
        solids_.emplace_back();
      }
      if (isFlat(group))
        solids_[solid].hasFlat = true;
      else
        solids_[solid].curvedEdges += holes.edgesOf(group);
    }
    for (std::uint32_t face = 0; face < mesh_.triangleCount(); ++face)
      if (const std::uint32_t set = setOf(face); set != kNone && number[set] != kNone)
        solids_[number[set]].faces.push_back(face);
  }

  void close(Solid& solid) const {
    const bool planeOnly = isSingle_ || solid.curvedEdges > kMaxEdges;
    if (planeOnly && !solid.hasFlat)
      return;
    CopiedFaces copied = copyFaces(mesh_, solid.faces);
    solid.points = std::move(copied.points);
    const auto isSolidWith = [&](HolePatches patches) {
      solid.mesh = copied.mesh;
      solid.holes = (planeOnly ? fillPlaneHoles(solid.mesh, progress_)
                               : fillHoles(solid.mesh, progress_, patches))
                        .holes;
      return !solid.holes.empty() && staysTheSame(solid, solids_.size(), progress_);
    };
    // Plain patches tell sheets from solids; fair ones take long.
    solid.isClosed =
        isSolidWith(HolePatches::Plain) &&
        (planeOnly || isSolidWith(HolePatches::Smooth) || isSolidWith(HolePatches::Taut));
  }

  std::vector<Solid*> closedSolids() {
    std::vector<Solid*> closed;
    for (Solid& solid : solids_)
      if (solid.isClosed)
        closed.push_back(&solid);
    return closed;
  }

  // The given faces of all solids that are closed, or that are not.
  TriangleMesh facesOf(bool closed) const {
    TriangleMesh mesh;
    mesh.points = mesh_.points;
    for (const Solid& solid : solids_)
      if (solid.isClosed == closed)
        for (const std::uint32_t face : solid.faces)
          mesh.triangles.insert(mesh.triangles.end(), &mesh_.triangles[3 * std::size_t(face)],
                                &mesh_.triangles[3 * std::size_t(face)] + 3);
    mesh.faceCount = mesh.triangleCount();
    return mesh;
  }

  // Leaves solids open at whose holes those that are open have a field. Returns whether any.
  bool leaveWhereOthersMeet() {
    const std::vector<Solid*> closed = closedSolids();
    const TriangleMesh open = facesOf(false);
    if (closed.empty() || open.triangles.empty())
      return false;
    const WindingField field(open);
    std::vector<char> leaves(closed.size(), 0);
    tbb::parallel_for(std::size_t(0), closed.size(), [&](std::size_t i) {
      progress_.check();
      const std::vector<Vec3d> points = pointsOnHoles(*closed[i]);
      leaves[i] = std::any_of(points.begin(), points.end(),
                              [&](const Vec3d& p) { return std::abs(field.at(p)) > kMaxOthers; });
    });
    for (std::size_t i = 0; i < closed.size(); ++i)
      closed[i]->isClosed = leaves[i] == 0;
    return std::find(leaves.begin(), leaves.end(), 1) != leaves.end();
  }

  // Leaves solids open where what is inside only together with open components would be lost.
  // Returns whether any.
  bool leaveWhatOthersNeed() {
    const std::vector<Solid*> closed = closedSolids();
    const TriangleMesh open = facesOf(false), given = facesOf(true);
    if (closed.empty() || open.triangles.empty())
      return false;
    TriangleMesh added;
    for (const Solid* solid : closed) {
      const auto first = static_cast<std::uint32_t>(added.points.size());
      added.points.insert(added.points.end(), solid->mesh.points.begin(), solid->mesh.points.end());
      for (std::size_t i = solid->cornerCount(); i < solid->mesh.triangles.size(); ++i)
        added.triangles.push_back(first + solid->mesh.triangles[i]);
    }
    added.faceCount = added.triangleCount();
    const WindingField ofOpen(open), ofGiven(given), ofAdded(added);
    const double angles =
        double(ofOpen.anglesPerPoint() + ofGiven.anglesPerPoint() + ofAdded.anglesPerPoint());
    const auto samples = static_cast<std::size_t>(
        std::clamp(kMaxWork / angles, double(kMinSamples), double(kMaxSamples)));
    const Box box = boxOf(mesh_.points, mesh_.triangles);
    enum Sample : std::uint8_t { Outside, Inside, Lost };
    std::vector<std::uint8_t> found(samples, Outside);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, 16), [&](const auto& range) {
      progress_.check();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Vec3d p = pointInBox(box, i);
        const double alone = ofGiven.at(p), others = ofOpen.at(p);
        if (alone + others > kHalf)
          found[i] = alone + others > kSureInside && alone <= kHalf &&
                             alone + others + ofAdded.at(p) <= kHalf
                         ? Lost
                         : Inside;
      }
    });
    const auto lost = std::count(found.begin(), found.end(), Lost);
    const auto inside = lost + std::count(found.begin(), found.end(), Inside);
    if (double(lost) <= kMaxLost * double(inside))
      return false;
    // At each point, the solid whose new faces lower the winding number most.
    std::vector<std::vector<double>> lowers(closed.size());
    tbb::parallel_for(std::size_t(0), closed.size(), [&](std::size_t i) {
      progress_.check();
      const Solid& solid = *closed[i];
      const TriangleMesh own = partOf(solid.mesh, solid.cornerCount(), solid.mesh.triangles.size());
      const WindingField field(own);
      for (std::size_t k = 0; k < samples; ++k)
        if (found[k] == Lost)
          lowers[i].push_back(field.at(pointInBox(box, k)));
    });
    for (std::size_t k = 0; k < lowers[0].size(); ++k) {
      const auto lowest = std::min_element(
          lowers.begin(), lowers.end(), [&](const auto& a, const auto& b) { return a[k] < b[k]; });
      closed[static_cast<std::size_t>(lowest - lowers.begin())]->isClosed = false;
    }
    return true;
  }

  const TriangleMesh& mesh_;
  Progress& progress_;
  std::vector<Solid> solids_;
  bool isSingle_ = false; ///< component
};

} // namespace

ClosedComponents closeComponents(TriangleMesh& mesh, Progress& progress) {
  ClosedComponents result;
  Closing closing(mesh, progress);
  for (const Solid& solid : closing.run()) {
    if (!solid.isClosed)
      continue;
    const std::size_t known = solid.points.size(), first = mesh.points.size();
    mesh.points.insert(mesh.points.end(),
                       solid.mesh.points.begin() + static_cast<std::ptrdiff_t>(known),
                       solid.mesh.points.end());
    for (std::size_t i = solid.cornerCount(); i < solid.mesh.triangles.size(); ++i) {
      const std::uint32_t corner = solid.mesh.triangles[i];
      mesh.triangles.push_back(corner < known ? solid.points[corner]
                                              : static_cast<std::uint32_t>(first + corner - known));
    }
    result.holes.insert(result.holes.end(), solid.holes.begin(), solid.holes.end());
    result.faces += solid.mesh.triangleCount() - solid.faces.size();
  }
  mesh.faceCount = mesh.triangleCount();
  return result;
}

} // namespace tetvdb
