// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/DuplicateFaces.h"

#include "tetvdb/core/DisjointSets.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kPasses = 4;

// Whether sorting the corners is an even permutation.
bool isEven(const std::uint32_t* v) {
  return (v[0] < v[1]) == ((v[1] < v[2]) == (v[0] < v[2]));
}

// One face of each group, and every face without a duplicate.
struct UniqueFaces {
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> multiplicity;
  std::vector<std::uint32_t> group; ///< kNone for a face without a duplicate
};

UniqueFaces uniqueFaces(const std::vector<std::uint32_t>& corners, const DuplicateGroups& groups) {
  const std::size_t faces = corners.size() / 3;
  std::vector<std::uint32_t> groupOf(faces, EdgeTable::kNone);
  std::vector<std::uint8_t> later(faces, 0);
  for (std::uint32_t group = 0; group < groups.count(); ++group)
    for (std::uint32_t i = groups.first[group]; i < groups.first[group + 1]; ++i) {
      groupOf[groups.faces[i]] = group;
      later[groups.faces[i]] = i > groups.first[group];
    }
  UniqueFaces unique;
  for (std::size_t face = 0; face < faces; ++face) {
    if (later[face])
      continue;
    unique.corners.insert(unique.corners.end(), &corners[3 * face], &corners[3 * face] + 3);
    const std::uint32_t group = groupOf[face];
    unique.group.push_back(group);
    unique.multiplicity.push_back(
        group == EdgeTable::kNone ? 1 : groups.first[group + 1] - groups.first[group]);
  }
  return unique;
}

// If every face of a component has an even number of copies, the component as a whole is
// duplicated: divides the numbers of copies by their common power of two.
void halveWholeParts(std::vector<std::uint32_t>& multiplicity, const EdgeTable& edges) {
  DisjointSets parts(multiplicity.size());
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    for (const std::uint32_t side : edges.sides(edge))
      parts.join(EdgeTable::faceOf(edges.sides(edge)[0]), EdgeTable::faceOf(side));
  std::vector<std::uint32_t> bits(multiplicity.size(), 0);
  for (std::uint32_t face = 0; face < multiplicity.size(); ++face)
    bits[parts.find(face)] |= multiplicity[face];
  for (std::uint32_t face = 0; face < multiplicity.size(); ++face) {
    std::uint32_t power = bits[parts.find(face)];
    power &= ~power + 1; // the largest power of two that divides all
    multiplicity[face] /= power;
  }
}

// Decides which of the faces with an even number of copies stay, region by region.
class EvenFaces {
public:
  EvenFaces(const std::vector<std::uint32_t>& multiplicity, const EdgeTable& edges)
      : edges_(edges), kept_(multiplicity.size(), 1), keptAt_(edges.edgeCount()) {
    for (std::uint32_t face = 0; face < multiplicity.size(); ++face)
      if (multiplicity[face] % 2 == 0 && edges.hasFace(face))
        even_.push_back(face);
    isEven_.assign(multiplicity.size(), 0);
    for (const std::uint32_t face : even_)
      isEven_[face] = 1;
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
      keptAt_[edge] = static_cast<std::uint32_t>(edges.sides(edge).size());
  }

  const std::vector<std::uint8_t>& decide(Progress& progress) {
    // First all connected even faces together: a grid of boxes loses its walls in one step.
    vote(regions(false));
    const auto patches = regions(true);
    for (int pass = 0; pass < kPasses; ++pass) {
      progress.check();
      if (!vote(patches))
        break;
    }
    return kept_;
  }

private:
  using Region = std::vector<std::uint32_t>; // faces, ascending

