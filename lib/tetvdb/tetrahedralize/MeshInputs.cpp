// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/MeshInputs.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/Improve.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"
#include "tetvdb/tetrahedralize/insertion/InsertSurface.h"
#include "tetvdb/tetrahedralize/inside/Classify.h"
#include "tetvdb/tetrahedralize/inside/RefineHoles.h"
#include "tetvdb/tetrahedralize/inside/RegionChains.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"
#include "tetvdb/tetrahedralize/soup/Landmarks.h"
#include "tetvdb/tetrahedralize/soup/PerturbSoup.h"
#include "tetvdb/tetrahedralize/soup/SimplifySoup.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <utility>

namespace tetvdb {
namespace {

// Shares of epsilon. What simplification may use, so that improvement can still move points: at
// first, and in later variants.
constexpr double kSimplifyShare = 0.6, kCarefulShare = 0.3;
// How far later variants move points besides.
constexpr double kPerturbShare = 0.25;
// How far a triangle's faces may be from it where tets are too flat to be cut.
constexpr double kReachShare = 0.1;
// How far the surface may move where the mesh is coarsened before all of it is inserted.
constexpr double kThinShare = 0.5;

// What is inserted, in this order, until all faces of a variant are in.
enum Variant : int {
  kSimplified,
  kSimplifiedPerturbed,
  kCareful, // less simplified, so that sheets do not come to cross
  kCarefulComponents,
  kCarefulPerturbed,
  kCarefulPerturbedOtherwise,
  kVariants // their number
};

// Holes are closed along tets of this share of the target length, as long as no more than
// kMaxHoleTets are added.
constexpr double kHoleShare = 0.5;
constexpr std::size_t kMaxHoleTets = 25000;
// Where few points are lost, improvement is run again at most kMaxMends times, as long as half or
// less is lost. Points that are lost in spite of that were lost in simplification or at insertion:
// all is done again at most kMaxRepeats times, as long as less was lost each time.
constexpr int kMaxMends = 2, kMaxRepeats = 3;
// How near to lost points a face is whose corners are kept: parts are lost that are thinner than
// this, in envelope radii.
constexpr double kThinRadii = 3;
// Tets that are coarsened, at 5 us each, where work is limited: in all, and more for each triangle.
constexpr double kMaxCoarsened = 2e6, kMaxCoarsenedOfFace = 200;
// Sums over boundary edges that take as long as coarsening a tet: one for each point and edge.
constexpr double kSumsOfTet = 2500;
// Up to so many triangles the input is sampled for the check beside insertion: a twentieth of the
// time of small meshes. Of large ones it is less, and both together need a fifth more memory.
constexpr std::size_t kMaxBeside = 50000;
// Energies that are farther above the stop energy are reported.
constexpr double kEnergySlack = 1.001;

void assertValid([[maybe_unused]] const TetComplex& complex) {
#ifndef NDEBUG
  complex.verify();
#endif
}

Vec3d centreOf(const TetMesh& mesh, std::size_t tet) {
  Vec3d centre = {};
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      centre[axis] += mesh.points[mesh.tets[4 * tet + k]][axis] / 4;
  return centre;
}

// Of the tets that are kept, once holes are refined: those tets are not improved any more.
void measureEnergies(const WorkingLattice& lattice, double stopEnergy, Tetrahedralization& made) {
  const TetMesh& mesh = made.mesh;
  made.worstEnergy = made.meanEnergy = 0;
  made.badTets.clear();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const auto at = [&](std::size_t k) {
      return lattice.toLattice(mesh.points[mesh.tets[4 * t + k]]);
    };
    const double energy = tetEnergy(at(0), at(1), at(2), at(3));
    made.worstEnergy = std::max(made.worstEnergy, energy);
    made.meanEnergy += energy / static_cast<double>(mesh.tetCount());
    if (stopEnergy > 0 && energy > kEnergySlack * stopEnergy)
      made.badTets.push_back({t, energy, centreOf(mesh, t)});
  }
  std::stable_sort(made.badTets.begin(), made.badTets.end(),
                   [](const BadTet& a, const BadTet& b) { return a.energy > b.energy; });
}

// Improves the mesh and keeps the tets that are inside. Returns the points of the inputs that are
// lost.
std::vector<LostSurface::Point> finish(const MeshingWork& work, const InsertedSurface& inserted,
                                       const Landmarks* landmarks, const std::vector<Vec3d>& kept,
                                       TetComplex& complex, Tetrahedralization& made,
                                       StageTimer& timer, Progress& progress) {
  const TetrahedralizeOptions& options = work.options;
  const std::size_t count = work.inputs.size();
  const double edge = work.toLattice(work.lengths.edge);
  const LatticeSoup& soup = inserted.soup;
  const std::vector<std::uint32_t>& missing = inserted.missing;
  timer.part("improve");
  progress.stage("improve");
  const Bounds bounds{work.surface, work.boundary, work.radius, landmarks};
  ImproveCounts counts;
  bool isChained = false; // by regions
  if (options.stopEnergy > 0) {
    if (missing.empty())
      isChained = chainRegions(complex, insideOf(complex, count, soup, missing, progress), count,
                               options.boolean, options.keepOutside);
    ImproveOptions aims;
    aims.edgeLength = edge;
    aims.smallestEdge = work.radius;
    aims.stopEnergy = options.stopEnergy;
    aims.maxPasses = options.maxPasses;
    if (!isChained && !options.keepOutside)
      aims.weigh = [&](TetComplex& changed) {
        weighOutside(changed, insideOf(changed, count, soup, missing, progress), count,
                     options.boolean);
      };
    counts = improve(complex, bounds, aims, progress);
  } else {
    work.done.add(complex.tetCount());
    counts = coarsen(complex, bounds, progress);
  }
  assertValid(complex);
  made.passes = options.stopEnergy > 0 ? counts.passes : 0;

  timer.part("classify");
  progress.stage("classify");
  std::vector<std::uint16_t> inside = insideOf(complex, count, soup, missing, progress,
                                               kSumsOfTet * (work.done.most - work.done.tets));
  refineHoles(complex, count, soup, missing, {kHoleShare * edge, kMaxHoleTets, kept, work.radius},
              inside, progress);
  assertValid(complex);
  made.mesh = keptTets(complex, inside, count, isChained ? Boolean::Materials : options.boolean,
                       options.keepOutside, work.lattice);
  measureEnergies(work.lattice, options.stopEnergy, made);
  const auto& regions = made.mesh.regions;
  if (std::all_of(regions.begin(), regions.end(),
                  [](std::int32_t region) { return region == kOutsideRegion; }))
    throw Error(Status::Invalid, "", "nothing is inside: the triangles are sheets without volume",
                "give them thickness with voxelize `shell`, or check the mesh with info");

  timer.part("check");
  progress.stage("check");
  const InputSurface& original = work.original.get();
  LostSurface lost = original.lost(made.mesh, progress);
  made.boundaryFaces = lost.boundaryFaces;
  made.check.inToOut = lost.inToOut;
  made.check.owedPoints = original.owedPoints();
  made.check.lostPoints = lost.points.size();
  return std::move(lost.points);
}

// Where points were lost, in lattice units.
std::vector<Vec3d> placesOf(const std::vector<LostSurface::Point>& lost,
                            const WorkingLattice& lattice) {
  std::vector<Vec3d> places;
  places.reserve(lost.size());
  for (const LostSurface::Point& point : lost)
    places.push_back(lattice.toLattice(point.at));
  return places;
}

// Which points are corners of a face near a lost point: such a face belongs to a thin part, or
// bounds one, whose two sides simplification or coarsening has moved onto each other.
std::vector<std::uint8_t> cornersNear(const std::vector<Vec3d>& points,
                                      const std::vector<std::array<std::uint32_t, 3>>& faces,
                                      const std::vector<Vec3d>& lost, double distance) {
  const TriangleTree tree(points, faces);
  const double square = distance * distance;
  std::vector<std::uint8_t> isNear(points.size(), 0);
  for (const Vec3d& p : lost)
    tree.visit(p, square, [&](std::uint32_t i, double) {
      const NearTriangle& triangle = tree.triangle(i);
      if (triangle.squaredDistance(p) <= square)
        for (const std::uint32_t v : faces[triangle.face])
          isNear[v] = 1;
      return false;
    });
  return isNear;
}

// Fixes the corners of the surface's faces near lost points, so that these are not lost again.
void keepNear(TetComplex& complex, const std::vector<Vec3d>& lost, double distance) {
  if (lost.empty())
    return;
  std::vector<Vec3d> points;
  points.reserve(complex.points.size());
  for (const TetComplex::Point& point : complex.points)
    points.push_back(point.at);
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (const TetComplex::Tet& tet : complex.tets)
    for (unsigned localFace = 0; tet.exists() && localFace < 4; ++localFace)
      if (tet.tracked[localFace])
        faces.push_back({tet.corners[kFaceCorners[localFace][0]],
                         tet.corners[kFaceCorners[localFace][1]],
                         tet.corners[kFaceCorners[localFace][2]]});
  const std::vector<std::uint8_t> isNear = cornersNear(points, faces, lost, distance);
  for (std::size_t p = 0; p < points.size(); ++p)
    complex.points[p].fixed = complex.points[p].fixed || isNear[p];
}

// Whether points of the surface may be fixed: where an energy is asked for, they make it worse.
bool fixesPoints(const MeshingWork& work) {
  return !(work.options.stopEnergy > 0);
}

// Whether lost points are looked after. Where an energy is asked for, rounds take long, and around
// boundary edges the winding number decides what is kept.
bool mends(const MeshingWork& work) {
  return fixesPoints(work) || work.boundary.empty();
}

// Whether so much is lost that no more is tried.
bool areMany(const MeshingWork& work, const std::vector<Vec3d>& lost) {
  return lost.size() > work.original.get().owedPoints() / kFewLost;
}

// finish(), repeated where a few points are lost. The next round keeps them, and `kept`: by fixed
// points, or, where an energy is asked for, by landmarks. Returns what is lost in the end.
std::vector<Vec3d> finishAndMend(const MeshingWork& work, InsertedSurface inserted,
                                 std::vector<Vec3d> kept, Tetrahedralization& made,
                                 StageTimer& timer, Progress& progress) {
  Tetrahedralization best;
  std::vector<Vec3d> bestLost;
  for (int round = 0;; ++round) {
    const bool last = round == kMaxMends || !mends(work);
    // Moved in the last round alone. NOLINTNEXTLINE(bugprone-use-after-move)
    TetComplex mesh = last ? std::move(inserted.complex) : inserted.complex;
    std::unique_ptr<const Landmarks> landmarks;
    if (fixesPoints(work))
      keepNear(mesh, kept, kThinRadii * work.radius);
    else if (!kept.empty())
      landmarks = std::make_unique<const Landmarks>(work.surface, work.radius, kept);
    std::vector<Vec3d> lost = placesOf(
        finish(work, inserted, landmarks.get(), kept, mesh, made, timer, progress), work.lattice);
    if (round > 0 && lost.size() >= bestLost.size()) {
      made = std::move(best);
      return bestLost;
    }
    const bool isWorthwhile = round == 0 || 2 * lost.size() <= bestLost.size();
    if (last || lost.empty() || !isWorthwhile || areMany(work, lost))
      return lost;
    kept.insert(kept.end(), lost.begin(), lost.end());
    best = made;
    bestLost = std::move(lost);
  }
}

// Whether some of the soup's points `chosen` are not among `left`, which is sorted.
bool areMoved(const LatticeSoup& soup, const std::vector<std::uint8_t>& chosen,
              const std::vector<Vec3d>& left) {
  for (std::size_t v = 0; v < chosen.size(); ++v)
    if (chosen[v] && !std::binary_search(left.begin(), left.end(), soup.points[v]))
      return true;
  return false;
}

// A mesh with the soup's triangles as faces, of the first variant of which all are in, or else of
// the best. The soup's points in `fixed` are not simplified, the surface near `kept` not coarsened.
InsertedSurface insertVariants(const MeshingWork& work, const std::vector<std::uint8_t>& fixed,
                               const std::vector<Vec3d>& kept, StageTimer& timer,
                               Progress& progress) {
  const double radius = work.radius, epsilon = work.toLattice(work.epsilon);
  InsertSurfaceOptions options;
  options.spacing =
      std::min(work.toLattice(work.lengths.edge), work.toLattice(work.lengths.diagonal) / 10);
  options.margin = std::max(options.spacing, 2 * epsilon);
  options.clearance = 10 * epsilon;
  options.reach = kReachShare * radius;
  LatticeSoup simple;
  std::unique_ptr<const Landmarks> landmarks; // made once: a tenth of the time where faces cross
  options.coarsen = [&](TetComplex& complex) {
    work.done.add(complex.tetCount());
    if (fixesPoints(work))
      keepNear(complex, kept, kThinRadii * radius);
    if (!landmarks)
      landmarks = std::make_unique<const Landmarks>(work.surface, kThinShare * radius);
    coarsen(complex, {work.surface, work.boundary, kThinShare * radius, landmarks.get()}, progress);
  };
  const auto soupOf = [&](int variant) {
    if (variant != kSimplified && variant != kCareful)
      return perturbedSoup(simple, kPerturbShare * radius,
                           variant == kCarefulComponents ? Perturb::Components : Perturb::Points,
                           static_cast<std::uint32_t>(variant));
    timer.part("simplify");
    progress.stage("simplify");
    simple = work.soup;
    const double share = variant == kSimplified ? kSimplifyShare : kCarefulShare;
    simplifySoup(simple, work.surface, share * radius, fixed, progress);
    if (work.soup.faces.size() <= kMaxBeside)
      work.original.begin(); // the background mesh and the last faces keep one thread busy
    if (work.options.limitsWork)
      work.done.most =
          kMaxCoarsened + kMaxCoarsenedOfFace * static_cast<double>(simple.faces.size());
    return simple;
  };
  return insertSurface(soupOf, kVariants, work.inputs.size(), options, timer, progress);
}

} // namespace

