// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/tetrahedralize/TwoSidedCheck.h"
#include "tetvdb/tetrahedralize/complex/Improve.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"
#include "tetvdb/tetrahedralize/insertion/InsertSurface.h"
#include "tetvdb/tetrahedralize/inside/Classify.h"
#include "tetvdb/tetrahedralize/inside/RefineHoles.h"
#include "tetvdb/tetrahedralize/inside/RegionChains.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/Landmarks.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"
#include "tetvdb/tetrahedralize/soup/PerturbSoup.h"
#include "tetvdb/tetrahedralize/soup/SimplifySoup.h"
#include "tetvdb/tetrahedralize/soup/TriangleTree.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
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

// Input points are snapped to this share of epsilon or less (latticeSoup()).
constexpr double kGrainShare = 1.0 / (1 << 24);
// Epsilon is at least so many times the distance at which input points are distinguished.
constexpr double kMinEpsilon = 256;
// Holes are closed along tets of this share of the target length, as long as no more than
// kMaxHoleTets are added.
constexpr double kHoleShare = 0.5;
constexpr std::size_t kMaxHoleTets = 25000;
// Where no more than one in kFewLost owed points is lost, the surface around them is kept as it was
// inserted and improvement is run again, at most kMaxMends times, as long as half or less is lost.
constexpr std::size_t kFewLost = 20;
constexpr int kMaxMends = 2;
// How near to lost points the surface's points are fixed, in envelope radii.
constexpr double kKeptRadii = 4;
// Points that are lost in spite of that were lost in simplification or at insertion: in parts
// thinner than this, in radii. The surface there stays as in the input and all is done again, at
// most kMaxRepeats times: as long as less was lost each time, for no more than kMaxGrowth times the
// tets, and where no more than kMaxRepeated tets were coarsened so far.
constexpr int kMaxRepeats = 3;
constexpr double kThinRadii = 3;
constexpr std::size_t kMaxGrowth = 2;
constexpr double kMaxRepeated = 2e6;
// The report warns of energies, and of volumes against the input's, that are farther off.
constexpr double kEnergySlack = 1.001, kVolumeSlack = 0.05;
// Memory of the whole work for a triangle: above what the models of docs/benchmarks.md take, small
// ones and those that intersect themselves much apart.
constexpr double kBytesPerFace = 6000;
// Tets that are coarsened, at 5 us each, where work is limited: in all, and more for each triangle.
constexpr double kMaxCoarsened = 2e6, kMaxCoarsenedOfFace = 200;
// Sums over boundary edges that take as long as coarsening a tet: one for each point and edge.
constexpr double kSumsOfTet = 2500;

// Counts what takes long, in tets that are coarsened.
struct WorkDone {
  double tets = 0;
  double most = std::numeric_limits<double>::infinity();

  void add(std::size_t coarsened) {
    tets += static_cast<double>(coarsened);
    if (tets > most)
      throw Error(Status::Limit, "", "the triangles cut one another into very many tets",
                  "`mesher=winding` needs no tets");
  }
};

struct Lengths {
  double diagonal, epsilon, edge; // world
};

Lengths checkLengths(const Box& box, const TetrahedralizeOptions& options) {
  Lengths lengths{};
  lengths.diagonal = length(minus(box.high, box.low));
  if (!(lengths.diagonal > 0))
    throw Error(Status::Invalid, "", "all points of the mesh are the same",
                "there is nothing to fill with tets");
  const auto isLength = [](double l) { return std::isfinite(l) && l >= 0; };
  if (!isLength(options.epsilon))
    throw Error(Status::Usage, "`epsilon`", "is not a length above 0");
  if (!isLength(options.edgeLength))
    throw Error(Status::Usage, "`edge_length`", "is not a length above 0");
  lengths.epsilon = options.epsilon > 0 ? options.epsilon : 1e-3 * lengths.diagonal;
  lengths.edge = options.edgeLength > 0 ? options.edgeLength : lengths.diagonal / 20;
  if (lengths.epsilon > 0.1 * lengths.diagonal)
    throw Error(Status::Usage, "`epsilon`",
                fmt::format("{:.6g} is more than a tenth of the model's diagonal, {:.6g}",
                            lengths.epsilon, lengths.diagonal),
                "nothing of the model would be left; 1e-3d is a usual choice");
  return lengths;
}

// Boundary edges as triangles without area, for an envelope.
std::vector<std::array<std::uint32_t, 3>> boundaryEdges(const LatticeSoup& soup) {
  std::vector<std::array<std::uint32_t, 3>> boundary;
  for (const auto& [a, b] : openEdges(soup))
    boundary.push_back({a, b, b});
  return boundary;
}

void assertValid([[maybe_unused]] const TetComplex& complex) {
#ifndef NDEBUG
  complex.verify();
#endif
}

