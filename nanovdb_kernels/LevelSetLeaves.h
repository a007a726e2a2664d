// SPDX-License-Identifier: Apache-2.0
//
// The leaves of a level set, and of its fog: distances with signs, batch by batch.
#pragma once

#include "BandLeaves.h"
#include "GridParts.h"
#include "KeySpace.h"
#include "tetvdb/geometry/NarrowBand.h"

#include <vector>

namespace tetvdb::nano {

struct AnyShared {
  static constexpr int kThreads = 32, kOccupancy = 32;
  u32 any;
};

struct SignShared {
  static constexpr int kThreads = 32, kOccupancy = 32;
  u64 inside[8], active[8];
  TeamExtremes<u32> extremes;
  Moments part[kParts];
};

struct FogShared {
  static constexpr int kThreads = 32, kOccupancy = 32;
  TeamExtremes<u32> extremes;
};

/// What makes fog of a level set, found on the backend.
struct FogFindings {
  i32 least;   ///< value of a voxel in a leaf, in order
  u32 anyTile; ///< whether an 8^3 tile is inside
};

/// What is inside, in a grid of NanoVDB's ValueMask.
struct InsideMask {
  const nanovdb::NanoGrid<nanovdb::ValueMask>* grid;

  TETVDB_HD bool at(const i32 (&voxel)[3]) const {
    return grid->getAccessor().isActive(nanovdb::Coord(voxel[0], voxel[1], voxel[2]));
  }
  /// The words of the leaf that begins at `origin`; returns whether it is a node.
  TETVDB_HD bool leaf(const i32 (&origin)[3], u64* words) const {
    const auto accessor = grid->getAccessor();
    const nanovdb::Coord first(origin[0], origin[1], origin[2]);
    const auto* node = accessor.probeLeaf(first);
    const u64 same = node == nullptr && accessor.isActive(first) ? ~u64(0) : 0;
    for (u32 x = 0; x < 8; ++x)
      words[x] = node == nullptr ? same : wordsOf(node->valueMask())[x];
    return node != nullptr;
  }
};

/// Leaves of a batch that have active voxels.
struct MadeLeaves {
  u64 count;
  ValueLeaf* leaves;
  u64 *key, *voxels;
  Moments* moments;
};

template <typename Backend>
class LevelSetLeaves {
public:
  LevelSetLeaves(Backend& backend, const NarrowBand& band) : b_(backend), band_(band) {}

  /// The leaves of a batch that have active voxels, `nodeKeys` those of its nodes.
  void add(const typename BandLeaves<Backend>::Batch& batch, const KeySpace& space,
           const u64* nodeKeys, const InsideMask& mask) {
    b_.stage("leaves");
    const NarrowBand band = band_;
    const float* squared = batch.squared;
    u32* some = b_.template temp<u32>(batch.leaves + 1);
    u64* rank = b_.template temp<u64>(batch.leaves + 1);
    b_.template forTeams<AnyShared>(
        batch.leaves, 32, TETVDB_KERNEL(const Team& team, u64 leaf, AnyShared& s) {
          if (team.rank() == 0)
            s.any = 0;
          team.sync();
          u32 any = 0;
          for (int i = team.rank(); i < kVoxelsInLeaf; i += team.size())
            any |= band.isActive(band.distance(squared[leaf * kVoxelsInLeaf + static_cast<u64>(i)]))
                       ? 1u
                       : 0u;
          if (any != 0)
            orInto(&s.any, 1u);
          team.sync();
          if (team.rank() == 0)
            some[leaf] = s.any;
          team.sync();
        });
    b_.scan(some, rank, batch.leaves);
    MadeLeaves made{b_.read(rank + batch.leaves), nullptr, nullptr, nullptr, nullptr};
    if (made.count == 0)
      return;
    made.leaves = b_.template alloc<ValueLeaf>(made.count);
    made.key = b_.template alloc<u64>(made.count);
    made.voxels = b_.template alloc<u64>(made.count);
    made.moments = b_.template alloc<Moments>(made.count);
    sign(batch, space, nodeKeys, mask, some, rank, made);
    made_.push_back(made);
  }

  u64 count() const {
    u64 sum = 0;
    for (const MadeLeaves& made : made_)
      sum += made.count;
    return sum;
  }

  /// All batches' arrays as one.
  template <typename T>
  T* joined(T* MadeLeaves::*array) {
    T* all = b_.template alloc<T>(count());
    T* to = all;
    for (const MadeLeaves& made : made_) {
      copyWords(to, made.*array, made.count * sizeof(T));
      to += made.count;
    }
    return all;
  }

  /// All leaves, one after the other.
  void write(u8* to) {
    for (const MadeLeaves& made : made_) {
      copyWords(to, made.leaves, made.count * sizeof(ValueLeaf));
      to += made.count * sizeof(ValueLeaf);
    }
  }

  /// The fog of the leaves that are `kept`, numbered by `nodes`, whose voxels and sums are set.
  void writeFog(u8* to, float depth, const KeySpace& space, const u32* allKept,
                const LevelNodes& nodes) {
    const float weight = 1 / depth;
    auto* const out = reinterpret_cast<ValueLeaf*>(to);
    u64* voxels = nodes.voxels;
    Moments* moments = nodes.moments;
    u64 first = 0;
    for (const MadeLeaves& made : made_) {
      const u32* kept = allKept + first;
      const u64* index = nodes.index + first;
      const u64* keys = made.key;
      const ValueLeaf* leaves = made.leaves;
      b_.template forTeams<SignShared>(
          made.count, 32, TETVDB_KERNEL(const Team& team, u64 i, SignShared& s) {
            if (kept[i] == 0)
              return;
            ValueLeaf& node = out[index[i]];
            clearLeaf(team, s);
            for (int p = team.rank(); p < kParts; p += team.size())
              addPart(s, p, [&](int voxel) {
                const float fog = fogOf(floatFrom(leaves[i].mValues[voxel]), weight);
                node.mValues[voxel] = bitsOf(fog);
                return ActiveValue{fog, fog > 0};
              });
            team.sync();
            if (team.rank() == 0) {
              i32 origin[3];
              originOf(space, 0, placeOfTreeKey(space, 0, keys[i]), origin);
              moments[index[i]] = finishLeaf(s, origin, node);
              voxels[index[i]] = countVoxels(s.active);
            }
            team.sync();
          });
      first += made.count;
    }
  }

