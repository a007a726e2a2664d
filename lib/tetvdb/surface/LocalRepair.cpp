// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/LocalRepair.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CloseComponents.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/JoinPoints.h"
#include "tetvdb/surface/LatticeChain.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SeparatePoints.h"
#include "tetvdb/surface/SplitFans.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/surface/WeldBoundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numeric>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kMaxChange = 0.01;      // relative to the solid's volume
constexpr double kMaxClosing = 0.1;      // the same, where holes are filled or sheets removed
constexpr double kMinLeft = 0.5;         // the same, of all that is left then
constexpr double kNoChange = 0.001;      // limit above which the change is reported
constexpr double kMinSamples = 4;        // points that may differ in any case
constexpr int kMoreCuts = 4;             // of a mesh that is still broken after the first
constexpr std::size_t kMoreMetFaces = 4; // times as many meet where rounding does not help
constexpr double kCoarse = 1e-6;         // least size of the coarser lattice; of the box's diagonal
// Of more faces that meet, cutting again takes minutes, and models of parts placed through one
// another were not repaired by it.
constexpr std::size_t kMaxAligned = 5000;
// Longest edge that is contracted where faces meet; of the box's diagonal. A surface that is remade
// from voxels moves as far when it is simplified.
constexpr double kMaxContracted = 1e-4;
constexpr int kContractions = 8; // rounds
constexpr const char* kChangesVolume = "closing it would change its volume";

// Replaces points that are equal as floats by the first of them.
void joinEqualAsFloats(TriangleMesh& mesh, LocalRepair& repair) {
  const std::vector<std::uint32_t> equal = equalAsFloats(mesh.points);
  if (equal.empty())
    return;
  std::map<FloatPosition, std::uint32_t> first;
  std::vector<std::uint32_t> becomes(mesh.points.size());
  std::iota(becomes.begin(), becomes.end(), 0u);
  std::vector<std::uint32_t> ascending = equal;
  std::sort(ascending.begin(), ascending.end());
  for (const std::uint32_t point : ascending) {
    const Vec3d& p = mesh.points[point];
    becomes[point] = first.try_emplace(asFloats(p), point).first->second;
    if (becomes[point] == point)
      continue;
    ++repair.stitched.joinedPoints;
    repair.stitched.largestMove =
        std::max(repair.stitched.largestMove, length(minus(p, mesh.points[becomes[point]])));
  }
  joinPoints(mesh, becomes);
}

// Removes faces without area whose removal leaves fewer open edges. Those that close a gap between
// the edges of their neighbours stay.
void dropLooseFlatFaces(TriangleMesh& mesh) {
  std::vector<char> drops(mesh.triangleCount(), 0);
  {
    const EdgeTable edges(mesh);
    std::vector<int> excess(edges.edgeCount(), 0); // ascending minus descending sides
    const auto signOf = [&](std::uint32_t side) { return edges.ascends(side) ? 1 : -1; };
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
      excess[edge] = edges.imbalance(edge);
    for (std::uint32_t face = 0; face < drops.size(); ++face) {
      const std::uint32_t* c = &mesh.triangles[3 * std::size_t(face)];
      if (!edges.hasFace(face) ||
          !areCollinear(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]]))
        continue;
      const std::array<std::uint32_t, 3> sides{3 * face, 3 * face + 1, 3 * face + 2};
      int open = 0, openWithout = 0;
      for (const std::uint32_t side : sides) {
        open += std::abs(excess[edges.edgeOf(side)]);
        openWithout += std::abs(excess[edges.edgeOf(side)] - signOf(side));
      }
      if (openWithout >= open)
        continue;
      drops[face] = 1;
      for (const std::uint32_t side : sides)
        excess[edges.edgeOf(side)] -= signOf(side);
    }
  }
  if (dropFaces(mesh, drops) > 0)
    dropUnusedPoints(mesh);
}

// Removes one of two surfaces that nearly coincide.
void dropDoubles(TriangleMesh& mesh, LocalRepair& repair, Progress& progress) {
  BoundaryWeld weld;
  {
    const EdgeTable edges(mesh);
    weld = weldBoundary(mesh, edges, WeldCandidates::AllPoints, progress);
  }
  if (weld.becomes.empty())
    return;
  for (std::size_t point = 0; point < weld.becomes.size(); ++point)
    repair.stitched.joinedPoints += weld.becomes[point] != point;
  repair.stitched.largestMove = std::max(repair.stitched.largestMove, weld.distance);
  for (std::uint32_t& corner : mesh.triangles)
    corner = weld.becomes[corner];
  repair.doubleFaces = dropEqualFaces(mesh, true);
  dropUnusedPoints(mesh);
}