// What all steps work on.
struct Work {
  const std::vector<TriangleMesh>& inputs;
  const TetrahedralizeOptions& options;
  const Lengths& lengths;
  const WorkingLattice& lattice;
  const LatticeSoup& soup; ///< the inputs
  const Envelope& surface;
  const Envelope& boundary;
  double radius; // lattice units
  WorkDone& done;
  std::unique_ptr<const InputSurface>& original; ///< made once there is a mesh to compare with it

  double toLattice(double length) const { return length / lattice.unit(); }
};

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
std::vector<LostSurface::Point> finish(const Work& work, const InsertedSurface& inserted,
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
  if (!work.original)
    work.original = std::make_unique<const InputSurface>(work.inputs, options.boolean,
                                                         work.lengths.epsilon, progress);
  LostSurface lost = work.original->lost(made.mesh, progress);
  made.boundaryFaces = lost.boundaryFaces;
  made.check.inToOut = lost.inToOut;
  made.check.owedPoints = work.original->owedPoints();
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

// Fixes the surface's points near lost points, so that these are not lost again.
void keepNear(TetComplex& complex, const std::vector<Vec3d>& lost, double distance) {
  if (lost.empty())
    return;
  std::vector<std::array<std::uint32_t, 3>> faces;
  for (std::uint32_t i = 0; i < lost.size(); ++i)
    faces.push_back({i, i, i});
  const Envelope near(lost, faces, distance);
  for (const TetComplex::Tet& tet : complex.tets)
    for (unsigned localFace = 0; tet.exists() && localFace < 4; ++localFace)
      if (tet.tracked[localFace])
        for (const unsigned corner : kFaceCorners[localFace]) {
          TetComplex::Point& point = complex.points[tet.corners[corner]];
          point.fixed = point.fixed || near.contains(point.at, distance);
        }
}

// Whether points of the surface may be fixed: where an energy is asked for, they make it worse.
bool fixesPoints(const Work& work) {
  return !(work.options.stopEnergy > 0);
}

// Whether lost points are looked after. Where an energy is asked for, rounds take long, and around
// boundary edges the winding number decides what is kept.
bool mends(const Work& work) {
  return fixesPoints(work) || work.boundary.empty();
}

// Whether so much is lost that no more is tried.
bool areMany(const Work& work, const std::vector<Vec3d>& lost) {
  return lost.size() > work.original->owedPoints() / kFewLost;
}

// finish(), repeated where a few points are lost. The next round keeps them, and `kept`: by fixed
// points, or, where an energy is asked for, by landmarks. Returns what is lost in the end.
std::vector<Vec3d> finishAndMend(const Work& work, InsertedSurface inserted,
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
      keepNear(mesh, kept, kKeptRadii * work.radius);
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

void warnOfLoss(const Tetrahedralization& made, const TetrahedralizeOptions& options,
                double epsilon, Report& report) {
  const TwoSidedCheck& check = made.check;
  if (!made.badTets.empty()) {
    report.partial = true;
    const auto& [x, y, z] = made.badTets.front().centre;
    report.warn("energy",
                fmt::format("{} of {} tets have an energy above the {:.4g} asked for, after {} "
                            "passes; the worst has {:.4g}, near ({:.6g}, {:.6g}, {:.6g})",
                            made.badTets.size(), made.mesh.tetCount(), options.stopEnergy,
                            made.passes, made.worstEnergy, x, y, z));
  }
  if (std::abs(check.volume - check.windingVolume) > kVolumeSlack * check.windingVolume) {
    report.partial = true;
    report.warn("volume", fmt::format("the tets fill {:.6g}, the input {:.6g}; a smaller epsilon "
                                      "keeps thin parts",
                                      check.volume, check.windingVolume));
  }
  if (made.notInserted > 0) {
    report.partial = true;
    report.warn("not-inserted",
                fmt::format("{} of {} triangles of the simplified mesh are not faces of the tets; "
                            "they count for what is inside",
                            made.notInserted, made.simplifiedFaces));
  }
  if (check.lostPoints > 0) {
    report.partial = true;
    report.warn("lost-surface",
                fmt::format("{} of {} points sampled on the input are farther than epsilon {:.6g} "
                            "from the tets' surface, {:.6g} at most; try a smaller epsilon",
                            check.lostPoints, check.owedPoints, epsilon, check.inToOut));
  }
}

// Checks the inputs; returns the box of their triangles.
Box checkInputs(const std::vector<TriangleMesh>& inputs) {
  if (inputs.empty())
    throw Error(Status::Usage, "", "no mesh was given");
  if (inputs.size() > kMaxInputs)
    throw Error(
        Status::Usage, "",
        fmt::format("{} meshes were given; {} can be told apart", inputs.size(), kMaxInputs),
        "join some of them into one file");
  Box box;
  for (const TriangleMesh& input : inputs) {
    checkMesh(input);
    box.add(boxOf(input.points, input.triangles));
  }
  if (!(box.low[0] <= box.high[0]))
    throw Error(Status::Invalid, "", "the mesh has no triangles");
  return box;
}

// The grain that the inputs' points are snapped to; lattice units.
double grainOf(const WorkingLattice& lattice, double epsilon) {
  const double asked = epsilon / lattice.unit();
  if (asked < kMinEpsilon * lattice.coarse())
    throw Error(Status::Usage, "`epsilon`",
                fmt::format("{:.6g} is too small: coordinates of this model are told apart to "
                            "{:.6g}",
                            epsilon, lattice.coarse() * lattice.unit()),
                fmt::format("take {:.6g} or more, or move the model nearer to the origin",
                            kMinEpsilon * lattice.coarse() * lattice.unit()));
  return std::max(lattice.coarse(), std::exp2(std::floor(std::log2(asked * kGrainShare))));
}

void checkSoup(const LatticeSoup& soup, const TetrahedralizeOptions& options) {
  if (soup.faces.empty())
    throw Error(Status::Invalid, "", "no triangle of the mesh has an area",
                "there is nothing to fill with tets");
  const double bytes = static_cast<double>(soup.faces.size()) * kBytesPerFace;
  if (options.maxMemory > 0 && bytes > static_cast<double>(options.maxMemory))
    throw Error(
        Status::Limit, "",
        fmt::format("meshing {} triangles takes about {:.1f} GB", soup.faces.size(), bytes / 1e9),
        "raise `max_memory`");
}

// The soup's points that are corners of a face near a lost point: such a face belongs to a thin
// part, or bounds one, whose two sides simplification has moved onto each other.
std::vector<std::uint8_t> cornersNear(const LatticeSoup& soup, const std::vector<Vec3d>& lost,
                                      double distance) {
  const TriangleTree tree(soup.points, soup.faces);
  const double square = distance * distance;
  std::vector<std::uint8_t> isNear(soup.points.size(), 0);
  for (const Vec3d& p : lost)
    tree.visit(p, square, [&](std::uint32_t i, double) {
      const NearTriangle& triangle = tree.triangle(i);
      if (triangle.squaredDistance(p) <= square)
        for (const std::uint32_t v : soup.faces[triangle.face])
          isNear[v] = 1;
      return false;
    });
  return isNear;
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
InsertedSurface insertVariants(const Work& work, const std::vector<std::uint8_t>& fixed,
                               const std::vector<Vec3d>& kept, StageTimer& timer,
                               Progress& progress) {
  const double radius = work.radius, epsilon = work.toLattice(work.lengths.epsilon);
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
      keepNear(complex, kept, kKeptRadii * radius);
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
    if (work.options.limitsWork)
      work.done.most =
          kMaxCoarsened + kMaxCoarsenedOfFace * static_cast<double>(simple.faces.size());
    return simple;
  };
  return insertSurface(soupOf, kVariants, work.inputs.size(), options, timer, progress);
}

// Tets of the inputs. Where improvement cannot keep a few points, since they were lost before, all
// is done again with the surface near them as it is in the inputs.
Tetrahedralization meshInputs(const Work& work, StageTimer& timer, Progress& progress) {
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
    fixed = cornersNear(work.soup, kept, kThinRadii * work.radius);
    std::sort(inserted.begin(), inserted.end());
    if (!work.boundary.empty() && !areMoved(work.soup, fixed, inserted))
      break; // the winding number at hole boundaries decides, not what was inserted
  }
  return best;
}

} // namespace

