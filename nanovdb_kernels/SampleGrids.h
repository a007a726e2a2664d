// SPDX-License-Identifier: Apache-2.0
//
// Samples arrays into grids of NanoVDB, one array after another: owners -> values -> the nodes
// above them -> buffer. As fields/FieldGrids.h on the CPU.
#pragma once

#include "SampleLeaves.h"

namespace tetvdb::nano {

struct ValueShared {
  static constexpr int kThreads = 128, kOccupancy = 12;
  u32 value[512];
  u64 active[8], leftOut[8];
  i32 minValue, maxValue;
  u32 differ;
  double sum[kParts], mean;
};

template <typename Backend>
class GridSampler {
public:
  /// `owners` have been built, for `mesh`; `fields` are those of `job`, of one number each.
  GridSampler(Backend& backend, Pipeline<Backend>& owners, const MeshView& mesh,
              const FieldJob& job, const SourceFields& fields)
      : b_(backend), pipeline_(owners), tets_(mesh.tets), job_(job), fields_(fields),
        leaves_(owners.leaves()), ownerMasks_(owners.ownerMasks()),
        ownerTable_(owners.ownerTable()) {}

  /// take(counts, buffer) for every field; the buffer is the backend's, until the return.
  template <typename Take>
  void run(const Take& take) {
    masks_ = b_.template alloc<u64>(8 * leaves_.count);
    table_ = b_.template alloc<i32>(512 * leaves_.count);
    summaries_ = b_.template alloc<LeafSummary>(leaves_.count);
    leaves_.state = b_.template alloc<u8>(leaves_.count);
    leaves_.value = b_.template alloc<i32>(leaves_.count);
    leftOut_ = b_.template alloc<u64>(1);
    for (std::size_t i = 0; i < job_.fields.size(); ++i)
      make(i, take);
    b_.stage("");
  }

  // Public only because of nvcc, as in LevelBuilder.

  template <typename Take>
  void make(std::size_t i, const Take& take) {
    const FieldView& field = job_.fields[i];
    if (field.rule.width() != 1)
      throw std::logic_error("grids of vectors are not made on the device");
    const bool isFloat = field.rule.kind != FieldKind::Integer;
    const Kind kind = isFloat ? Kind::Float : Kind::Int32;
    const GridValues values{0, bitsOf(field.background, isFloat), false, true};
    b_.stage("values");
    evaluate(i, isFloat, values.background);
    const NodeCounts nodes =
        pipeline_.buildValues(kind, values, leaves_, masks_, table_, summaries_);
    const BufferLayout layout = layoutOf(kind, nodes);
    if (layout.size > bufferSize_) { // the next grid may have more leaves
      bufferSize_ = layout.size + (leaves_.count - nodes.leaves) * leafSize(kind);
      buffer_ = b_.output(bufferSize_);
    }
    pipeline_.write(buffer_, layout);
    pipeline_.writer().writeHead(
        buffer_, layout,
        gridHeader(kind, isFloat ? nanovdb::GridClass::FogVolume : nanovdb::GridClass::Unknown,
                   field.name, job_.voxelSize, job_.origin),
        pipeline_.writer().roots());
    GridCounts counts;
    counts.bytes = layout.size;
    counts.leftOut = b_.read(static_cast<const u64*>(leftOut_));
    take(counts, static_cast<const u8*>(buffer_));
  }

  static u32 bitsOf(double value, bool isFloat) {
    union {
      float number;
      u32 bits;
    } u{static_cast<float>(value)};
    return isFloat ? u.bits : static_cast<u32>(static_cast<i32>(value));
  }

  // The exponent of infinities and of what is no number.
  TETVDB_HD static bool isFinite(u32 bits) { return (bits & 0x7F800000u) != 0x7F800000u; }

  TETVDB_HD static bool isSame(u32 a, u32 b, bool isFloat) {
    return a == b || (isFloat && ((a | b) & ~kMinusZero) == 0);
  }