bool isBalanced(const TriangleMesh& mesh) {
  const EdgeTable edges(mesh);
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (edges.imbalance(edge) != 0)
      return false;
  return edges.edgeCount() > 0;
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// As whatIsBroken(), intersections aside.
std::string otherDefect(const TriangleMesh& mesh, Progress& progress, bool flatFacesAllowed) {
  DefectOptions options;
  options.windingSamples = 0;
  options.maxIntersections = 0;
  const SurfaceDefects defects = surfaceDefects(mesh, options, progress);
  if (defects.boundaryEdges > 0)
    return counted(defects.boundaryEdges, "boundary edge", "boundary edges");
  if (defects.nonManifoldEdges > 0)
    return counted(defects.nonManifoldEdges, "edge of three faces or more",
                   "edges of three faces or more");
  if (defects.misorientedEdges > 0)
    return counted(defects.misorientedEdges, "edge of two faces in the same direction",
                   "edges of two faces in the same direction");
  if (defects.nonManifoldVertices > 0)
    return counted(defects.nonManifoldVertices, "vertex of several fans",
                   "vertices of several fans");
  if (defects.duplicateFaces > 0)
    return counted(defects.duplicateFaces, "duplicate face", "duplicate faces");
  if (defects.degenerateFaces > 0 && !flatFacesAllowed)
    return counted(defects.degenerateFaces, "face without area", "faces without area");
  if (!(defects.volume > 0))
    return "no volume";
  if (const std::size_t equal = equalAsFloats(mesh.points).size(); equal > 0)
    return std::to_string(equal) + " vertices equal as 32-bit floats";
  return "";
}

// Separates edges of several faces and points of several fans; returns the remaining defect.
std::string partWhatTouches(TriangleMesh& mesh, LocalRepair& repair, Progress& progress) {
  const std::size_t points = mesh.points.size();
  splitFans(mesh, progress);
  const SeparatedPoints separated = separateEqualPoints(mesh, points, progress);
  repair.separatedPoints += separated.points;
  repair.largestMove =
      std::max({repair.largestMove, repair.stitched.largestMove, separated.largestMove});
  return whatIsBroken(mesh, progress, true);
}

// A mesh whose faces were cut along one another, and what made it from the closed one.
struct CutMesh {
  TriangleMesh mesh;
  LocalRepair repair;
  NewCorners corners;
  bool joins; // points that are equal as floats are merged
  std::string broken = "too many intersecting faces to cut"; // the remaining defect
};

void finishCut(CutMesh& cut, Progress& progress) {
  if (cut.joins)
    joinEqualAsFloats(cut.mesh, cut.repair);
  cut.broken = isBalanced(cut.mesh) ? partWhatTouches(cut.mesh, cut.repair, progress)
                                    : "open edges where faces were cut";
}

// Three of each face that meets another.
std::vector<std::uint32_t> cornersOfMetFaces(const TriangleMesh& mesh, Progress& progress) {
  TriangleMesh clean = mesh; // as facesThatMeetOthers() requires it
  std::vector<char> flat(clean.triangleCount(), 0);
  for (std::size_t face = 0; face < flat.size(); ++face) {
    const std::uint32_t* c = &clean.triangles[3 * face];
    flat[face] = areCollinear(clean.points[c[0]], clean.points[c[1]], clean.points[c[2]]);
  }
  dropFaces(clean, flat);
  dropEqualFaces(clean, true);
  std::vector<std::uint32_t> corners;
  for (const std::uint32_t face : facesThatMeetOthers(clean.points, clean.triangles, {}, progress))
    for (std::size_t k = 0; k < 3; ++k)
      corners.push_back(clean.triangles[3 * std::size_t(face) + k]);
  return corners;
}

// Moves the corners of faces that meet others.
template <typename Move>
void moveWhereFacesMeet(CutMesh& cut, const Move& moved, Progress& progress) {
  std::vector<char> moves(cut.mesh.points.size(), 0);
  for (const std::uint32_t corner : cornersOfMetFaces(cut.mesh, progress))
    moves[corner] = 1;
  for (std::size_t point = 0; point < moves.size(); ++point) {
    if (moves[point] == 0)
      continue;
    Vec3d& p = cut.mesh.points[point];
    const Vec3d to = moved(p);
    cut.repair.alignedPoints += to != p;
    cut.repair.largestMove = std::max(cut.repair.largestMove, length(minus(to, p)));
    p = to;
  }
}

// Where faces meet by less than the unit of the lattice that they are cut on, they may not meet
// there.
void moveToLattice(CutMesh& cut, Progress& progress) {
  const LatticeChain chain = latticeChain(cut.mesh);
  moveWhereFacesMeet(
      cut, [&](const Vec3d& p) { return chain.toWorld(chain.toLattice(p)); }, progress);
  cut.broken = whatIsBroken(cut.mesh, progress, true);
}

// Merging and separating points may create new intersections in fine details.
void cutAgain(CutMesh& cut, int times, Progress& progress) {
  for (int k = 0; k < times && !cut.broken.empty() && isBalanced(cut.mesh); ++k) {
    const auto before = std::make_pair(cut.broken, cut.mesh.triangleCount());
    const CrossingCounts more = removeCrossings(cut.mesh, cut.corners, progress);
    if (!more.complete)
      return;
    if (more.cutFaces + more.removedFaces == 0) {
      moveToLattice(cut, progress);
      return;
    }
    CrossingCounts& all = cut.repair.crossings;
    all.metFaces += more.metFaces;
    all.cutFaces += more.cutFaces;
    all.removedFaces += more.removedFaces;
    all.addedFaces += more.addedFaces;
    all.rounds += more.rounds;
    finishCut(cut, progress);
    if (std::make_pair(cut.broken, cut.mesh.triangleCount()) == before)
      return; // the next attempt would be identical
  }
}

// Cuts a closed mesh with each of these corners, and points that are equal as floats merged or not;
// if all leave a defect, cuts what they gave up to `moreCuts` times again. Gives up where more
// faces meet than `maxMetFaces`. Returns the first without defect, else one where faces meet and
// nothing else is wrong, else the last.
CutMesh cutWith(const CutMesh& uncut, const std::vector<NewCorners>& corners,
                std::size_t maxMetFaces, int moreCuts, Progress& progress) {
  std::vector<CutMesh> cuts;
  for (const NewCorners one : corners) {
    CutMesh cut = uncut;
    cut.corners = one;
    cut.repair.crossings = removeCrossings(cut.mesh, one, progress);
    cuts.push_back(cut);
    if (cut.repair.crossings.metFaces > maxMetFaces)
      return cut;
    if (!cut.repair.crossings.complete)
      continue;
    finishCut(cuts.back(), progress);
    if (cuts.back().broken.empty())
      return cuts.back();
    if (equalAsFloats(cut.mesh.points).empty())
      continue; // the attempt would be identical
    cut.joins = false;
    finishCut(cut, progress);
    cuts.push_back(cut);
    if (cut.broken.empty())
      return cut;
  }
  for (CutMesh& cut : cuts) {
    cutAgain(cut, moreCuts, progress);
    if (cut.broken.empty())
      return cut;
  }
  const auto meets = std::find_if(cuts.begin(), cuts.end(), [&](const CutMesh& cut) {
    return cut.repair.crossings.complete && isBalanced(cut.mesh) &&
           otherDefect(cut.mesh, progress, true).empty();
  });
  return meets != cuts.end() ? *meets : cuts.back();
}

CutMesh roundedToFloats(CutMesh cut) {
  cut.repair.roundsToFloats = true;
  for (Vec3d& p : cut.mesh.points) {
    const Vec3d to = nearestFloats(p);
    cut.repair.largestMove = std::max(cut.repair.largestMove, length(minus(to, p)));
    p = to;
  }
  joinEqualAsFloats(cut.mesh, cut.repair);
  return cut;
}

double diagonalOf(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  return length(minus(box.high, box.low));
}

// The points of faces that meet others on a lattice whose size is a power of two.
CutMesh alignedWhereFacesMeet(CutMesh cut, Progress& progress) {
  const double size = std::exp2(std::ceil(std::log2(kCoarse * diagonalOf(cut.mesh))));
  const auto moved = [&](const Vec3d& p) {
    Vec3d to = p;
    for (double& x : to)
      x = std::round(x / size) * size;
    return to;
  };
  moveWhereFacesMeet(cut, moved, progress);
  joinEqualAsFloats(cut.mesh, cut.repair);
  dropLooseFlatFaces(cut.mesh);
  stitchBoundaries(cut.mesh, progress);
  return cut;
}

// Contracts short edges of the faces that still meet others after cutting: some of their details
// are finer than rounding and separating points moves them.
void contractWhereFacesMeet(CutMesh& cut, Progress& progress) {
  const double longest = kMaxContracted * diagonalOf(cut.mesh);
  for (int round = 0; round < kContractions && !cut.broken.empty() && isBalanced(cut.mesh) &&
                      otherDefect(cut.mesh, progress, true).empty();
       ++round) {
    const ContractedEdges contracted =
        contractShortEdges(cut.mesh, cornersOfMetFaces(cut.mesh, progress), longest);
    if (contracted.edges == 0)
      return;
    cut.repair.stitched.joinedPoints += contracted.edges;
    cut.repair.stitched.largestMove = std::max(cut.repair.stitched.largestMove, contracted.longest);
    finishCut(cut, progress);
  }
}

// Cuts the closed mesh as given or, if that fails, rounded to floats or aligned where faces meet;
// as the last attempt contracts edges there. Returns the remaining defect.
std::string cutCrossings(TriangleMesh& mesh, LocalRepair& repair, Progress& progress) {
  const CutMesh uncut{mesh, repair, NewCorners::Doubles, true};
  const std::vector<NewCorners> both{NewCorners::FloatsAsGiven, NewCorners::Doubles};
  const bool floats = areFloats(mesh.points);
  CutMesh cut = cutWith(uncut, floats ? both : std::vector<NewCorners>{NewCorners::Doubles},
                        mesh.triangleCount(), kMoreCuts, progress);
  if (!cut.broken.empty() && !floats) {
    const std::size_t mostMet = kMoreMetFaces * cut.repair.crossings.metFaces;
    CutMesh rounded = cutWith(roundedToFloats(uncut), both, mostMet, kMoreCuts, progress);
    if (rounded.broken.empty())
      cut = std::move(rounded);
  }
  const std::size_t metFaces = cut.repair.crossings.metFaces;
  if (!cut.broken.empty() && metFaces <= kMaxAligned) {
    const CutMesh aligned = alignedWhereFacesMeet(uncut, progress);
    CutMesh again = cutWith(aligned, both, kMoreMetFaces * metFaces, 0, progress);
    if (again.broken.empty())
      cut = std::move(again);
  }
  contractWhereFacesMeet(cut, progress);
  repair = cut.repair;
  if (cut.broken.empty())
    mesh = std::move(cut.mesh);
  return cut.broken;
}

// Whether the repaired mesh has the solid of `before`, up to how holes are closed. Sets the result
// of the comparison; returns what is wrong.
std::string compareWith(const TriangleMesh& before, const TriangleMesh& filled,
                        const TriangleMesh& after, LocalRepair& repair, Progress& progress) {
  const SolidComparison& solids = repair.solids = compareSolids(before, after, progress);
  const double each = solids.after / double(std::max<std::size_t>(1, solids.inside));
  const double changed = std::max(solids.lost, solids.gained);
  const double most = std::max(kMaxChange * solids.before, kMinSamples * each);
  repair.changesVolume = changed > std::max(kNoChange * solids.before, kMinSamples * each);
  repair.closingChangesVolume = false;
  if (changed <= most)
    return "";
  // The winding number closes holes in one of many ways, and filling them in another. Sheets change
  // it on both of their sides.
  const SolidComparison cut = compareSolids(filled, after, progress);
  const double mostOfAll = kMaxClosing * solids.before;
  repair.closingChangesVolume = solids.lost <= (repair.sheets.parts > 0 ? mostOfAll : most) &&
                                solids.gained <= (repair.holes.empty() ? most : mostOfAll) &&
                                solids.after >= kMinLeft * solids.before &&
                                std::max(cut.lost, cut.gained) <= most;
  return repair.closingChangesVolume ? "" : kChangesVolume;
}

// What a repaired mesh is compared with.
struct SolidsToKeep {
  const TriangleMesh& given;
  const TriangleMesh& solid; ///< its components that bound one are closed
};

struct Closing {
  TriangleMesh mesh;
  LocalRepair repair;
};

// Fills the holes of an open mesh, cuts what crosses, separates what touches.
Closing closeAndCut(const TriangleMesh& open, const LocalRepair& before, HolePatches patches,
                    const SolidsToKeep& kept, Progress& progress) {
  Closing closing{open, before};
  TriangleMesh& mesh = closing.mesh;
  LocalRepair& repair = closing.repair;
  if (!isBalanced(mesh)) {
    const std::vector<FilledHole> filled = fillHoles(mesh, progress, patches).holes;
    repair.holes.insert(repair.holes.end(), filled.begin(), filled.end());
    if (!isBalanced(mesh)) {
      repair.why = "boundary edges that cannot be closed";
      return closing;
    }
  }
  const TriangleMesh filled = mesh;
  LocalRepair parted = repair;
  if (partWhatTouches(mesh, parted, progress).empty()) {
    repair = parted;
  } else {
    mesh = filled;
    repair.why = cutCrossings(mesh, repair, progress);
    if (!repair.why.empty())
      return closing;
  }
  repair.why = compareWith(kept.solid, filled, mesh, repair, progress);
  // Closed by itself, a component may have another solid than as a part of the mesh.
  if (!repair.why.empty() && compareWith(kept.given, filled, mesh, repair, progress).empty())
    repair.why.clear();
  repair.succeeded = repair.why.empty();
  return closing;
}

} // namespace

