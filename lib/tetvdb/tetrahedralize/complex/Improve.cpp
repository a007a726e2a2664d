// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/Improve.h"

#include "tetvdb/tetrahedralize/complex/CollapseEdges.h"
#include "tetvdb/tetrahedralize/complex/EdgeSizes.h"
#include "tetvdb/tetrahedralize/complex/PeelTets.h"
#include "tetvdb/tetrahedralize/complex/SmoothPoints.h"
#include "tetvdb/tetrahedralize/complex/SplitEdges.h"
#include "tetvdb/tetrahedralize/complex/SwapEdges.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"
#include "tetvdb/tetrahedralize/complex/TetParts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// Worst and mean over all tets, the same sums for any number of threads. Returns how many tets are
// above `limit`.
std::size_t countEnergies(TetComplex& complex, double limit, ImproveCounts& counts) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (complex.tets.size() + kBlock - 1) / kBlock;
  struct Block {
    double worst = 0, sum = 0;
    std::size_t above = 0, tets = 0;
  };
  std::vector<Block> ofBlock(blocks);
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    const std::size_t end = std::min(complex.tets.size(), (block + 1) * kBlock);
    for (std::size_t t = block * kBlock; t < end; ++t) {
      if (!complex.tets[t].exists() || complex.tets[t].weight < 1)
        continue;
      const double energy = energyOf(complex, static_cast<std::uint32_t>(t));
      ofBlock[block].worst = std::max(ofBlock[block].worst, energy);
      ofBlock[block].sum += energy;
      ofBlock[block].above += energy > limit;
      ++ofBlock[block].tets;
    }
  });
  Block all;
  for (const Block& block : ofBlock) {
    all.worst = std::max(all.worst, block.worst);
    all.sum += block.sum;
    all.above += block.above;
    all.tets += block.tets;
  }
  counts.worstEnergy = all.worst;
  counts.meanEnergy = all.tets == 0 ? 0 : all.sum / static_cast<double>(all.tets);
  return all.above;
}

// Bounds with landmarks.
struct BoundsOnBothSides {
  std::unique_ptr<const Landmarks> own;
  Bounds bounds;

  explicit BoundsOnBothSides(const Bounds& given)
      : own(given.landmarks ? nullptr : new Landmarks(given.surface, given.radius)),
        bounds{given.surface, given.boundary, given.radius, own ? own.get() : given.landmarks} {}
};

constexpr int kRoundsAPass = 2;
// Passes that coarsen the mesh; the least number of passes that then follow sizes; passes after
// these that still aim below the stop energy.
constexpr int kCoarsePasses = 3, kFinePasses = 4, kMorePasses = 4;
constexpr double kAimShare = 0.8;
// Above this stop energy sizes are not used.
constexpr double kFineStop = 30;
// Sizes: at the surface, as a share of the coarse mesh's edges there; their growth away from it;
// around tets that stay bad, as a share of their edges; how often they are refined at most, and the
// passes between two refinements. Chosen by measurement: meshes with about this many tets have
// about the lowest mean energy for their number.
constexpr double kSurfaceShare = 1.25, kGrowth = 0.48, kRefinedShare = 0.7;
constexpr int kMaxRefined = 15, kPassesToRefine = 2;
// Where the input's own angles forbid the stop energy, smaller sizes never reach it: sizes ask for
// no more than kMostGrowth times the coarse mesh's tets (a truck of 79 thousand grew to 12.7
// million), and refining ends after kMaxSinceBest refinements without fewer tets above it, unless
// these are few: no more than one in kFewBad tets. It does not begin where they are more than one
// in kManyBad.
constexpr double kMostGrowth = 8;
constexpr int kMaxSinceBest = 2;
constexpr std::size_t kFewBad = 1000, kManyBad = 100;
// Edges are split where they are longer than kSplitShare of their size, and collapsed where they
// are shorter than kCollapseShare; on average they end up a tenth shorter than their size.
constexpr double kSplitShare = 4. / 3, kCollapseShare = 4. / 5, kSizeOfLength = 1.1;
// A split may leave tets of up to so many times the stop energy.
constexpr double kSplitEnergy = 3;

struct Step {
  double above; ///< tets of no more energy are neither swapped nor smoothed
  double aim;   ///< tets above it are also peeled, split and moved off the input
};

