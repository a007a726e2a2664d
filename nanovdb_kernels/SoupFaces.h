// SPDX-License-Identifier: Apache-2.0
//
// The faces of a triangle soup, and whether they close: the directed edges are added up in a hash
// table; compare voxelize/SoupBoundary.h.
#pragma once

#include "BoundaryFaces.h"

namespace tetvdb::nano {

/// Whether a triangle's indices have points and its extent is at most kMaxTetExtent; raises
/// kBadIndex and kLongTet.
TETVDB_HD inline bool checkTriangle(const LatticePoint* points, u64 pointCount, const u32* id,
                                    u32* errors) {
  if (id[0] >= pointCount || id[1] >= pointCount || id[2] >= pointCount) {
    orInto(errors, u32(kBadIndex));
    return false;
  }
  const LatticePoint &a = points[id[0]], &b = points[id[1]], &c = points[id[2]];
  if (boxOf(a, b, c, c).extent() > kMaxTetExtent) {
    orInto(errors, u32(kLongTet));
    return false;
  }
  return true;
}

TETVDB_HD inline u64 hashEdge(u64 key) {
  key *= 0x9E3779B97F4A7C15ull;
  key ^= key >> 29;
  key *= 0xBF58476D1CE4E5B9ull;
  return key ^ (key >> 32);
}

struct EdgeCountShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  u64 open, odd;
};

/// Checks all triangles; adds to `open` the number of edges along which they do not cancel, and to
/// `odd` that of edges of an odd number of triangles.
template <typename Backend>
void countSoupEdges(Backend& b, const LatticePoint* points, u64 pointCount, const u32* triangles,
                    u64 triangleCount, u64* open, u64* odd, u32* errors) {
  u64 size = 1024;
  while (size < 6 * triangleCount) // three edges a triangle, where none is shared
    size *= 2;
  const u64 mask = size - 1;
  constexpr u64 kFree = ~u64(0);
  u64* keys = b.template temp<u64>(size); // the smaller index, then the larger one
  i32* sums = b.template temp<i32>(size);
  b.fill(keys, 0xFF, size * sizeof *keys);
  b.zero(sums, size * sizeof *sums);
  b.forEach(
      triangleCount, TETVDB_KERNEL(u64 t) {
        const u32 id[3] = {triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2]};
        if (!checkTriangle(points, pointCount, id, errors))
          return;
        for (int k = 0; k < 3; ++k) {
          const u64 from = id[k], to = id[k == 2 ? 0 : k + 1];
          if (from == to)
            continue;
          const u64 key = from < to ? from << 32 | to : to << 32 | from;
          for (u64 slot = hashEdge(key) & mask;; slot = (slot + 1) & mask) {
            u64 other = keys[slot];
            if (other == kFree)
              other = exchangeIf(keys + slot, kFree, key);
            if (other != kFree && other != key)
              continue;
            addTo(sums + slot, from < to ? 1 : -1);
            break;
          }
        }
      });
  constexpr u64 kPerTeam = 2048;
  b.template forTeams<EdgeCountShared>(
      (size + kPerTeam - 1) / kPerTeam, 256,
      TETVDB_KERNEL(const Team& team, u64 part, EdgeCountShared& s) {
        if (team.rank() == 0)
          s.open = s.odd = 0;
        team.sync();
        u64 openHere = 0, oddHere = 0;
        const u64 begin = part * kPerTeam, end = begin + kPerTeam < size ? begin + kPerTeam : size;
        for (u64 i = begin + static_cast<u64>(team.rank()); i < end;
             i += static_cast<u64>(team.size())) {
          openHere += sums[i] != 0;
          oddHere += static_cast<u64>(sums[i] & 1); // a sum of as many +1 and -1 is as odd
        }
        if (openHere != 0)
          addTo(&s.open, openHere);
        if (oddHere != 0)
          addTo(&s.odd, oddHere);
        team.sync();
        if (team.rank() == 0 && s.open != 0) {
          addTo(open, s.open);
          addTo(odd, s.odd);
        }
        team.sync();
      });
}

/// Every triangle as a face of weight 1.
template <typename Backend>
Face* soupFaces(Backend& b, const u32* triangles, u64 triangleCount) {
  Face* faces = b.template alloc<Face>(triangleCount);
  b.forEach(
      triangleCount, TETVDB_KERNEL(u64 t) {
        faces[t] = {triangles[3 * t], triangles[3 * t + 1], triangles[3 * t + 2], 1};
      });
  return faces;
}

} // namespace tetvdb::nano
