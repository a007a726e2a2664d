// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Improve.h"

#include "tetvdb/tetrahedralize/CollapseEdges.h"
#include "tetvdb/tetrahedralize/SmoothPoints.h"
#include "tetvdb/tetrahedralize/SplitEdges.h"
#include "tetvdb/tetrahedralize/SwapEdges.h"
#include "tetvdb/tetrahedralize/TetEnergy.h"
#include "tetvdb/tetrahedralize/TetParts.h"

#include <algorithm>
#include <array>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// Worst and mean over all tets, the same sums for any number of threads. Returns how many tets are
// above `limit`.
std::size_t countEnergies(TetComplex& complex, double limit, ImproveCounts& counts) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (complex.tets.size() + kBlock - 1) / kBlock;
  struct Block {
    double worst = 0, sum = 0;
    std::size_t above = 0;
  };
  std::vector<Block> ofBlock(blocks);
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    const std::size_t end = std::min(complex.tets.size(), (block + 1) * kBlock);
    for (std::size_t t = block * kBlock; t < end; ++t) {
      if (!complex.tets[t].exists())
        continue;
      const double energy = energyOf(complex, static_cast<std::uint32_t>(t));
      ofBlock[block].worst = std::max(ofBlock[block].worst, energy);
      ofBlock[block].sum += energy;
      ofBlock[block].above += energy > limit;
    }
  });
  Block all;
  for (const Block& block : ofBlock) {
    all.worst = std::max(all.worst, block.worst);
    all.sum += block.sum;
    all.above += block.above;
  }
  counts.worstEnergy = all.worst;
  counts.meanEnergy =
      complex.tetCount() == 0 ? 0 : all.sum / static_cast<double>(complex.tetCount());
  return all.above;
}

std::size_t tetsPerPart(const TetComplex&) {
  return TetParts::kTetsPerPart;
}

// Bounds with landmarks.
struct BoundsOnBothSides {
  std::unique_ptr<const Landmarks> own;
  Bounds bounds;

  explicit BoundsOnBothSides(const Bounds& given)
      : own(given.landmarks ? nullptr : new Landmarks(given.surface, given.radius)),
        bounds{given.surface, given.rim, given.radius, own ? own.get() : given.landmarks} {}
};

constexpr int kRoundsAPass = 2;

// Of every pass that got nowhere the next splits stuck tets, and collapses nothing, which might
// undo that.
struct Step {
  bool collapseOnly = false;
  int stuck = 0;     ///< how often that was done in a row
  bool first = true; ///< round of the pass
};

void improveParts(TetComplex& complex, const Bounds& bounds, const ImproveOptions& options,
                  int round, const Step& step, ImproveCounts& counts, Progress& progress) {
  constexpr int kSweeps = 2;
  EdgeCollapser::Rules rules;
  rules.longest = 4. / 5 * options.edgeLength;
  rules.longestNew = 4. / 3 * options.edgeLength;
  // Better tets are left alone.
  const double above = options.stopEnergy / 2;
  TetParts parts(complex, round, tetsPerPart(complex));
  std::vector<ImproveCounts> ofPart(parts.count());
  parts.run(
      [&](TetParts::Part& part) {
        ImproveCounts& mine = ofPart[part.index];
        if (step.stuck == 0 || step.collapseOnly) {
          if (!step.collapseOnly)
            mine.splits += splitEdges(part.complex, rules.longestNew);
          EdgeCollapser collapser(part.complex, bounds, rules);
          for (int sweep = 0; sweep < kSweeps; ++sweep)
            mine.collapses += collapser.sweep();
          if (step.collapseOnly)
            return;
        } else if (step.first) {
          mine.splits += splitStuckTets(part.complex, options.stopEnergy, options.smallestEdge,
                                        static_cast<std::size_t>(step.stuck - 1) % 6);
        }
        progress.check();
        EdgeSwapper swapper(part.complex, bounds, above);
        PointSmoother smoother(part.complex, bounds, above);
        for (int sweep = 0; sweep < kSweeps; ++sweep)
          mine.swaps += swapper.sweep();
        progress.check();
        for (int sweep = 0; sweep < kSweeps; ++sweep)
          mine.moves += smoother.sweep();
        progress.check();
        mine.splits += splitBadTets(part.complex, options.stopEnergy);
        mine.swaps += swapper.sweep();
        mine.moves += smoother.sweep();
      },
      progress);
  for (const ImproveCounts& mine : ofPart) {
    counts.splits += mine.splits;
    counts.collapses += mine.collapses;
    counts.swaps += mine.swaps;
    counts.moves += mine.moves;
  }
}

} // namespace

ImproveCounts coarsen(TetComplex& complex, const Bounds& given, Progress& progress) {
  const BoundsOnBothSides bothSides(given);
  const Bounds& bounds = bothSides.bounds;
  constexpr int kMostSweeps = 4;
  ImproveCounts counts;
  EdgeCollapser::Rules rules;
  rules.energy = kCoarsenEnergy;
  for (int round = 0;; ++round) {
    const std::size_t before = complex.tetCount();
    TetParts parts(complex, round, tetsPerPart(complex));
    std::vector<std::size_t> collapses(parts.count(), 0);
    parts.run(
        [&](TetParts::Part& part) {
          EdgeCollapser collapser(part.complex, bounds, rules);
          std::size_t last = part.complex.tetCount();
          for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
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
                      const std::function<std::size_t()>& reinsert, Progress& progress) {
  const BoundsOnBothSides bothSides(given);
  const Bounds& bounds = bothSides.bounds;
  ImproveCounts counts;
  for (TetComplex::Point& point : complex.points)
    point.changed = 0xFF; // other rules may have been in force
  std::size_t missing = reinsert ? reinsert() : 0;
  std::size_t bad = countEnergies(complex, options.stopEnergy, counts);
  constexpr int kMostStuck = 13; // every edge of a stuck tet was split in vain
  int round = 0, stuck = 0;
  while (counts.passes < options.maxPasses && stuck < kMostStuck &&
         (bad > 0 || missing > 0 || counts.passes == 0)) {
    for (int i = 0; i < kRoundsAPass; ++i)
      improveParts(complex, bounds, options, round++,
                   {false, stuck % 2 == 1 ? stuck / 2 + 1 : 0, i == 0}, counts, progress);
    if (reinsert && counts.passes % 3 == 2)
      missing = reinsert();
    ++counts.passes;
    const std::size_t before = bad;
    bad = countEnergies(complex, options.stopEnergy, counts);
    stuck = 5 * bad > 4 * before ? stuck + 1 : 0;
  }
  for (int i = 0; i < TetParts::kRounds; ++i)
    improveParts(complex, bounds, options, round++, {true, 0, true}, counts, progress);
  countEnergies(complex, options.stopEnergy, counts);
  return counts;
}

} // namespace tetvdb
