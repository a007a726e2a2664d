// SPDX-License-Identifier: Apache-2.0
//
// The boundary of a tet mesh: the faces whose signs do not cancel when the faces of all tets are
// added up, by a hash table of faces; compare voxelize/BoundaryFaces.h.
#pragma once

#include "BuildLevels.h"
#include "TetColumns.h"

namespace tetvdb::nano {

struct Face {
  u32 a, b, c; // the normal points out of the mesh
  i32 weight;
};

// The corners of a tet's face in ascending order; sign > 0 where the normal of a, b, c in that
// order points out of the tet.
struct SortedFace {
  u32 a, b, c;
  i32 sign;
};

TETVDB_HD inline SortedFace sortedFace(const u32* tet, int face, int tetSign) {
  SortedFace f{tet[inwardCorner(face, 0)], tet[inwardCorner(face, 1)], tet[inwardCorner(face, 2)],
               -tetSign};
  const auto order = [&f](u32& p, u32& q) {
    if (p > q) {
      const u32 t = p;
      p = q;
      q = t;
      f.sign = -f.sign;
    }
  };
  order(f.a, f.b);
  order(f.b, f.c);
  order(f.a, f.b);
  return f;
}

TETVDB_HD inline u64 hashFace(const SortedFace& f) {
  u64 h = (u64(f.a) << 32 | f.b) * 0x9E3779B97F4A7C15ull;
  h = (h ^ (h >> 29)) + f.c;
  h *= 0xBF58476D1CE4E5B9ull;
  return h ^ (h >> 32);
}

struct OrientShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  u64 flipped, flat;
};

/// Orientation of the tets begin..end; raises kLongTet and kBadIndex.
template <typename Backend>
void orientTets(Backend& b, const LatticePoint* points, u64 pointCount, const u32* tets, u64 begin,
                u64 tetsEnd, std::int8_t* signs, u64* counts, u32* errors) {
  constexpr u64 kChunk = 4;
  const u64 perTeam = 256 * kChunk;
  b.template forTeams<OrientShared>(
      (tetsEnd - begin + perTeam - 1) / perTeam, 256,
      TETVDB_KERNEL(const Team& team, u64 part, OrientShared& s) {
        if (team.rank() == 0)
          s.flipped = s.flat = 0;
        team.sync();
        u64 flipped = 0, flat = 0;
        const u64 first = begin + part * perTeam;
        const u64 end = first + perTeam < tetsEnd ? first + perTeam : tetsEnd;
        for (u64 t = first + static_cast<u64>(team.rank()); t < end;
             t += static_cast<u64>(team.size())) {
          const u32* id = tets + 4 * t;
          if (id[0] >= pointCount || id[1] >= pointCount || id[2] >= pointCount ||
              id[3] >= pointCount) {
            orInto(errors, u32(kBadIndex));
            signs[t] = 0;
            continue;
          }
          const LatticePoint v[4] = {points[id[0]], points[id[1]], points[id[2]], points[id[3]]};
          if (boxOf(v[0], v[1], v[2], v[3]).extent() > kMaxTetExtent) {
            orInto(errors, u32(kLongTet));
            signs[t] = 0;
            continue;
          }
          const int sign = tetOrientation(v[0], v[1], v[2], v[3]);
          signs[t] = static_cast<std::int8_t>(sign);
          flipped += sign < 0;
          flat += sign == 0;
        }
        if (flipped != 0)
          addTo(&s.flipped, flipped);
        if (flat != 0)
          addTo(&s.flat, flat);
        team.sync();
        if (team.rank() == 0) {
          if (s.flipped != 0)
            addTo(counts, s.flipped);
          if (s.flat != 0)
            addTo(counts + 1, s.flat);
        }
        team.sync();
      });
}

/// Faces whose signs do not cancel; their order is not determined and has no influence.
template <typename Backend>
Face* boundaryFaces(Backend& b, const u32* tets, u64 tetCount, const std::int8_t* signs,
                    u64& faceCount) {
  u64 size = 1024;
  while (size < 5 * tetCount)
    size *= 2;
  const u64 mask = size - 1;
  constexpr u64 kFree = ~u64(0);
  u64* slots = b.template temp<u64>(size); // tet * 4 + face
  i32* sums = b.template temp<i32>(size);
  b.fill(slots, 0xFF, size * sizeof *slots);
  b.zero(sums, size * sizeof *sums);
  b.forEach(
      4 * tetCount, TETVDB_KERNEL(u64 i) {
        const int sign = signs[i / 4];
        if (sign == 0)
          return;
        const SortedFace f = sortedFace(tets + i / 4 * 4, static_cast<int>(i % 4), sign);
        for (u64 slot = hashFace(f) & mask;; slot = (slot + 1) & mask) {
          u64 other = slots[slot];
          if (other == kFree)
            other = exchangeIf(slots + slot, kFree, i);
          if (other != kFree) {
            const SortedFace g = sortedFace(tets + other / 4 * 4, static_cast<int>(other % 4), 1);
            if (g.a != f.a || g.b != f.b || g.c != f.c)
              continue;
          }
          addTo(sums + slot, f.sign);
          return;
        }
      });
  u32* open = b.template temp<u32>(size + 1);
  u64* rank = b.template temp<u64>(size + 1);
  b.forEach(
      size + 1, TETVDB_KERNEL(u64 i) { open[i] = i < size && sums[i] != 0; });
  b.scan(open, rank, size);
  faceCount = b.read(rank + size);
  Face* faces = b.template alloc<Face>(faceCount);
  b.forEach(
      size, TETVDB_KERNEL(u64 i) {
        const i32 sum = sums[i];
        if (sum == 0)
          return;
        const u64 id = slots[i];
        const SortedFace f = sortedFace(tets + id / 4 * 4, static_cast<int>(id % 4), 1);
        faces[rank[i]] = sum > 0 ? Face{f.a, f.b, f.c, sum} : Face{f.a, f.c, f.b, -sum};
      });
  b.dropTemporaries();
  return faces;
}

} // namespace tetvdb::nano
