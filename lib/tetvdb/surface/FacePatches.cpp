// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FacePatches.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/ForEachIndex.h"

namespace tetvdb {
namespace {

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
  // Two faces are consistent if they traverse their edge in opposite directions.
  const auto disagree = [&](const EdgeTable::Sides& sides) {
    return edges.ascends(sides[0]) == edges.ascends(sides[1]);
  };
  const bool anyDisagree = countWhere(edges.edgeCount(), [&](std::size_t edge) {
                             const EdgeTable::Sides sides =
                                 edges.sides(static_cast<std::uint32_t>(edge));
                             return sides.size() == 2 && disagree(sides);
                           }) > 0;
  progress.check();

  // Where faces disagree, each has two elements: as it is and reversed.
  const std::uint32_t elements = anyDisagree ? 2 : 1;
  DisjointSets sets(elements * faceCount);
  forEachIndex(edges.edgeCount(), [&](std::size_t edge) {
    const EdgeTable::Sides sides = edges.sides(static_cast<std::uint32_t>(edge));
    if (sides.size() != 2)
      return;
    const std::uint32_t reversed = disagree(sides) ? 1 : 0;
    for (std::uint32_t k = 0; k < elements; ++k)
      sets.join(elements * EdgeTable::faceOf(sides[0]) + k,
                elements * EdgeTable::faceOf(sides[1]) + (k ^ reversed));
  });
  progress.check();

  FacePatches patches;
  patches.patchOf.assign(faceCount, EdgeTable::kNone);
  patches.against.assign(faceCount, 0);
  forEachIndex(faceCount, [&](std::size_t face) {
    if (!edges.hasFace(static_cast<std::uint32_t>(face)))
      return;
    const std::uint32_t first = sets.find(elements * static_cast<std::uint32_t>(face));
    patches.patchOf[face] = first / elements;
    patches.against[face] = static_cast<std::uint8_t>(first % elements);
  });
  for (std::uint32_t face = 0; face < faceCount; ++face) {
    std::uint32_t& patch = patches.patchOf[face]; // the first face of its patch so far
    if (patch == face) {
      patch = static_cast<std::uint32_t>(patches.orientable.size());
      patches.orientable.push_back(elements == 1 || sets.find(2 * face) != sets.find(2 * face + 1));
    } else if (patch != EdgeTable::kNone) {
      patch = patches.patchOf[patch];
    }
  }

  const std::size_t count = patches.orientable.size();
  DisjointSets parts(count);
  forEachIndex(edges.edgeCount(), [&](std::size_t edge) {
    const EdgeTable::Sides sides = edges.sides(static_cast<std::uint32_t>(edge));
    for (std::size_t i = 1; sides.size() > 2 && i < sides.size(); ++i)
      parts.join(patches.patchOf[EdgeTable::faceOf(sides[i - 1])],
                 patches.patchOf[EdgeTable::faceOf(sides[i])]);
  });
  patches.partOf.resize(count);
  for (std::uint32_t patch = 0; patch < count; ++patch) {
    const std::uint32_t root = parts.find(patch); // the component's first patch
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