  /// Which leaves have a voxel inside, and one more place; `fog` receives the least value.
  const u32* withInside(FogFindings* fog) {
    u32* kept = b_.template alloc<u32>(count() + 1);
    b_.zero(kept, (count() + 1) * sizeof(u32));
    b_.forEach(
        1, TETVDB_KERNEL(u64) {
          *fog = {0x7FFFFFFF, 0};
        });
    u64 first = 0;
    for (const MadeLeaves& made : made_) {
      const ValueLeaf* leaves = made.leaves;
      u32* const keptHere = kept + first;
      b_.template forTeams<FogShared>(
          made.count, 32, TETVDB_KERNEL(const Team& team, u64 i, FogShared& s) {
            if (team.rank() == 0)
              s.extremes.clear();
            team.sync();
            Extremes<u32> own;
            for (int n = team.rank(); n < kVoxelsInLeaf; n += team.size())
              own.add(leaves[i].mValues[n], leaves[i].mValues[n], 0, true);
            s.extremes.join(own);
            team.sync();
            if (team.rank() == 0) {
              keptHere[i] = s.extremes.least < 0 ? 1u : 0u; // as in order, so as numbers
              minInto(&fog->least, s.extremes.least);
            }
            team.sync();
          });
      first += made.count;
    }
    return kept;
  }

  // Public only because of nvcc, as in LevelBuilder.

  void sign(const typename BandLeaves<Backend>::Batch& batch, const KeySpace& space,
            const u64* nodeKeys, const InsideMask& mask, const u32* some, const u64* rank,
            const MadeLeaves& made) {
    const NarrowBand band = band_;
    const float* squared = batch.squared;
    const u32* entries = batch.entries;
    b_.template forTeams<SignShared>(
        batch.leaves, 32, TETVDB_KERNEL(const Team& team, u64 i, SignShared& s) {
          if (some[i] == 0)
            return;
          const u64 leaf = rank[i];
          const u64 key = nodeKeys[entries[i] / kLeavesInNode] << 12 | entries[i] % kLeavesInNode;
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, key), origin);
          if (team.rank() == 0)
            mask.leaf(origin, s.inside);
          clearLeaf(team, s);
          ValueLeaf& node = made.leaves[leaf];
          for (int p = team.rank(); p < kParts; p += team.size())
            addPart(s, p, [&](int voxel) {
              const float distance =
                  band.distance(squared[i * kVoxelsInLeaf + static_cast<u64>(voxel)]);
              const float absolute = band.absolute(distance);
              const bool inside = s.inside[voxel / 64] >> (voxel % 64) & 1;
              const float value = inside ? -absolute : absolute;
              node.mValues[voxel] = bitsOf(value);
              return ActiveValue{value, band.isActive(distance)};
            });
          team.sync();
          if (team.rank() == 0) {
            made.key[leaf] = key;
            made.moments[leaf] = finishLeaf(s, origin, node);
            made.voxels[leaf] = countVoxels(s.active);
          }
          team.sync();
        });
  }

  // A leaf of floats in steps of a team: nothing in it, the voxels of a part, its head.
  struct ActiveValue {
    float value;
    bool active;
  };
  TETVDB_HD static void clearLeaf(const Team& team, SignShared& s) {
    if (team.rank() == 0)
      s.extremes.clear();
    team.sync();
  }
  template <typename ValueAt>
  TETVDB_HD static void addPart(SignShared& s, int p, const ValueAt& valueAt) {
    Moments part{0, 0, 0};
    Extremes<u32> own;
    for (int r = p; r < kRowsInLeaf; r += kParts) {
      u32 active = 0;
      for (int z = 0; z < kLeafSize; ++z) {
        const ActiveValue v = valueAt(r * kLeafSize + z);
        if (!v.active)
          continue;
        active |= 1u << z;
        own.add(bitsOf(v.value), bitsOf(v.value), 0, true);
        addMoments(part, {1, static_cast<double>(v.value), 0});
      }
      reinterpret_cast<u8*>(s.active)[r] = static_cast<u8>(active);
    }
    s.part[p] = part;
    s.extremes.join(own);
  }
  TETVDB_HD static Moments finishLeaf(SignShared& s, const i32 (&origin)[3], ValueLeaf& node) {
    u64* head = reinterpret_cast<u64*>(&node);
    head[0] = head[1] = 0;
    leafBox(s.active, origin, reinterpret_cast<MaskLeaf&>(node));
    for (int x = 0; x < 8; ++x)
      head[2 + x] = s.active[x];
    const Moments sum = sumParts(s);
    setValues(node, valuesOf(s.extremes.least, s.extremes.most, sum, true));
    return sum;
  }

  void copyWords(void* to, const void* from, u64 bytes) {
    auto* target = static_cast<u64*>(to);
    const auto* source = static_cast<const u64*>(from);
    b_.forEach(
        bytes / sizeof(u64), TETVDB_KERNEL(u64 i) { target[i] = source[i]; });
  }

private:
  Backend& b_;
  NarrowBand band_;
  std::vector<MadeLeaves> made_;
};

} // namespace tetvdb::nano
