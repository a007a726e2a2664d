// SPDX-License-Identifier: Apache-2.0
//
// Samples arrays into grids of NanoVDB, one array after another: owners -> values -> the nodes
// above them -> buffer. As fields/FieldGrids.h on the CPU.
#pragma once

#include "SampleLeaves.h"
#include "SummarizeLeaf.h"

namespace tetvdb::nano {

template <typename V>
struct ValueShared : SharedLeaf<V> {
  static constexpr int kThreads = 128, kOccupancy = 12;
  u64 leftOut[8];
  u32 differ;
};

// A value of V from its bits, and what is asked of values.
TETVDB_HD inline void takeBits(const u32 (&bits)[3], u32& value) {
  value = bits[0];
}
TETVDB_HD inline void takeBits(const u32 (&bits)[3], Vector& value) {
  value = Vector(floatFrom(bits[0]), floatFrom(bits[1]), floatFrom(bits[2]));
}
TETVDB_HD inline bool isFinite(float number) { // the exponent of infinities and of NaN
  return (bitsOf(number) & 0x7F800000u) != 0x7F800000u;
}
TETVDB_HD inline bool isFinite(u32 bits, bool isFloat) {
  return !isFloat || isFinite(floatFrom(bits));
}
TETVDB_HD inline bool isFinite(const Vector& v, bool) {
  return isFinite(v[0]) && isFinite(v[1]) && isFinite(v[2]);
}
TETVDB_HD inline bool isSame(u32 a, u32 b, bool isFloat) {
  return a == b || (isFloat && ((a | b) & ~kMinusZero) == 0);
}
TETVDB_HD inline bool isSame(const Vector& a, const Vector& b, bool) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}
// The value of a full leaf, as GridValues has it.
TETVDB_HD inline i32 entryValue(u32 first, u64) {
  return static_cast<i32>(first);
}
TETVDB_HD inline i32 entryValue(const Vector&, u64 leaf) {
  return static_cast<i32>(static_cast<u32>(leaf));
}
// Bits that are the same for values that are.
TETVDB_HD inline u32 plainBits(float number) {
  return number == 0.0F ? 0u : bitsOf(number);
}

template <typename Backend>
class GridSampler {
public:
  /// `owners` have been built, for `mesh`; `fields` are those of `job`.
  GridSampler(Backend& backend, Pipeline<Backend>& owners, const MeshView& mesh,
              const FieldJob& job, const SourceFields& fields)
      : b_(backend), pipeline_(owners), tets_(mesh.tets), job_(job), fields_(fields),
        leaves_(owners.leaves()), ownerMasks_(owners.ownerMasks()),
        ownerTable_(owners.ownerTable()) {}

  /// take(counts, buffer) for every field; the buffer is the backend's, until the return.
  template <typename Take>
  void run(const Take& take) {
    u64 width = 1;
    for (const FieldView& field : job_.fields)
      width = field.rule.width() > 1 ? 3 : width;
    b_.require(leaves_.count * (64 + sizeof(LeafSummary) + 2 * 512 * sizeof(u32) * width));
    masks_ = b_.template alloc<u64>(8 * leaves_.count);
    table_ = b_.template alloc<u32>(512 * width * leaves_.count);
    summaries_ = b_.template alloc<LeafSummary>(leaves_.count);
    leaves_.state = b_.template alloc<u8>(leaves_.count);
    leaves_.value = b_.template alloc<i32>(leaves_.count);
    classes_ = b_.template alloc<u32>(width > 1 ? leaves_.count : 0);
    leftOut_ = b_.template alloc<u64>(1);
    for (std::size_t i = 0; i < job_.fields.size(); ++i)
      make(i, take);
    b_.stage("");
  }

  // Public only because of nvcc, as in LevelBuilder.