std::string whatIsBroken(const TriangleMesh& mesh, Progress& progress, bool flatFacesAllowed) {
  if (std::string other = otherDefect(mesh, progress, flatFacesAllowed); !other.empty())
    return other;
  DefectOptions options;
  options.windingSamples = 0;
  options.maxIntersections = 100000;
  if (const SurfaceDefects met = surfaceDefects(mesh, options, progress); met.selfIntersections > 0)
    return counted(met.selfIntersections, "pair of faces that cross", "pairs of faces that cross");
  return "";
}

LocalRepair repairLocally(TriangleMesh& mesh, Progress& progress) {
  LocalRepair repair;
  TriangleMesh work = mesh;
  const auto failed = [&](const std::string& why) {
    repair.why = why;
    return repair;
  };
  dropDoubles(work, repair, progress);
  joinEqualAsFloats(work, repair);
  dropLooseFlatFaces(work);
  const StitchCounts stitched = stitchBoundaries(work, progress);
  repair.stitched.joinedPoints += stitched.joinedPoints;
  repair.stitched.largestMove = std::max(repair.stitched.largestMove, stitched.largestMove);
  repair.stitched.splitFaces = stitched.splitFaces;
  repair.stitched.flippedFaces = stitched.flippedFaces;
  TriangleMesh solid = mesh; // by winding number
  if (!isBalanced(work)) {
    closeComponents(solid, progress);
    repair.holes = closeComponents(work, progress).holes;
    repair.sheets = dropSheets(work, progress);
    if (!repair.sheets.complete)
      return failed("too many open components");
    if (work.triangles.empty())
      return failed("only sheets");
  }
  const SolidsToKeep kept{mesh, solid};
  Closing closing = closeAndCut(work, repair, HolePatches::Smooth, kept, progress);
  // A smooth patch over a large hole may bulge far out.
  const bool bulges = closing.repair.closingChangesVolume || closing.repair.why == kChangesVolume;
  const std::vector<FilledHole>& holes = closing.repair.holes;
  if (bulges && std::any_of(holes.begin(), holes.end(),
                            [](const FilledHole& hole) { return hole.points > 0; })) {
    Closing taut = closeAndCut(work, repair, HolePatches::Taut, kept, progress);
    if (taut.repair.succeeded && !(closing.repair.succeeded && taut.repair.closingChangesVolume))
      closing = std::move(taut);
  }
  if (closing.repair.succeeded)
    mesh = std::move(closing.mesh);
  return closing.repair;
}

} // namespace tetvdb