  // Sets of connected even faces: across any edge, or across edges of exactly two faces, both even.
  // The smallest come first, so that the larger of two exclusive patches stays.
  std::vector<Region> regions(bool manifold) const {
    DisjointSets sets(kept_.size());
    for (std::uint32_t edge = 0; edge < edges_.edgeCount(); ++edge) {
      const EdgeTable::Sides sides = edges_.sides(edge);
      if (manifold && sides.size() != 2)
        continue;
      std::uint32_t before = EdgeTable::kNone;
      for (const std::uint32_t side : sides) {
        const std::uint32_t face = EdgeTable::faceOf(side);
        if (!isEven_[face])
          continue;
        if (before != EdgeTable::kNone)
          sets.join(before, face);
        before = face;
      }
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> members; // root, face
    for (const std::uint32_t face : even_)
      members.emplace_back(sets.find(face), face);
    std::sort(members.begin(), members.end());
    std::vector<Region> all;
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i == 0 || members[i].first != members[i - 1].first)
        all.emplace_back();
      all.back().push_back(members[i].second);
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Region& a, const Region& b) { return a.size() < b.size(); });
    return all;
  }

  // Returns whether anything changed.
  bool vote(const std::vector<Region>& regions) {
    bool changed = false;
    std::vector<std::uint32_t> around;
    for (const Region& region : regions) {
      around.clear();
      for (const std::uint32_t face : region)
        for (std::uint32_t k = 0; k < 3; ++k)
          around.push_back(edges_.edgeOf(3 * face + k));
      std::sort(around.begin(), around.end());
      const bool kept = kept_[region.front()];
      std::size_t toKeep = 0, toDrop = 0;
      for (std::size_t i = 0, end; i < around.size(); i = end) {
        for (end = i; end < around.size() && around[end] == around[i];)
          ++end;
        const std::uint32_t own = static_cast<std::uint32_t>(end - i);
        const std::uint32_t others = keptAt_[around[i]] - (kept ? own : 0);
        if (own % 2 == 0 || others == 0)
          continue;
        ++(others % 2 == 0 ? toDrop : toKeep);
      }
      const bool keep = toKeep == toDrop ? kept : toKeep > toDrop;
      if (keep == kept)
        continue;
      changed = true;
      for (const std::uint32_t face : region)
        kept_[face] = keep;
      for (const std::uint32_t edge : around)
        keptAt_[edge] += keep ? 1u : ~0u;
    }
    return changed;
  }

  const EdgeTable& edges_;
  std::vector<std::uint32_t> even_;
  std::vector<std::uint8_t> isEven_;
  std::vector<std::uint8_t> kept_;
  std::vector<std::uint32_t> keptAt_; ///< kept faces at each edge
};

// Keeps the first face of the orientation that most faces of the group have.
void keepOne(const std::vector<std::uint32_t>& corners, const std::uint32_t* first,
             const std::uint32_t* last, std::vector<FaceFate>& fates) {
  std::ptrdiff_t even = 0;
  for (const std::uint32_t* face = first; face != last; ++face)
    even += isEven(&corners[3 * std::size_t(*face)]);
  if (2 * even == last - first) {
    fates[*first] = FaceFate::StaysWithoutSide;
    return;
  }
  const bool wanted = 2 * even > last - first;
  fates[*std::find_if(first, last, [&](std::uint32_t face) {
    return isEven(&corners[3 * std::size_t(face)]) == wanted;
  })] = FaceFate::Stays;
}

} // namespace

DuplicateGroups findDuplicates(const EdgeTable& edges) {
  DuplicateGroups groups;
  groups.first.push_back(0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> around; // opposite corner, face
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    if (sides.size() < 2)
      continue;
    // Equal faces share three edges: they are found at the edge of their two lowest corners.
    around.clear();
    for (const std::uint32_t side : sides)
      if (edges.opposite(side) > edges.highPoint(edge))
        around.emplace_back(edges.opposite(side), EdgeTable::faceOf(side));
    if (around.size() < 2)
      continue;
    std::sort(around.begin(), around.end());
    for (std::size_t i = 0, end; i < around.size(); i = end) {
      for (end = i; end < around.size() && around[end].first == around[i].first;)
        ++end;
      if (end - i < 2)
        continue;
      for (std::size_t j = i; j < end; ++j)
        groups.faces.push_back(around[j].second);
      groups.first.push_back(static_cast<std::uint32_t>(groups.faces.size()));
    }
  }
  return groups;
}

std::vector<FaceFate> resolveDuplicates(const std::vector<std::uint32_t>& corners,
                                        std::size_t pointCount, const DuplicateGroups& groups,
                                        Progress& progress) {
  UniqueFaces unique = uniqueFaces(corners, groups);
  const EdgeTable edges(unique.corners, pointCount);
  halveWholeParts(unique.multiplicity, edges);
  EvenFaces even(unique.multiplicity, edges);
  const std::vector<std::uint8_t>& kept = even.decide(progress);

  std::vector<FaceFate> fates(corners.size() / 3, FaceFate::Stays);
  for (const std::uint32_t face : groups.faces)
    fates[face] = FaceFate::Goes;
  for (std::size_t face = 0; face < kept.size(); ++face) {
    const std::uint32_t group = unique.group[face];
    if (kept[face] && group != EdgeTable::kNone)
      keepOne(corners, &groups.faces[groups.first[group]],
              groups.faces.data() + groups.first[group + 1], fates);
  }
  return fates;
}

} // namespace tetvdb