  template <typename Take>
  void make(std::size_t i, const Take& take) {
    const FieldView& field = job_.fields[i];
    const FieldKind rule = field.rule.kind;
    const Kind kind = rule == FieldKind::Vector    ? Kind::Vec3f
                      : rule == FieldKind::Integer ? Kind::Int32
                                                   : Kind::Float;
    GridValues values{0,
                      kind == Kind::Int32 ? static_cast<u32>(static_cast<i32>(field.background))
                                          : bitsOf(static_cast<float>(field.background)),
                      false, true};
    const u32* classes = nullptr;
    b_.stage("values");
    if (kind == Kind::Vec3f) {
      values.vectors = reinterpret_cast<const Vector*>(table_);
      evaluate<Vector>(i, kind, values);
      b_.stage("classes");
      classify(values.vectors);
      classes = classes_;
    } else {
      evaluate<u32>(i, kind, values);
    }
    const NodeCounts nodes =
        pipeline_.buildValues(kind, values, leaves_, masks_, table_, summaries_, classes);
    const BufferLayout layout = layoutOf(kind, nodes);
    if (layout.size > bufferSize_) { // the next grid may have more leaves
      bufferSize_ = layout.size + (leaves_.count - nodes.leaves) * nodeSizes(kind).leaf;
      buffer_ = b_.output(bufferSize_);
    }
    pipeline_.write(buffer_, layout);
    pipeline_.writer().writeHead(buffer_, layout,
                                 gridHeader(kind,
                                            kind == Kind::Float ? nanovdb::GridClass::FogVolume
                                                                : nanovdb::GridClass::Unknown,
                                            field.name, job_.voxelSize, job_.origin),
                                 pipeline_.writer().roots());
    GridCounts counts;
    counts.bytes = layout.size;
    counts.leftOut = b_.read(static_cast<const u64*>(leftOut_));
    take(counts, static_cast<const u8*>(buffer_));
  }