void improveParts(TetComplex& complex, const Bounds& bounds, const ImproveOptions& options,
                  const EdgeSizes& sizes, int round, const Step& step, ImproveCounts& counts,
                  Progress& progress) {
  constexpr int kSweeps = 2;
  EdgeCollapser::Rules rules;
  rules.sizes = &sizes;
  rules.longest = kCollapseShare;
  rules.longestNew = kSplitShare;
  TetParts parts(complex, round);
  std::vector<ImproveCounts> ofPart(parts.count());
  parts.run(
      [&](TetParts::Part& part) {
        ImproveCounts& mine = ofPart[part.index];
        mine.splits +=
            splitEdges(part.complex, sizes, kSplitShare, kSplitEnergy * options.stopEnergy);
        EdgeCollapser collapser(part.complex, bounds, rules);
        for (int sweep = 0; sweep < kSweeps; ++sweep)
          mine.collapses += collapser.sweep();
        progress.check();
        TetPeeler peeler(part.complex, bounds, step.aim);
        mine.peels += peeler.sweep();
        EdgeSwapper swapper(part.complex, bounds, step.above);
        PointSmoother smoother(part.complex, bounds, step.above, step.aim);
        for (int sweep = 0; sweep < kSweeps; ++sweep)
          mine.swaps += swapper.sweep();
        progress.check();
        for (int sweep = 0; sweep < kSweeps; ++sweep)
          mine.moves += smoother.sweep();
        progress.check();
        mine.splits += splitBadTets(part.complex, sizes, step.aim);
        mine.swaps += swapper.sweep();
        mine.moves += smoother.sweep();
      },
      progress);
  for (const ImproveCounts& mine : ofPart) {
    counts.splits += mine.splits;
    counts.collapses += mine.collapses;
    counts.swaps += mine.swaps;
    counts.moves += mine.moves;
    counts.peels += mine.peels;
  }
}

} // namespace

ImproveCounts coarsen(TetComplex& complex, const Bounds& given, Progress& progress) {
  const BoundsOnBothSides bothSides(given);
  const Bounds& bounds = bothSides.bounds;
  constexpr int kMaxSweeps = 4;
  ImproveCounts counts;
  EdgeCollapser::Rules rules;
  rules.energy = kCoarsenEnergy;
  for (int round = 0;; ++round) {
    const std::size_t before = complex.tetCount();
    TetParts parts(complex, round);
    std::vector<std::size_t> collapses(parts.count(), 0);
    parts.run(
        [&](TetParts::Part& part) {
          EdgeCollapser collapser(part.complex, bounds, rules);
          std::size_t last = part.complex.tetCount();
          for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
            progress.check();
            collapses[part.index] += collapser.sweep();
            const std::size_t now = part.complex.tetCount();
            if (last - now <= last / 100)
              break;
            last = now;
          }
        },
        progress);
    for (const std::size_t count : collapses)
      counts.collapses += count;
    ++counts.passes;
    if (before - complex.tetCount() <= before / 100)
      break;
  }
  countEnergies(complex, 0, counts);
  return counts;
}

ImproveCounts improve(TetComplex& complex, const Bounds& given, const ImproveOptions& options,
                      Progress& progress) {
  const BoundsOnBothSides bothSides(given);
  const Bounds& bounds = bothSides.bounds;
  ImproveCounts counts;
  for (TetComplex::Point& point : complex.points)
    point.changed = 0xFF; // other rules may have been in force
  const auto weigh = [&] {
    if (options.weigh)
      options.weigh(complex);
  };
  weigh();
  const EdgeSizes sizes(kSizeOfLength * options.edgeLength);
  const bool isFine = options.stopEnergy <= kFineStop;
  const double aim = kAimShare * options.stopEnergy;
  const Step coarse{options.stopEnergy / 2, options.stopEnergy}, fine{3, aim};
  std::size_t bad = countEnergies(complex, options.stopEnergy, counts);
  int round = 0, refined = 0, sinceRefined = 0, sinceBest = 0;
  double mostTets = std::numeric_limits<double>::infinity();
  std::size_t fewestBad = std::numeric_limits<std::size_t>::max();
  TetComplex best; // the one with the fewest tets above the stop energy, after fine passes
  while (counts.passes < options.maxPasses) {
    if (isFine && counts.passes == kCoarsePasses) {
      weigh();
      mostTets = kMostGrowth * static_cast<double>(complex.tetCount());
      sizes.followSurface(complex, kSurfaceShare, kGrowth, mostTets);
    }
    const bool isCoarse = !isFine || counts.passes < kCoarsePasses;
    for (int i = 0; i < kRoundsAPass; ++i)
      improveParts(complex, bounds, options, sizes, round++, isCoarse ? coarse : fine, counts,
                   progress);
    ++counts.passes;
    ++sinceRefined;
    const std::size_t before = bad;
    const int finePasses = counts.passes - kCoarsePasses;
    const double limit =
        isFine && finePasses < kFinePasses + kMorePasses ? aim : options.stopEnergy;
    bad = countEnergies(complex, limit, counts);
    if (isFine && finePasses < kFinePasses)
      continue;
    if (bad == 0)
      break;
    const std::size_t above = countEnergies(complex, options.stopEnergy, counts);
    if (above < fewestBad) {
      fewestBad = above;
      best = complex;
      sinceBest = 0;
    }
    if (5 * bad <= 4 * before || sinceRefined < kPassesToRefine)
      continue;
    const bool isStuck = above * kManyBad > complex.tetCount() ||
                         (sinceBest == kMaxSinceBest && above * kFewBad > complex.tetCount());
    if (refined == kMaxRefined || isStuck)
      break;
    weigh();
    if (!sizes.refine(complex, limit, kRefinedShare, kGrowth, options.smallestEdge, mostTets))
      break;
    ++sinceBest;
    ++refined;
    sinceRefined = 0;
  }
  if (countEnergies(complex, options.stopEnergy, counts) > fewestBad) {
    complex = std::move(best);
    countEnergies(complex, options.stopEnergy, counts);
  }
  return counts;
}

} // namespace tetvdb
