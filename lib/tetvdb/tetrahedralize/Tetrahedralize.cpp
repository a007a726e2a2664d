// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/CheckMesh.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/tetrahedralize/MeshInputs.h"
#include "tetvdb/tetrahedralize/TwoSidedCheck.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"
#include "tetvdb/tetrahedralize/soup/Envelope.h"
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// Input points are snapped to this share of epsilon or less (latticeSoup()).
constexpr double kGrainShare = 1.0 / (1 << 24);
// Epsilon is at least so many times the distance at which input points are distinguished.
constexpr double kMinEpsilon = 256;
// Where points, or more than kVolumeSlack of the volume, are lost, all is done within half of
// epsilon, at most kMaxHalvings times. More than one in kFewOfOpen owed points of an open input are
// lost where its holes are closed, which a smaller epsilon does not change. The growth of small
// meshes, up to kSmallMesh tets, does not matter.
constexpr int kMaxHalvings = 4;
constexpr std::size_t kFewOfOpen = 5000;
constexpr std::size_t kSmallMesh = 10000;
// The report warns of volumes that are farther from the input's, as a share.
constexpr double kVolumeSlack = 0.05;
// Memory of the whole work for a triangle: above what the models of docs/benchmarks.md take, small
// ones and those that intersect themselves much apart.
constexpr double kBytesPerFace = 6000;

MeshLengths checkLengths(const Box& box, const TetrahedralizeOptions& options) {
  MeshLengths lengths{};
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

// As triangles without area, for an envelope.
std::vector<std::array<std::uint32_t, 3>> boundaryEdges(const LatticeSoup& soup) {
  std::vector<std::array<std::uint32_t, 3>> boundary;
  for (const auto& [a, b] : openEdges(soup))
    boundary.push_back({a, b, b});
  return boundary;
}

// The difference between the tets' volume and the input's, as a share of the latter.
double volumeLost(const Tetrahedralization& made) {
  const TwoSidedCheck& check = made.check;
  return std::abs(check.volume - check.windingVolume) / std::abs(check.windingVolume);
}

bool losesVolume(const Tetrahedralization& made) {
  return volumeLost(made) > kVolumeSlack;
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
  if (losesVolume(made)) {
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

// Whether less is lost of `other` than of `made`, and no more by any count.
bool losesLess(const Tetrahedralization& other, const Tetrahedralization& made) {
  const std::size_t lost = made.check.lostPoints, lostOfOther = other.check.lostPoints;
  const double volume = std::max(volumeLost(made), kVolumeSlack),
               volumeOfOther = std::max(volumeLost(other), kVolumeSlack);
  return other.notInserted <= made.notInserted &&
         other.mesh.tetCount() <= std::max(kSmallMesh, kMaxGrowth * made.mesh.tetCount()) &&
         lostOfOther <= lost && volumeOfOther <= volume &&
         (lostOfOther < lost || volumeOfOther < volume);
}

} // namespace

Tetrahedralization tetrahedralize(const std::vector<TriangleMesh>& inputs,
                                  const TetrahedralizeOptions& options, Report& report,
                                  Progress& progress) {
  const Box box = checkInputs(inputs);
  const MeshLengths lengths = checkLengths(box, options);
  const auto begin = Progress::Clock::now();
  StageTimer timer(report, "tetrahedralize");

  timer.part("snap");
  progress.stage("snap");
  const WorkingLattice lattice(box);
  const double grain = grainOf(lattice, lengths.epsilon);
  const LatticeSoup soup = latticeSoup(inputs, lattice, grain, progress);
  checkSoup(soup, options);

  const std::vector<std::array<std::uint32_t, 3>> edges = boundaryEdges(soup);
  WorkDone done;
  InputSurfaceTask original(inputs, options.boolean, lengths.epsilon, progress);
  const auto meshWithin = [&](double epsilon) {
    timer.part("envelope");
    progress.stage("envelope");
    // Snapping has moved points by half a grain's diagonal at most.
    const double radius = epsilon / lattice.unit() - grain;
    const Envelope surface(soup.points, soup.faces, radius), boundary(soup.points, edges, radius);
    Tetrahedralization result = meshInputs({inputs, options, lengths, lattice, soup, surface,
                                            boundary, epsilon, radius, done, original},
                                           timer, progress);
    timer.part("check");
    progress.stage("check");
    const InputSurface::Comparison compared = original.get().compare(result.mesh, progress);
    result.check.outToIn = compared.outToIn;
    result.check.volume = compared.volume;
    result.check.windingVolume = compared.windingVolume;
    result.epsilonUsed = epsilon;
    return result;
  };
  Tetrahedralization made = meshWithin(lengths.epsilon);
  const auto isWorthHalving = [&](double epsilon) {
    const TwoSidedCheck& check = made.check;
    const auto now = Progress::Clock::now();
    if (progress.deadline() - now < 2 * (now - begin))
      return false; // past the deadline nothing would be left
    const std::size_t few = edges.empty() ? kFewLost : kFewOfOpen;
    return !(options.stopEnergy > 0) && done.tets <= kMaxRepeated &&
           check.lostPoints <= check.owedPoints / few &&
           (check.lostPoints > 0 || losesVolume(made)) &&
           epsilon >= kMinEpsilon * lattice.coarse() * lattice.unit();
  };
  double within = lengths.epsilon / 2;
  for (int halving = 0; halving < kMaxHalvings && isWorthHalving(within); ++halving, within /= 2) {
    try {
      Tetrahedralization other = meshWithin(within);
      if (losesLess(other, made))
        made = std::move(other);
      else if (!losesVolume(made))
        break; // points alone: they seldom come back
    } catch (const Error& error) {
      if (error.status() != Status::Limit)
        throw;
      break; // what was made before the limit stands
    }
  }
  made.epsilonAsked = lengths.epsilon;
  made.edgeLength = lengths.edge;
  warnOfLoss(made, options, lengths.epsilon, report);
  return made;
}

} // namespace tetvdb