  // Values, masks, states and sums of the leaves.
  template <typename V>
  void evaluate(std::size_t number, Kind kind, const GridValues& gridValues) {
    using Shared = ValueShared<V>;
    const bool isFloat = kind != Kind::Int32;
    const SourceField* field = fields_.fields + number;
    const u32* cellOfTet = fields_.cellOfTet;
    const KeySpace space = pipeline_.space();
    const LatticePoint* points = pipeline_.points();
    const u32* tets = tets_;
    const u32* owners = ownerTable_;
    const V background = valueFrom<V>(gridValues.background);
    const u64 *ownerMasks = ownerMasks_, *keys = leaves_.treeKey;
    u64 *masks = masks_, *leftOut = leftOut_;
    V* const table = reinterpret_cast<V*>(table_);
    i32* leafValues = leaves_.value;
    u8* states = leaves_.state;
    LeafSummary* summaries = summaries_;
    b_.zero(leftOut_, sizeof *leftOut_);
    b_.template forTeams<Shared>(
        leaves_.count, Shared::kThreads, TETVDB_KERNEL(const Team& team, u64 leaf, Shared& s) {
          for (int w = team.rank(); w < 8; w += team.size())
            s.leftOut[w] = 0;
          if (team.rank() == 0) {
            s.extremes.clear();
            s.differ = 0;
          }
          team.sync();
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, keys[leaf]), origin);
          Extremes<V> extremes;
          for (int n = team.rank(); n < 512; n += team.size()) {
            const u32 tet = owners[512 * leaf + static_cast<u64>(n)];
            V value = background;
            if (tet != kNoTet) {
              const u32* vertices = tets + 4 * u64(tet);
              std::array<u8, 4> places{};
              std::array<double, 3> w{};
              if (!field->onCells) {
                const TetWeights weights(points, vertices);
                places = weights.corners();
                w = weights.at(origin[0] + (n >> 6), origin[1] + (n >> 3 & 7), origin[2] + (n & 7));
              }
              u32 bits[3];
              LeafSampler<Backend>::evaluate(*field, cellOfTet, tet, vertices, places, w, bits);
              takeBits(bits, value);
              if (isFinite(value, isFloat)) {
                extremes.add(value, value, static_cast<u32>(n), isFloat);
              } else {
                value = background;
                orInto(&s.leftOut[n >> 6], u64(1) << (n & 63));
              }
            }
            s.value[n] = value;
            table[512 * leaf + static_cast<u64>(n)] = value;
          }
          s.extremes.join(extremes);
          team.sync();
          for (int w = team.rank(); w < 8; w += team.size()) {
            s.active[w] = ownerMasks[8 * leaf + static_cast<u64>(w)] & ~s.leftOut[w];
            masks[8 * leaf + static_cast<u64>(w)] = s.active[w];
          }
          u32 differ = 0;
          for (int n = team.rank(); n < 512; n += team.size())
            differ |= isSame(s.value[n], s.value[0], isFloat) ? 0u : 1u;
          if (differ != 0)
            orInto(&s.differ, 1u);
          team.sync();
          LeafSummary summary;
          summarize(team, s, isFloat, summary);
          if (team.rank() == 0) {
            const u64 count = countVoxels(s.active);
            summaries[leaf] = summary;
            states[leaf] = count == 0 ? kEmpty : count == 512 && s.differ == 0 ? kFull : kNode;
            leafValues[leaf] = entryValue(s.value[0], leaf);
            if (const u64 left = countVoxels(s.leftOut))
              addTo(leftOut, left);
          }
          team.sync();
        });
  }

  // Gives full leaves of the same vector the same number: by its first two numbers, then by the
  // group of these and the third.
  void classify(const Vector* vectors) {
    const u64 n = leaves_.count;
    const u8* states = leaves_.state;
    u32* full = b_.template temp<u32>(n + 1);
    u64* rank = b_.template temp<u64>(n + 1);
    b_.forEach(
        n + 1, TETVDB_KERNEL(u64 i) { full[i] = i < n && states[i] == kFull; });
    b_.scan(full, rank, n);
    const u64 count = b_.read(rank + n);
    u64* keys = b_.template temp<u64>(count);
    u32* leaves = b_.template temp<u32>(count);
    b_.forEach(
        n, TETVDB_KERNEL(u64 i) {
          if (full[i] == 0)
            return;
          const Vector v = vectors[512 * i];
          keys[rank[i]] = u64(plainBits(v[0])) << 32 | plainBits(v[1]);
          leaves[rank[i]] = static_cast<u32>(i);
        });
    b_.sort(keys, leaves, count, 64);
    const Groups first = groupsOf(b_, keys, count, 0);
    u64* more = b_.template temp<u64>(count);
    b_.forEach(
        count, TETVDB_KERNEL(u64 i) {
          more[i] =
              (first.rank[i] + first.head[i]) << 32 | plainBits(vectors[512 * u64(leaves[i])][2]);
        });
    b_.sort(more, leaves, count, 64);
    const Groups second = groupsOf(b_, more, count, 0);
    u32* classes = classes_;
    b_.forEach(
        count, TETVDB_KERNEL(u64 i) {
          classes[leaves[i]] = static_cast<u32>(second.rank[i] + second.head[i]);
        });
    b_.dropTemporaries();
  }

private:
  Backend& b_;
  Pipeline<Backend>& pipeline_;
  const u32* tets_;
  const FieldJob& job_;
  SourceFields fields_;
  Entries leaves_; // with the states and values of the field
  const u64* ownerMasks_;
  const u32* ownerTable_;
  u64* masks_ = nullptr;
  u32* table_ = nullptr; // values' bits, of vectors three
  u32* classes_ = nullptr;
  LeafSummary* summaries_ = nullptr;
  u64* leftOut_ = nullptr;
  u8* buffer_ = nullptr;
  u64 bufferSize_ = 0;
};

} // namespace tetvdb::nano