Tetrahedralization tetrahedralize(const std::vector<TriangleMesh>& inputs,
                                  const TetrahedralizeOptions& options, Report& report,
                                  Progress& progress) {
  const Box box = checkInputs(inputs);
  const Lengths lengths = checkLengths(box, options);
  StageTimer timer(report, "tetrahedralize");

  timer.part("snap");
  progress.stage("snap");
  const WorkingLattice lattice(box);
  const double grain = grainOf(lattice, lengths.epsilon);
  const LatticeSoup soup = latticeSoup(inputs, lattice, grain, progress);
  checkSoup(soup, options);

  timer.part("envelope");
  progress.stage("envelope");
  // Snapping has moved points by half a grain's diagonal at most.
  const double radius = lengths.epsilon / lattice.unit() - grain;
  const Envelope surface(soup.points, soup.faces, radius);
  const Envelope boundary(soup.points, boundaryEdges(soup), radius);

  WorkDone done;
  std::unique_ptr<const InputSurface> original;
  Tetrahedralization made = meshInputs(
      {inputs, options, lengths, lattice, soup, surface, boundary, radius, done, original}, timer,
      progress);
  timer.part("check");
  progress.stage("check");
  const InputSurface::Comparison compared = original->compare(made.mesh, progress);
  made.check.outToIn = compared.outToIn;
  made.check.volume = compared.volume;
  made.check.windingVolume = compared.windingVolume;
  made.epsilonAsked = lengths.epsilon;
  made.edgeLength = lengths.edge;
  warnOfLoss(made, options, lengths.epsilon, report);
  return made;
}

} // namespace tetvdb
