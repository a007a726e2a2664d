// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/inside/InputChains.h"

#include <algorithm>
#include <tbb/parallel_sort.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kTetsPerCheck = 65536;

void addTracked(const TetComplex& complex, InputChains& chains, Progress& progress) {
  const int bits = chainBits(chains.inputs.size());
  for (std::uint32_t t = 0; t < complex.tets.size(); ++t) {
    if (t % kTetsPerCheck == 0)
      progress.check();
    const TetComplex::Tet& tet = complex.tets[t];
    if (!tet.exists())
      continue;
    for (std::size_t localFace = 0; localFace < 4; ++localFace) {
      if (tet.chains[localFace] == 0 || tet.neighbours[localFace] < t)
        continue;
      const auto& at = kFaceCorners[localFace];
      const std::array<std::uint32_t, 3> corners{tet.corners[at[0]], tet.corners[at[1]],
                                                 tet.corners[at[2]]};
      for (std::size_t input = 0; input < chains.inputs.size(); ++input)
        if (const std::int64_t weight = chainDigit(tet.chains[localFace], input, bits); weight != 0)
          chains.inputs[input].faces.push_back({corners, static_cast<std::int32_t>(weight)});
    }
  }
}

struct Place {
  Vec3d at;
  std::uint32_t number;
  bool operator<(const Place& other) const { return at < other.at; }
};

void addMissing(const TetComplex& complex, const LatticeSoup& soup,
                const std::vector<std::uint32_t>& missing, InputChains& chains) {
  std::vector<Place> places;
  for (const std::uint32_t face : missing)
    for (const std::uint32_t corner : soup.faces[face])
      places.push_back({soup.points[corner], TetComplex::kNone});
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end(),
                           [](const Place& p, const Place& q) { return p.at == q.at; }),
               places.end());
  const auto placeAt = [&](const Vec3d& at) {
    return std::lower_bound(places.begin(), places.end(), Place{at, 0});
  };
  for (std::uint32_t i = 0; i < complex.points.size() && !places.empty(); ++i)
    if (const auto place = placeAt(complex.at(i));
        complex.points[i].exists() && place != places.end() && place->at == complex.at(i))
      place->number = i;
  for (Place& place : places)
    if (place.number == TetComplex::kNone) {
      place.number = static_cast<std::uint32_t>(chains.points.size());
      chains.points.push_back(place.at);
    }
  for (const std::uint32_t face : missing) {
    const auto& corners = soup.faces[face];
    const auto number = [&](std::size_t i) { return placeAt(soup.points[corners[i]])->number; };
    chains.inputs[soup.inputs.empty() ? 0 : soup.inputs[face]].faces.push_back(
        {{number(0), number(1), number(2)}, 1});
  }
}

std::vector<InputChain::Edge> boundaryOf(const std::vector<InputChain::Face>& faces) {
  struct Side {
    std::uint64_t edge;
    std::int64_t weight;
  };
  std::vector<Side> sides;
  sides.reserve(3 * faces.size());
  for (const InputChain::Face& face : faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t a = face.corners[i], b = face.corners[(i + 1) % 3];
      sides.push_back({std::min(a, b) << 32 | std::max(a, b), a < b ? face.weight : -face.weight});
    }
  // The sides of an edge are summed up: which of them comes first has no part in the result.
  tbb::parallel_sort(sides.begin(), sides.end(),
                     [](const Side& s, const Side& t) { return s.edge < t.edge; });
  std::vector<InputChain::Edge> boundary;
  for (std::size_t i = 0; i < sides.size();) {
    const std::uint64_t edge = sides[i].edge;
    std::int64_t sum = 0;
    for (; i < sides.size() && sides[i].edge == edge; ++i)
      sum += sides[i].weight;
    const auto low = static_cast<std::uint32_t>(edge >> 32);
    const auto high = static_cast<std::uint32_t>(edge);
    if (sum > 0)
      boundary.push_back({low, high, static_cast<std::int32_t>(sum)});
    else if (sum < 0)
      boundary.push_back({high, low, static_cast<std::int32_t>(-sum)});
  }
  return boundary;
}

} // namespace

// Digits below it are taken off: each is in balanced notation, so that a negative one has borrowed
// from the next.
std::int64_t chainDigit(std::int64_t sum, std::size_t input, int bits) {
  for (;; --input) {
    const auto lowest =
        static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) << (64 - bits)) >> (64 - bits);
    if (input == 0)
      return lowest;
    sum = (sum - lowest) >> bits;
  }
}

InputChains inputChains(const TetComplex& complex, std::size_t inputCount, const LatticeSoup& soup,
                        const std::vector<std::uint32_t>& missing, Progress& progress) {
  InputChains chains;
  chains.inputs.resize(inputCount);
  chains.points.reserve(complex.points.size());
  for (const TetComplex::Point& point : complex.points)
    chains.points.push_back(point.at);
  addTracked(complex, chains, progress);
  for (InputChain& chain : chains.inputs)
    chain.missingBegin = chain.faces.size();
  addMissing(complex, soup, missing, chains);
  for (InputChain& chain : chains.inputs) {
    chain.boundary = boundaryOf(chain.faces);
    progress.check();
  }
  return chains;
}

ChainWinding chainWinding(const InputChains& chains, std::size_t input) {
  const InputChain& chain = chains.inputs[input];
  const auto at = [&](std::uint32_t point) {
    const Vec3d& p = chains.points[point];
    return LatticePoint{kCentreLattice * p[0], kCentreLattice * p[1], kCentreLattice * p[2]};
  };
  std::vector<ChainWinding::Face> faces;
  faces.reserve(chain.faces.size());
  for (const InputChain::Face& face : chain.faces)
    faces.push_back({at(face.corners[0]), at(face.corners[1]), at(face.corners[2]), face.weight});
  std::vector<BoundaryEdge> boundary;
  boundary.reserve(chain.boundary.size());
  for (const InputChain::Edge& edge : chain.boundary)
    boundary.push_back({at(edge.a), at(edge.b), edge.weight});
  return ChainWinding(std::move(faces), std::move(boundary));
}

} // namespace tetvdb
