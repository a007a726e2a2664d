// SPDX-License-Identifier: Apache-2.0
//
// Samples arrays at the voxels that tets own: owners -> (values -> host) by batches of leaves.
#pragma once

#include "FieldJob.h"
#include "Pipeline.h"
#include "tetvdb/geometry/TetWeights.h"

#include <algorithm>
#include <vector>

namespace tetvdb::nano {

/// FieldJob's arrays in the backend's memory.
struct SourceArray {
  const void* values;
  NumberType type;
  u32 step, component;

  TETVDB_HD double number(u64 element) const {
    const u64 at = element * step + component;
    switch (type) {
    case NumberType::Float:
      return static_cast<double>(static_cast<const float*>(values)[at]);
    case NumberType::Double:
      return static_cast<const double*>(values)[at];
    case NumberType::Int32:
      return static_cast<double>(static_cast<const i32*>(values)[at]);
    default:
      return static_cast<double>(static_cast<const i64*>(values)[at]);
    }
  }
};

struct SourceField {
  FieldRule rule;
  bool onCells;
  SourceArray sources[FieldRule::kMaxNumbers];
  u64 place; ///< of its values: after so many bytes a leaf of the batch
};

/// The arrays of a job on the backend.
struct SourceFields {
  const SourceField* fields = nullptr;
  u32 count = 0;
  bool onPoints = false; ///< one of them at least
  const u32* cellOfTet = nullptr;
  u64 leafBytes = 0; ///< of all fields' values
};

/// The job that finds the owners.
inline Job ownersOf(const FieldJob& fields) {
  Job job;
  job.type = GridType::Owner;
  for (int k = 0; k < 3; ++k) {
    job.voxelSize[k] = fields.voxelSize[k];
    job.origin[k] = fields.origin[k];
  }
  return job;
}

struct SampleShared {
  static constexpr int kThreads = 128, kOccupancy = 16;
};

/// Copies the arrays of `job` to the backend: place(host, bytes) returns the address of a copy
/// there.
template <typename Backend, typename Place>
SourceFields placeFields(Backend& backend, const FieldJob& job, u64 tetCount, const Place& place) {
  SourceFields result;
  std::vector<const void*> arrays;
  for (const ArrayView& array : job.arrays)
    arrays.push_back(place(array.values, array.bytes()));
  std::vector<SourceField> fields;
  for (const FieldView& view : job.fields) {
    SourceField field{view.rule, view.onCells, {}, result.leafBytes};
    for (int k = 0; k < view.rule.numbers; ++k) {
      const FieldView::Source& source = view.sources[k];
      const ArrayView& array = job.arrays[source.array];
      field.sources[k] = {arrays[source.array], array.type, array.components, source.component};
    }
    fields.push_back(field);
    result.leafBytes += 512 * 4 * static_cast<u64>(view.rule.width());
    result.onPoints = result.onPoints || !view.onCells;
  }
  const u64 bytes = fields.size() * sizeof(SourceField);
  SourceField* const kept = backend.template alloc<SourceField>(fields.size());
  backend.upload(kept, fields.data(), bytes);
  result.fields = kept;
  result.count = static_cast<u32>(fields.size());
  if (job.cellOfTet != nullptr)
    result.cellOfTet = static_cast<const u32*>(place(job.cellOfTet, tetCount * sizeof(u32)));
  return result;
}

template <typename Backend>
class LeafSampler {
public:
  static constexpr u64 kMaskBytes = 64;
  static constexpr u64 kBatchBytes = u64(32) << 20; // at most, but for a node's leaves

  /// `owners` have been built, for `mesh`; `fields` are those of `job`.
  LeafSampler(Backend& backend, const Pipeline<Backend>& owners, const MeshView& mesh,
              const FieldJob& job, const SourceFields& fields)
      : b_(backend), owners_(owners), tets_(mesh.tets), job_(job), fields_(fields) {}

  /// Passes all leaves to `receiver`, batch by batch; the next batch is computed while the receiver
  /// works.
  void run(LeafReceiver& receiver) {
    b_.stage("values");
    const u64 count = owners_.leaves().count;
    receiver.expect(count);
    keys_.resize(count);
    b_.download(keys_.data(), owners_.leaves().treeKey, count);
    cutBatches();
    const std::size_t batches = cuts_.size() - 1;
    u64 max = 0;
    for (std::size_t i = 0; i < batches; ++i)
      max = std::max(max, cuts_[i + 1] - cuts_[i]);
    for (int half = 0; half < 2; ++half)
      halves_[half] =
          half < static_cast<int>(batches) ? b_.template alloc<u8>(max * bytesOfLeaf()) : nullptr;
    for (std::size_t i = 0; i <= batches; ++i) {
      if (i < batches)
        launch(i);
      if (i > 0)
        hand(i - 1, receiver);
    }
    b_.stage("");
  }

  // Public only because of nvcc, as in LevelBuilder.