Tetrahedralization meshInputs(const MeshingWork& work, StageTimer& timer, Progress& progress) {
  Tetrahedralization best;
  std::vector<Vec3d> kept, bestLost;
  std::vector<std::uint8_t> fixed;
  for (int round = 0; round <= kMaxRepeats; ++round) {
    Tetrahedralization made;
    std::vector<Vec3d> lost, inserted;
    try {
      InsertedSurface surface = insertVariants(work, fixed, kept, timer, progress);
      assertValid(surface.complex);
      made.simplifiedFaces = surface.soup.faces.size();
      made.notInserted = surface.missing.size();
      made.insertedFaces = made.simplifiedFaces - made.notInserted;
      inserted = surface.soup.points;
      lost = finishAndMend(work, std::move(surface), kept, made, timer, progress);
    } catch (const Error& error) {
      if (round == 0 || error.status() != Status::Limit)
        throw;
      break; // what was made before the limit stands
    }
    if (round > 0 && (lost.size() >= bestLost.size() || made.notInserted > best.notInserted ||
                      made.mesh.tetCount() > kMaxGrowth * best.mesh.tetCount()))
      break;
    best = std::move(made);
    bestLost = std::move(lost);
    if (bestLost.empty() || areMany(work, bestLost) || !mends(work) ||
        work.done.tets > kMaxRepeated)
      break;
    kept.insert(kept.end(), bestLost.begin(), bestLost.end());
    fixed = cornersNear(work.soup.points, work.soup.faces, kept, kThinRadii * work.radius);
    std::sort(inserted.begin(), inserted.end());
    if (!work.boundary.empty() && !areMoved(work.soup, fixed, inserted))
      break; // the winding number at hole boundaries decides, not what was inserted
  }
  return best;
}

} // namespace tetvdb
