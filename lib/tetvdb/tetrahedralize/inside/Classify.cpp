// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/Classify.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/SplitAlongAxis.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"
#include "tetvdb/tetrahedralize/inside/InputChains.h"

#include <algorithm>
#include <cmath>
#include <tbb/parallel_invoke.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kTetsPerCheck = 65536;
// Tets that are tested together: the first number, its divisor after a test that fails, and the
// last number.
constexpr std::ptrdiff_t kMaxTogether = 256, kFewer = 4, kMinTogether = 16;

/// Calls step(from, localFace, to) for the neighbours of tets that are reached from those in
/// `open`. It returns whether the flood continues from `to`.
template <typename Step>
void flood(const TetComplex& complex, std::vector<std::uint32_t>& open, Progress& progress,
           const Step& step) {
  for (std::size_t count = 1; !open.empty(); ++count) {
    if (count % kTetsPerCheck == 0)
      progress.check();
    const std::uint32_t here = open.back();
    open.pop_back();
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = complex.tets[here].neighbours[localFace];
      if (next != TetComplex::kOutside && step(here, localFace, next))
        open.push_back(next);
    }
  }
}

// Closed inputs: from the box's outside, where all winding numbers are 0, through face after face.
// Sums get digits as wide as fit in 64 bits: windings may go beyond what a single face can hold.
void floodClosed(const TetComplex& complex, const InputChains& chains,
                 const std::vector<bool>& isClosed, std::vector<std::uint16_t>& inside,
                 Progress& progress) {
  const std::size_t inputs = chains.inputs.size();
  const int bits = chainBits(inputs), sumBits = static_cast<int>(64 / inputs);
  const auto widened = [&](Chain chain) {
    std::uint64_t sum = 0;
    for (std::size_t input = inputs; chain != 0 && input-- > 0;)
      if (isClosed[input])
        sum += static_cast<std::uint64_t>(chainDigit(chain, input, bits))
               << (static_cast<int>(input) * sumBits);
    return static_cast<std::int64_t>(sum);
  };
  std::vector<std::int64_t> winding(complex.tets.size(), 0);
  std::vector<bool> reached(complex.tets.size(), false);
  const auto reach = [&](std::uint32_t tet, std::int64_t sum) {
    winding[tet] = sum;
    reached[tet] = true;
    for (std::size_t input = 0; sum != 0 && input < inputs; ++input)
      if (chainDigit(sum, input, sumBits) > 0)
        inside[tet] = static_cast<std::uint16_t>(inside[tet] | 1u << input);
  };
  std::vector<std::uint32_t> open;
  for (std::uint32_t start = 0; start < complex.tets.size(); ++start) {
    const TetComplex::Tet& tet = complex.tets[start];
    for (std::size_t localFace = 0; localFace < 4 && tet.exists() && !reached[start]; ++localFace)
      if (tet.neighbours[localFace] == TetComplex::kOutside) {
        reach(start, widened(tet.chains[localFace]));
        open.push_back(start);
      }
    flood(complex, open, progress, [&](std::uint32_t from, unsigned localFace, std::uint32_t to) {
      if (reached[to])
        return false;
      reach(to, winding[from] - widened(complex.tets[from].chains[localFace]));
      return true;
    });
  }
}

// An input whose chain is open, or has faces that are missing in the mesh. In calm regions, where
// the winding number stays away from 0.5, 1.5 and so on, it is computed once and followed from tet
// to tet, rounded. Everywhere else it is computed for every tet.
class OpenInput {
public:
  OpenInput(const TetComplex& complex, const InputChains& chains, std::size_t input,
            Progress& progress);
  void classify(double maxSums, std::vector<std::uint16_t>& inside);

private:
  static constexpr std::uint32_t kNotCalm = 0xFFFFFFFFu, kCalm = 0xFFFFFFFEu; // or the region's

  static BoxTree missingFaces(const InputChains& chains, const InputChain& chain);
  struct Item {
    Vec3d centre; ///< four times as fine
    std::uint32_t tet;
  };
  void findCalm(std::ptrdiff_t begin, std::ptrdiff_t end, std::ptrdiff_t together);
  bool isCalm(std::ptrdiff_t begin, std::ptrdiff_t end) const;
  void findRegions();

  const TetComplex& complex_;
  const std::size_t input_, inputCount_;
  Progress& progress_;
  const ChainWinding winding_;
  const BoxTree missing_;
  std::vector<Item> items_; // tets that exist; neighbours in space come to lie together
  std::vector<std::uint32_t> region_;
  std::vector<std::int32_t> relative_;  // winding number, less that of the region's first tet
  std::vector<std::uint32_t> firstTet_; // of every region
};

OpenInput::OpenInput(const TetComplex& complex, const InputChains& chains, std::size_t input,
                     Progress& progress)
    : complex_(complex), input_(input), inputCount_(chains.inputs.size()), progress_(progress),
      winding_(chainWinding(chains, input)), missing_(missingFaces(chains, chains.inputs[input])),
      region_(complex.tets.size(), kNotCalm), relative_(complex.tets.size(), 0) {
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t)
    if (complex.tets[t].exists()) {
      const LatticePoint centre = tetCentre(complex, complex.tets[t]);
      items_.push_back({{centre.x, centre.y, centre.z}, t});
    }
}

