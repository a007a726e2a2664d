// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FacePatches.h"

#include "tetvdb/core/DisjointSets.h"

namespace tetvdb {
namespace {

void flood(std::uint32_t seed, const EdgeTable& edges, FacePatches& patches,
           std::vector<std::uint32_t>& stack) {
  const auto patch = static_cast<std::uint32_t>(patches.orientable.size());
  patches.orientable.push_back(1);
  patches.patchOf[seed] = patch;
  stack.assign(1, seed);
  while (!stack.empty()) {
    const std::uint32_t face = stack.back();
    stack.pop_back();
    for (std::uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
      const EdgeTable::Sides sides = edges.sides(edges.edgeOf(side));
      if (sides.size() != 2)
        continue;
      const std::uint32_t otherSide = sides[sides[0] == side];
      const std::uint32_t other = EdgeTable::faceOf(otherSide);
      // Two faces are consistent if they traverse their edge in opposite directions.
      const bool disagree = edges.ascends(side) == edges.ascends(otherSide);
      const auto against = static_cast<std::uint8_t>(patches.against[face] ^ disagree);
      if (patches.patchOf[other] == EdgeTable::kNone) {
        patches.patchOf[other] = patch;
        patches.against[other] = against;
        stack.push_back(other);
      } else if (patches.against[other] != against) {
        patches.orientable[patch] = 0;
      }
    }
  }
}

template <typename ListOf>
FaceLists listFaces(std::size_t faces, std::size_t lists, const ListOf& listOf) {
  FaceLists result;
  result.first.assign(lists + 1, 0);
  std::uint32_t total = 0;
  for (std::size_t face = 0; face < faces; ++face) {
    const std::uint32_t list = listOf(face);
    if (list == EdgeTable::kNone)
      continue;
    ++result.first[list];
    ++total;
  }
  // first[i] is now the end of list i; filling backwards makes it the beginning.
  for (std::size_t list = 1; list <= lists; ++list)
    result.first[list] += result.first[list - 1];
  result.faces.resize(total);
  for (std::size_t face = faces; face-- > 0;) {
    const std::uint32_t list = listOf(face);
    if (list != EdgeTable::kNone)
      result.faces[--result.first[list]] = static_cast<std::uint32_t>(face);
  }
  return result;
}

} // namespace

FacePatches findPatches(std::size_t faceCount, const EdgeTable& edges, Progress& progress) {
  FacePatches patches;
  patches.patchOf.assign(faceCount, EdgeTable::kNone);
  patches.against.assign(faceCount, 0);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t face = 0; face < faceCount; ++face) {
    if (face % 65536 == 0)
      progress.check();
    if (patches.patchOf[face] == EdgeTable::kNone && edges.hasFace(face))
      flood(face, edges, patches, stack);
  }

  const std::size_t count = patches.orientable.size();
  DisjointSets sets(count);
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    for (std::size_t i = 1; sides.size() > 2 && i < sides.size(); ++i)
      sets.join(patches.patchOf[EdgeTable::faceOf(sides[i - 1])],
                patches.patchOf[EdgeTable::faceOf(sides[i])]);
  }
  patches.partOf.resize(count);
  for (std::uint32_t patch = 0; patch < count; ++patch) {
    const std::uint32_t root = sets.find(patch); // the component's first patch
    patches.partOf[patch] = root == patch ? patches.partCount++ : patches.partOf[root];
  }
  return patches;
}

FaceLists listByPatch(const FacePatches& patches) {
  return listFaces(patches.patchOf.size(), patches.patchCount(),
                   [&](std::size_t face) { return patches.patchOf[face]; });
}

FaceLists listByGroup(const FacePatches& patches, const std::vector<std::uint32_t>& groupOf,
                      std::uint32_t groupCount) {
  return listFaces(patches.patchOf.size(), groupCount, [&](std::size_t face) {
    const std::uint32_t patch = patches.patchOf[face];
    return patch == EdgeTable::kNone ? patch : groupOf[patch];
  });
}

} // namespace tetvdb
