// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/RefineHoles.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/InsertPoint.h"
#include "tetvdb/tetrahedralize/inside/InputChains.h"

#include <algorithm>
#include <array>
#include <memory>
#include <tuple>

namespace tetvdb {
namespace {

constexpr std::size_t kEdgesPerCheck = 1024;
// Edges less than this share as long as the longest that is halved wait for a later round.
constexpr double kShareOfLongest = 0.5;

class HoleRefiner {
public:
  HoleRefiner(TetComplex& complex, const InputChains& chains, const HoleSizes& sizes,
              std::vector<std::uint16_t>& inside, Progress& progress);

  std::size_t run();

private:
  struct Edge {
    double square; ///< of its length
    std::uint32_t a, b;
    bool operator<(const Edge& other) const {
      return std::make_tuple(-square, a, b) < std::make_tuple(-other.square, other.a, other.b);
    }
    bool operator==(const Edge& other) const { return a == other.a && b == other.b; }
  };
  bool endsInside(const TetComplex::Tet& tet, std::uint16_t here, unsigned localFace) const;
  Edge longestEdge(const TetComplex::Tet& tet) const;
  double lengthAt(const TetComplex::Tet& tet) const;
  std::vector<Edge> edgesToHalve() const;
  bool halve(const Edge& edge);
  void classifyNew();