BoxTree OpenInput::missingFaces(const InputChains& chains, const InputChain& chain) {
  std::vector<Box> boxes(chain.faces.size() - chain.missingBegin);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (const std::uint32_t corner : chain.faces[chain.missingBegin + i].corners)
      boxes[i].add(chains.points[corner]);
  return BoxTree(std::move(boxes));
}

// Whether the winding number can be followed through these tets: apart from tracked faces, its
// rounded value is the same in all of them.
bool OpenInput::isCalm(std::ptrdiff_t begin, std::ptrdiff_t end) const {
  Box box;
  for (std::ptrdiff_t i = begin; i < end; ++i)
    for (const std::uint32_t corner :
         complex_.tets[items_[static_cast<std::size_t>(i)].tet].corners)
      box.add(complex_.at(corner));
  bool hasMissing = false;
  missing_.visit([&](const Box& other) { return other.meets(box); },
                 [&](std::uint32_t) { return hasMissing = true; });
  const Vec3d half = times(minus(box.high, box.low), 0.5 * kCentreLattice);
  return !hasMissing &&
         winding_.staysRound(plus(times(box.low, kCentreLattice), half), length(half));
}

void OpenInput::findCalm(std::ptrdiff_t begin, std::ptrdiff_t end, std::ptrdiff_t together) {
  progress_.check();
  if (end - begin <= together) {
    if (isCalm(begin, end)) {
      for (std::ptrdiff_t i = begin; i < end; ++i)
        region_[items_[static_cast<std::size_t>(i)].tet] = kCalm;
      return;
    }
    together /= kFewer;
    if (together < kMinTogether)
      return;
  }
  const auto position = [](const Item& item) -> const Vec3d& { return item.centre; };
  const std::ptrdiff_t median = begin + (end - begin) / 2;
  const auto first = items_.begin() + begin, last = items_.begin() + end;
  splitAlongAxis(longestAxis(first, last, position), first, items_.begin() + median, last, position,
                 [](const Item& item) { return item.tet; });
  tbb::parallel_invoke([&] { findCalm(begin, median, together); },
                       [&] { findCalm(median, end, together); });
}

void OpenInput::findRegions() {
  const int bits = chainBits(inputCount_);
  std::vector<std::uint32_t> open;
  for (std::uint32_t start = 0; start < complex_.tets.size(); ++start) {
    if (region_[start] != kCalm)
      continue;
    const auto region = static_cast<std::uint32_t>(firstTet_.size());
    firstTet_.push_back(start);
    region_[start] = region;
    open.push_back(start);
    flood(complex_, open, progress_, [&](std::uint32_t from, unsigned localFace, std::uint32_t to) {
      if (region_[to] != kCalm)
        return false;
      region_[to] = region;
      const std::int64_t step = chainDigit(complex_.tets[from].chains[localFace], input_, bits);
      relative_[to] = static_cast<std::int32_t>(relative_[from] - step);
      return true;
    });
  }
}

void OpenInput::classify(double maxSums, std::vector<std::uint16_t>& inside) {
  findCalm(0, static_cast<std::ptrdiff_t>(items_.size()), kMaxTogether);
  findRegions();
  std::vector<LatticePoint> asked; // of regions, then of tets that belong to none
  for (const std::uint32_t tet : firstTet_)
    asked.push_back(tetCentre(complex_, complex_.tets[tet]));
  std::size_t next = asked.size();
  for (const Item& item : items_)
    if (region_[item.tet] == kNotCalm)
      asked.push_back({item.centre[0], item.centre[1], item.centre[2]});
  if (static_cast<double>(asked.size()) * static_cast<double>(winding_.boundaryEdges()) > maxSums)
    throw Error(Status::Limit, "", "the tets have very many boundary edges",
                "`mesher=winding` needs no tets");
  const std::vector<double> winding = winding_.at(asked, progress_);
  for (const Item& item : items_) {
    const std::uint32_t region = region_[item.tet];
    const double here = region == kNotCalm ? winding[next++]
                                           : std::nearbyint(winding[region]) + relative_[item.tet];
    if (here > 0.5)
      inside[item.tet] = static_cast<std::uint16_t>(inside[item.tet] | 1u << input_);
  }
}

} // namespace

std::vector<std::uint16_t> insideOf(const TetComplex& complex, std::size_t inputCount,
                                    const LatticeSoup& soup,
                                    const std::vector<std::uint32_t>& missing, Progress& progress,
                                    double maxSums) {
  std::vector<std::uint16_t> inside(complex.tets.size(), 0);
  const InputChains chains = inputChains(complex, inputCount, soup, missing, progress);
  std::vector<bool> isClosed(inputCount, false);
  for (std::size_t input = 0; input < inputCount; ++input) {
    isClosed[input] = chains.inputs[input].isFlooded();
    if (!isClosed[input])
      OpenInput(complex, chains, input, progress).classify(maxSums, inside);
  }
  if (std::find(isClosed.begin(), isClosed.end(), true) != isClosed.end())
    floodClosed(complex, chains, isClosed, inside, progress);
  return inside;
}

} // namespace tetvdb
