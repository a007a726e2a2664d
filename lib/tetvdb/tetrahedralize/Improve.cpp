// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/Improve.h"

#include "tetvdb/tetrahedralize/CollapseEdges.h"
#include "tetvdb/tetrahedralize/TetEnergy.h"
#include "tetvdb/tetrahedralize/TetParts.h"

#include <algorithm>
#include <array>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// Worst and mean over all tets; the same sums for any number of threads.
void countEnergies(TetComplex& complex, ImproveCounts& counts) {
  constexpr std::size_t kBlock = 4096;
  const std::size_t blocks = (complex.tets.size() + kBlock - 1) / kBlock;
  std::vector<std::array<double, 2>> ofBlock(blocks, {0, 0});
  tbb::parallel_for(std::size_t(0), blocks, [&](std::size_t block) {
    const std::size_t end = std::min(complex.tets.size(), (block + 1) * kBlock);
    for (std::size_t t = block * kBlock; t < end; ++t) {
      if (!complex.tets[t].exists())
        continue;
      const double energy = energyOf(complex, static_cast<std::uint32_t>(t));
      ofBlock[block][0] = std::max(ofBlock[block][0], energy);
      ofBlock[block][1] += energy;
    }
  });
  double sum = 0;
  counts.worstEnergy = 0;
  for (const auto& [worst, part] : ofBlock) {
    counts.worstEnergy = std::max(counts.worstEnergy, worst);
    sum += part;
  }
  counts.meanEnergy = complex.tetCount() == 0 ? 0 : sum / static_cast<double>(complex.tetCount());
}

std::size_t tetsPerPart(const TetComplex&) {
  return TetParts::kTetsPerPart;
}

} // namespace

ImproveCounts coarsen(TetComplex& complex, const Bounds& bounds, Progress& progress) {
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
    if (before - complex.tetCount() < before / 100)
      break;
  }
  countEnergies(complex, counts);
  return counts;
}

} // namespace tetvdb