  TetComplex& complex_;
  const std::size_t inputCount_;
  const HoleSizes& sizes_;
  const BoxTree nearPoints_; // boxes around the points
  std::vector<std::uint16_t>& inside_;
  Progress& progress_;
  std::vector<std::unique_ptr<ChainWinding>> windings_; // of open inputs; null for others
  std::uint16_t open_ = 0;                              // bits of open inputs
  PointInsertion insertion_;
  std::vector<std::uint32_t> tets_, ring_, star_;
  std::vector<std::uint16_t> masks_;
  std::vector<std::uint32_t> fresh_; // tets to be classified; may have changed or gone since
};

BoxTree boxesAround(const std::vector<Vec3d>& points, double distance) {
  std::vector<Box> boxes;
  for (const Vec3d& p : points) {
    const Vec3d reach{distance, distance, distance};
    boxes.push_back({minus(p, reach), plus(p, reach)});
  }
  return BoxTree(std::move(boxes));
}

HoleRefiner::HoleRefiner(TetComplex& complex, const InputChains& chains, const HoleSizes& sizes,
                         std::vector<std::uint16_t>& inside, Progress& progress)
    : complex_(complex), inputCount_(chains.inputs.size()), sizes_(sizes),
      nearPoints_(boxesAround(sizes.points, sizes.near)), inside_(inside), progress_(progress),
      windings_(chains.inputs.size()), insertion_(complex) {
  for (std::size_t input = 0; input < inputCount_; ++input)
    if (!chains.inputs[input].isFlooded()) {
      windings_[input] = std::make_unique<ChainWinding>(chainWinding(chains, input));
      open_ = static_cast<std::uint16_t>(open_ | 1u << input);
    }
}

// Whether an open input's inside ends at a face of the tet that the input does not pass through.
bool HoleRefiner::endsInside(const TetComplex::Tet& tet, std::uint16_t here,
                             unsigned localFace) const {
  const std::uint32_t next = tet.neighbours[localFace];
  if (next == TetComplex::kOutside)
    return false;
  const int differ = (here ^ inside_[next]) & open_;
  for (std::size_t input = 0; differ >> input != 0; ++input)
    if ((differ >> input & 1) != 0 &&
        chainDigit(tet.chains[localFace], input, chainBits(inputCount_)) == 0)
      return true;
  return false;
}

HoleRefiner::Edge HoleRefiner::longestEdge(const TetComplex::Tet& tet) const {
  Edge longest{0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint32_t a = std::min(tet.corners[i], tet.corners[j]);
      const std::uint32_t b = std::max(tet.corners[i], tet.corners[j]);
      const Vec3d along = minus(complex_.at(b), complex_.at(a));
      longest = std::min(longest, Edge{dot(along, along), a, b});
    }
  return longest;
}

// The longest that the tet's edges may be.
double HoleRefiner::lengthAt(const TetComplex::Tet& tet) const {
  Box box;
  for (const std::uint32_t corner : tet.corners)
    box.add(complex_.at(corner));
  bool isNear = false;
  nearPoints_.visit([&](const Box& other) { return other.meets(box); },
                    [&](std::uint32_t) { return isNear = true; });
  return isNear ? sizes_.near : sizes_.length;
}

std::vector<HoleRefiner::Edge> HoleRefiner::edgesToHalve() const {
  std::vector<Edge> edges;
  for (std::size_t t = 0; t < complex_.tets.size(); ++t) {
    const TetComplex::Tet& tet = complex_.tets[t];
    if (!tet.exists())
      continue;
    for (unsigned localFace = 0; localFace < 4; ++localFace)
      if (endsInside(tet, inside_[t], localFace)) {
        const Edge edge = longestEdge(tet);
        const double length = lengthAt(tet);
        if (edge.square > length * length)
          edges.push_back(edge);
        break;
      }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// New tets inherit the bits of the tet that was halved.
bool HoleRefiner::halve(const Edge& edge) {
  if (!complex_.ring(edge.a, edge.b, tets_, ring_))
    return false; // halved or changed with another, or on the box's sides
  masks_.clear();
  for (const std::uint32_t tet : tets_)
    masks_.push_back(inside_[tet]);
  const Vec3d midpoint = roundToLattice(times(plus(complex_.at(edge.a), complex_.at(edge.b)), 0.5));
  const std::uint32_t point = insertion_.intoEdge(edge.a, edge.b, midpoint);
  if (point == TetComplex::kNone)
    return false;
  inside_.resize(complex_.tets.size(), 0);
  complex_.star(point, star_);
  for (const std::uint32_t tet : star_) {
    for (std::size_t i = 0; i < ring_.size(); ++i)
      if (complex_.tets[tet].cornerOf(ring_[i]) < 4 &&
          complex_.tets[tet].cornerOf(ring_[(i + 1) % ring_.size()]) < 4)
        inside_[tet] = masks_[i];
    fresh_.push_back(tet);
  }
  return true;
}

void HoleRefiner::classifyNew() {
  std::sort(fresh_.begin(), fresh_.end());
  fresh_.erase(std::unique(fresh_.begin(), fresh_.end()), fresh_.end());
  std::vector<LatticePoint> centres;
  for (const std::uint32_t tet : fresh_)
    centres.push_back(tetCentre(complex_, complex_.tets[tet]));
  for (std::size_t input = 0; input < inputCount_; ++input) {
    if (!windings_[input])
      continue;
    const std::vector<double> winding = windings_[input]->at(centres, progress_);
    for (std::size_t i = 0; i < fresh_.size(); ++i) {
      std::uint16_t& mask = inside_[fresh_[i]];
      mask = static_cast<std::uint16_t>((mask & ~(1u << input)) |
                                        (winding[i] > 0.5 ? 1u << input : 0u));
    }
  }
  fresh_.clear();
}

std::size_t HoleRefiner::run() {
  const std::size_t maxTets = complex_.tetCount() + sizes_.maxMore;
  std::size_t points = 0;
  while (open_ != 0) {
    const std::vector<Edge> edges = edgesToHalve();
    std::size_t halved = 0;
    double minSquare = 0; // some of the longest may not be halved at all
    for (std::size_t i = 0; i < edges.size() && complex_.tetCount() < maxTets; ++i) {
      if (i % kEdgesPerCheck == 0)
        progress_.check();
      if (edges[i].square < minSquare)
        break;
      if (!halve(edges[i]))
        continue;
      if (halved++ == 0)
        minSquare = edges[i].square * kShareOfLongest * kShareOfLongest;
    }
    if (halved == 0)
      break;
    points += halved;
    classifyNew();
  }
  return points;
}

} // namespace

std::size_t refineHoles(TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, const HoleSizes& sizes,
                        std::vector<std::uint16_t>& inside, Progress& progress) {
  const InputChains chains = inputChains(complex, inputCount, soup, missing, progress);
  if (std::all_of(chains.inputs.begin(), chains.inputs.end(),
                  [](const InputChain& chain) { return chain.isFlooded(); }))
    return 0;
  return HoleRefiner(complex, chains, sizes, inside, progress).run();
}

} // namespace tetvdb