  TETVDB_HD static void evaluate(const SourceField& field, const u32* cellOfTet, u32 tet,
                                 const u32* vertices, const std::array<u8, 4>& places,
                                 const std::array<double, 3>& w, u32* out) {
    double read[FieldRule::kMaxNumbers];
    const FieldRule& rule = field.rule;
    if (field.onCells) {
      const u64 cell = cellOfTet == nullptr ? tet : cellOfTet[tet];
      for (int k = 0; k < rule.numbers; ++k)
        read[k] = field.sources[k].number(cell);
    } else if (rule.kind == FieldKind::Integer) { // numbers of kinds are not mixed
      read[0] = field.sources[0].number(vertices[places[nearestCorner(w)]]);
    } else {
      for (int k = 0; k < rule.numbers; ++k) {
        const SourceArray& source = field.sources[k];
        std::array<double, 4> corners;
        corners[0] = source.number(vertices[places[0]]);
        for (std::size_t c = 1; c < 4; ++c)
          corners[c] = source.number(vertices[places[c]]) - corners[0];
        read[k] = interpolate(corners, w);
      }
    }
    double made[3];
    const double* value = rule.finish(read, made);
    if (rule.kind == FieldKind::Integer) {
      out[0] = static_cast<u32>(static_cast<i32>(value[0]));
      return;
    }
    for (int k = 0; k < rule.width(); ++k)
      out[k] = bitsOf(static_cast<float>(value[k]));
  }

  // Batch `i`: [masks][field 0's values][field 1's]... in the half of its turn.
  void launch(std::size_t i) {
    const u64 first = cuts_[i], count = cuts_[i + 1] - first;
    const SourceFields fields = fields_;
    const KeySpace space = owners_.space();
    const LatticePoint* points = owners_.points();
    const u32* tets = tets_;
    const u32* table = owners_.ownerTable() + 512 * first;
    const u64* masks = owners_.ownerMasks() + 8 * first;
    const u64* keys = owners_.leaves().treeKey + first;
    u8* out = halves_[i % 2];
    b_.template forTeams<SampleShared>(
        count, SampleShared::kThreads, TETVDB_KERNEL(const Team& team, u64 leaf, SampleShared&) {
          for (int w = team.rank(); w < 8; w += team.size())
            reinterpret_cast<u64*>(out)[8 * leaf + static_cast<u64>(w)] =
                masks[8 * leaf + static_cast<u64>(w)];
          i32 origin[3];
          originOf(space, 0, placeOfTreeKey(space, 0, keys[leaf]), origin);
          for (int n = team.rank(); n < 512; n += team.size()) {
            const u32 tet = table[512 * leaf + static_cast<u64>(n)];
            const u32* vertices = tets + 4 * u64(tet);
            std::array<u8, 4> places{};
            std::array<double, 3> w{};
            if (tet != kNoTet && fields.onPoints) {
              const TetWeights weights(points, vertices);
              places = weights.corners();
              w = weights.at(origin[0] + (n >> 6), origin[1] + (n >> 3 & 7), origin[2] + (n & 7));
            }
            for (u32 f = 0; f < fields.count; ++f) {
              const SourceField& field = fields.fields[f];
              const u64 width = static_cast<u64>(field.rule.width());
              u32* to = reinterpret_cast<u32*>(out + count * (kMaskBytes + field.place)) +
                        (512 * leaf + static_cast<u64>(n)) * width;
              if (tet != kNoTet) {
                evaluate(field, fields.cellOfTet, tet, vertices, places, w, to);
                continue;
              }
              for (u64 k = 0; k < width; ++k)
                to[k] = 0;
            }
          }
        });
    b_.land(static_cast<int>(i % 2), out, count * bytesOfLeaf());
  }

private:
  u64 bytesOfLeaf() const { return kMaskBytes + fields_.leafBytes; }

  // After whole lower nodes.
  void cutBatches() {
    const u64 count = keys_.size(), leaves = std::max<u64>(kBatchBytes / bytesOfLeaf(), 1);
    cuts_ = {0};
    u64 node = 0; // begin of the last node that is whole
    for (u64 i = 1; i <= count; ++i) {
      if (i < count && keys_[i] >> 12 == keys_[i - 1] >> 12)
        continue;
      if (i - cuts_.back() > leaves && node > cuts_.back())
        cuts_.push_back(node);
      node = i;
    }
    if (count > 0)
      cuts_.push_back(count);
  }

  void hand(std::size_t i, LeafReceiver& receiver) {
    const u8* bytes = b_.landed(static_cast<int>(i % 2));
    LeafBatch batch;
    batch.count = cuts_[i + 1] - cuts_[i];
    origins_.resize(3 * batch.count);
    for (u64 leaf = 0; leaf < batch.count; ++leaf) {
      i32 origin[3];
      originOf(owners_.space(), 0, placeOfTreeKey(owners_.space(), 0, keys_[cuts_[i] + leaf]),
               origin);
      std::copy_n(origin, 3, origins_.data() + 3 * leaf);
    }
    batch.origins = origins_.data();
    batch.masks = reinterpret_cast<const u64*>(bytes);
    u64 place = kMaskBytes;
    for (const FieldView& field : job_.fields) {
      batch.values.push_back(bytes + batch.count * place);
      place += 512 * 4 * static_cast<u64>(field.rule.width());
    }
    receiver.take(batch);
  }

  Backend& b_;
  const Pipeline<Backend>& owners_;
  const u32* tets_;
  const FieldJob& job_;
  SourceFields fields_;
  std::vector<u64> keys_;
  std::vector<u64> cuts_; // batch i: leaves cuts_[i] to cuts_[i + 1]
  std::vector<i32> origins_;
  u8* halves_[2] = {};
};

} // namespace tetvdb::nano