  // Values, masks, states and sums of the leaves.
  void evaluate(std::size_t number, bool isFloat, u32 background) {
    const SourceField* field = fields_.fields + number;
    const u32* cellOfTet = fields_.cellOfTet;
    const KeySpace space = pipeline_.space();
    const LatticePoint* points = pipeline_.points();
    const u32* tets = tets_;
    const i32* owners = ownerTable_;
    const u64 *ownerMasks = ownerMasks_, *keys = leaves_.treeKey;
    u64 *masks = masks_, *leftOut = leftOut_;
    i32 *table = table_, *leafValues = leaves_.value;
    u8* states = leaves_.state;
    LeafSummary* summaries = summaries_;
    b_.zero(leftOut_, sizeof *leftOut_);
    b_.template forTeams<ValueShared>(
        leaves_.count, ValueShared::kThreads,
        TETVDB_KERNEL(const Team& team, u64 leaf, ValueShared& s) {
          for (int w = team.rank(); w < 8; w += team.size())
            s.leftOut[w] = 0;
          if (team.rank() == 0) {
            s.minValue = 0x7FFFFFFF;
            s.maxValue = -0x7FFFFFFF - 1;
            s.differ = 0;
          }
          team.sync();
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, keys[leaf]), origin);
          i32 low = 0x7FFFFFFF, high = -0x7FFFFFFF - 1;
          for (int n = team.rank(); n < 512; n += team.size()) {
            const u32 tet = static_cast<u32>(owners[512 * leaf + static_cast<u64>(n)]);
            u32 bits = background;
            if (tet != kNoTet) {
              const u32* vertices = tets + 4 * u64(tet);
              std::array<u8, 4> places{};
              std::array<double, 3> w{};
              if (!field->onCells) {
                const TetWeights weights(points, vertices);
                places = weights.corners();
                w = weights.at(origin[0] + (n >> 6), origin[1] + (n >> 3 & 7), origin[2] + (n & 7));
              }
              LeafSampler<Backend>::evaluate(*field, cellOfTet, tet, vertices, places, w, &bits);
              if (isFloat && !isFinite(bits)) {
                bits = background;
                orInto(&s.leftOut[n >> 6], u64(1) << (n & 63));
              } else {
                const i32 place = inOrder(bits, isFloat);
                low = place < low ? place : low;
                high = place > high ? place : high;
              }
            }
            s.value[n] = bits;
            table[512 * leaf + static_cast<u64>(n)] = static_cast<i32>(bits);
          }
          if (low <= high) {
            minInto(&s.minValue, low);
            maxInto(&s.maxValue, high);
          }
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
          constexpr int kOfPart = 512 / kParts;
          const auto forPart = [&](int p, const auto& f) {
            for (int n = p * kOfPart; n < (p + 1) * kOfPart; ++n)
              if ((s.active[n >> 6] >> (n & 63) & 1) != 0)
                f(numberFrom(s.value[n], isFloat));
          };
          for (int p = team.rank(); p < kParts; p += team.size()) {
            double sum = 0;
            forPart(p, [&](double v) { sum += v; });
            s.sum[p] = sum;
          }
          team.sync();
          const u64 count = countVoxels(s.active);
          if (team.rank() == 0) {
            double sum = 0;
            for (int p = 0; p < kParts; ++p)
              sum += s.sum[p];
            s.mean = count == 0 ? 0 : sum / static_cast<double>(count);
          }
          team.sync();
          for (int p = team.rank(); p < kParts; p += team.size()) {
            double squares = 0;
            forPart(p, [&](double v) { squares += (v - s.mean) * (v - s.mean); });
            s.sum[p] = squares;
          }
          team.sync();
          if (team.rank() == 0) {
            double squares = 0;
            for (int p = 0; p < kParts; ++p)
              squares += s.sum[p];
            summaries[leaf] = {s.minValue, s.maxValue, static_cast<double>(count), s.mean, squares};
            states[leaf] = count == 0 ? kEmpty : count == 512 && s.differ == 0 ? kFull : kNode;
            leafValues[leaf] = static_cast<i32>(s.value[0]);
            if (const u64 left = countVoxels(s.leftOut))
              addTo(leftOut, left);
          }
          team.sync();
        });
  }

private:
  Backend& b_;
  Pipeline<Backend>& pipeline_;
  const u32* tets_;
  const FieldJob& job_;
  SourceFields fields_;
  Entries leaves_; // with the states and values of the field
  const u64* ownerMasks_;
  const i32* ownerTable_;
  u64* masks_ = nullptr;
  i32* table_ = nullptr;
  LeafSummary* summaries_ = nullptr;
  u64* leftOut_ = nullptr;
  u8* buffer_ = nullptr;
  u64 bufferSize_ = 0;
};

} // namespace tetvdb::nano
