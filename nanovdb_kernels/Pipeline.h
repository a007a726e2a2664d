// SPDX-License-Identifier: Apache-2.0
//
// One model from arrays to a NanoVDB buffer, on any backend:
// snap -> orient -> (boundary -> faces' leaves | tets' leaves) -> lower nodes -> upper nodes ->
// write.
#pragma once

#include "DeviceVoxelizer.h"
#include "WriteGrid.h"
#include "tetvdb/core/Error.h"

#include <cmath>
#include <cstring>

namespace tetvdb::nano {

constexpr double kMaxVoxel = 2147475456.0; // as SnappedMesh.cpp has it

/// What the first steps find, read together.
struct Findings {
  i64 low[3], high[3]; ///< box of the points, lattice units
  u64 flipped, flat;
  u32 errors, unused;
};

struct SnapShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  i64 low[3], high[3];
};

template <typename Backend>
class Pipeline {
public:
  Pipeline(Backend& backend, const MeshView& mesh, const Job& job)
      : b_(backend), mesh_(mesh), job_(job) {}

  /// Builds; the buffer is the backend's memory. `mesh` lies where the backend computes.
  Result run() {
    checkJob();
    b_.stage("snap");
    begin();
    b_.awaitPoints();
    snap();
    found_ = b_.read(findings_);
    chooseSpace();

    Entries leaves;
    LeafMasks masks;
    i32* table = nullptr;
    LeafSummary* summaries = nullptr;
    signs_ = b_.template alloc<std::int8_t>(mesh_.tetCount);
    TetRasterizer<Backend> tets(b_, space_, points_, mesh_.tets, mesh_.tetCount, signs_);
    const bool owners = job_.type == GridType::Owner;
    const bool dense =
        !owners &&
        (job_.road == Road::Tets ? denseFits() : job_.road == Road::Auto && denseIsFaster());
    if (!owners && job_.road == Road::Tets && !dense)
      throw Error(Status::Limit, "", "the grid is too large for the road by tets on the device",
                  "take the road by the boundary");
    const bool carries = !owners && !dense;
    b_.stage(dense ? "rasterize" : "orient");
    if (dense)
      tets.beginDense(nodeMin_, nodeMax_);
    // As the tets arrive.
    for (int part = 0; part < b_.parts(); ++part) {
      b_.awaitTets(part);
      const u64 parts = static_cast<u64>(b_.parts()), k = static_cast<u64>(part);
      const u64 first = mesh_.tetCount * k / parts, end = mesh_.tetCount * (k + 1) / parts;
      orientTets(b_, points_, mesh_.pointCount, mesh_.tets, first, end, signs_, &findings_->flipped,
                 errors_);
      if (dense)
        tets.addDense(first, end);
    }
    found_ = b_.read(findings_);
    refuseTets();
    Result result;
    Counts& counts = result.counts;
    counts.flipped = found_.flipped;
    counts.dropped = found_.flat;
    if (owners) {
      leaves = tets.runOwners(mesh_.values, -1, masks, table, summaries);
    } else if (dense) {
      leaves = tets.endDense(masks);
    } else {
      b_.stage("boundary");
      u64 faceCount = 0;
      const Face* faces = boundaryFaces(b_, mesh_.tets, mesh_.tetCount, signs_, faceCount);
      counts.boundaryFaces = faceCount;
      leaves = FaceRasterizer<Backend>(b_, space_).run(points_, faces, faceCount, masks);
    }
    counts.road = carries ? Road::Boundary : Road::Tets;

    b_.stage("levels");
    LevelBuilder<Backend> levels(b_, space_, carries, errors_);
    NodeMasks<4> lowerMasks;
    NodeMasks<5> upperMasks;
    const GrowLeaves<Backend> growLeaves{b_, masks, leaves.slots};
    levels.template closeGaps<1>(0, leaves, masks.top, growLeaves);
    checkCount(leaves.count);
    Entries lowers = levels.template parents<4>(0, leaves, lowerMasks);
    const GrowNodes<Backend, 4> growLowers{b_, lowerMasks};
    levels.template closeGaps<4>(1, lowers, lowerMasks.top, growLowers);
    checkCount(lowers.count);
    Entries uppers = levels.template parents<5>(1, lowers, upperMasks);
    const GrowNodes<Backend, 5> growUppers{b_, upperMasks};
    levels.template closeGaps<16>(2, uppers, upperMasks.top, growUppers);
    if (b_.read(errors_) & kNotClosed)
      throw std::logic_error("the boundary does not close: crossings were lost");

    b_.stage("tree");
    const Kind kind = kindOf(job_.type);
    GridWriter<Backend> writer(b_, space_, kind, valuesOf(job_.type));
    const BufferLayout layout = writer.lay(leaves, lowers, uppers);
    checkCount(layout.leaves);
    u8* buffer = b_.output(layout.size);
    writer.write(buffer, layout, makeHeader(kind), leaves, masks, table, summaries, lowers,
                 lowerMasks, uppers, upperMasks);
    b_.stage("");
    counts.leaves = layout.leaves;
    counts.lowerNodes = layout.lowers;
    counts.upperNodes = layout.uppers;
    counts.rootTiles = layout.rootTiles - layout.uppers;
    counts.bufferBytes = layout.size;
    result.bytes = buffer;
    return result;
  }

  // Public for nvcc alone, as in LevelBuilder.

  void begin() {
    findings_ = b_.template alloc<Findings>(1);
    errors_ = &findings_->errors;
    Findings* findings = findings_;
    b_.forEach(
        1, TETVDB_KERNEL(u64) {
          for (int k = 0; k < 3; ++k) {
            findings->low[k] = i64(1) << 62;
            findings->high[k] = -(i64(1) << 62);
          }
          findings->flipped = findings->flat = 0;
          findings->errors = findings->unused = 0;
        });
  }

  void snap() {
    const u64 n = mesh_.pointCount;
    points_ = b_.template alloc<LatticePoint>(n);
    LatticePoint* points = points_;
    const double* world = mesh_.points;
    const double ox = job_.origin[0], oy = job_.origin[1], oz = job_.origin[2];
    const double hx = job_.voxelSize[0], hy = job_.voxelSize[1], hz = job_.voxelSize[2];
    u32* errors = errors_;
    Findings* findings = findings_;
    constexpr u64 kPerTeam = 2048;
    b_.template forTeams<SnapShared>(
        (n + kPerTeam - 1) / kPerTeam, 256,
        TETVDB_KERNEL(const Team& team, u64 part, SnapShared& s) {
          if (team.rank() == 0)
            for (int k = 0; k < 3; ++k) {
              s.low[k] = i64(1) << 62;
              s.high[k] = -(i64(1) << 62);
            }
          team.sync();
          i64 low[3] = {i64(1) << 62, i64(1) << 62, i64(1) << 62};
          i64 high[3] = {-(i64(1) << 62), -(i64(1) << 62), -(i64(1) << 62)};
          const u64 end = (part + 1) * kPerTeam < n ? (part + 1) * kPerTeam : n;
          for (u64 i = part * kPerTeam + static_cast<u64>(team.rank()); i < end;
               i += static_cast<u64>(team.size())) {
            const double p[3] = {world[3 * i], world[3 * i + 1], world[3 * i + 2]};
            const bool inside = magnitude((p[0] - ox) / hx) < kMaxVoxel &&
                                magnitude((p[1] - oy) / hy) < kMaxVoxel &&
                                magnitude((p[2] - oz) / hz) < kMaxVoxel;
            if (!inside) { // or not a number
              orInto(errors, u32(kBadPoint));
              points[i] = {0, 0, 0};
              continue;
            }
            const LatticePoint q{snapToLattice(p[0], ox, hx), snapToLattice(p[1], oy, hy),
                                 snapToLattice(p[2], oz, hz)};
            points[i] = q;
            const i64 c[3] = {static_cast<i64>(q.x), static_cast<i64>(q.y), static_cast<i64>(q.z)};
            for (int k = 0; k < 3; ++k) {
              low[k] = c[k] < low[k] ? c[k] : low[k];
              high[k] = c[k] > high[k] ? c[k] : high[k];
            }
          }
          for (int k = 0; k < 3; ++k)
            if (low[k] <= high[k]) {
              minInto(&s.low[k], low[k]);
              maxInto(&s.high[k], high[k]);
            }
          team.sync();
          for (int k = team.rank(); k < 3; k += team.size()) {
            minInto(&findings->low[k], s.low[k]);
            maxInto(&findings->high[k], s.high[k]);
          }
          team.sync();
        });
  }

  void refuseTets() const {
    if (found_.errors & kBadIndex)
      throw Error(Status::Invalid, "", "a tet refers to a point that is not there");
    if (found_.errors & kLongTet)
      throw Error(Status::Limit, "", "a tet is longer than 2^20 voxels", "use larger voxels");
  }

  void chooseSpace() {
    if (found_.errors & kBadPoint)
      throw Error(Status::Limit, "",
                  "a point is not finite, or the mesh leaves 32-bit index space at this voxel size",
                  "repair the mesh or use larger voxels");
    for (int k = 0; k < 3; ++k) {
      i64 low = found_.low[k], high = found_.high[k];
      if (low > high)
        low = high = 0;
      // A crossing counts from at most one voxel above the box.
      const i64 first = (low >> kLatticeBits) >> 3, last = ((high >> kLatticeBits) + 1) >> 3;
      space_.base[k] = first >> 9 << 9;
      const u64 leaves = static_cast<u64>(last - space_.base[k] + 1);
      space_.bits[k] = 9;
      while (u64(1) << space_.bits[k] < leaves)
        ++space_.bits[k];
      nodeMin_[k] = static_cast<u64>(first - space_.base[k]) >> 4;
      nodeMax_[k] = static_cast<u64>(last - space_.base[k]) >> 4;
    }
    if (space_.total() > 63)
      throw Error(Status::Limit, "", "the grid is too wide for the device",
                  "use larger voxels or --device cpu");
  }

  double denseLeaves() const {
    double leaves = 4096;
    for (int k = 0; k < 3; ++k)
      leaves *= static_cast<double>(nodeMax_[k] - nodeMin_[k] + 1);
    return leaves;
  }
  bool denseFits() const { return denseLeaves() <= double(u64(1) << 24); }
  // Matching a tet's faces costs about as much as rasterizing it where it is a few voxels wide.
  bool denseIsFaster() const {
    return denseFits() && denseLeaves() * 512 < 16.0 * static_cast<double>(mesh_.tetCount);
  }

  void checkJob() const {
    for (int k = 0; k < 3; ++k)
      if (!(job_.voxelSize[k] > 0) || !std::isfinite(job_.voxelSize[k]) ||
          !std::isfinite(job_.origin[k]))
        throw Error(Status::Usage, "", "voxel size and origin must be finite, the size positive");
    if (job_.name.size() > 255)
      throw Error(Status::Usage, "", "the grid's name is longer than 255 bytes");
    if (mesh_.tetCount >= u64(1) << 32 || mesh_.pointCount >= u64(1) << 32)
      throw Error(Status::Limit, "", "the mesh has 2^32 tets or points or more");
  }

  static void checkCount(u64 count) {
    if (count >= kNoTet)
      throw Error(Status::Limit, "", "the grid has 2^32 leaves or more", "use larger voxels");
  }

  static Kind kindOf(GridType type) {
    return type == GridType::Mask   ? Kind::Mask
           : type == GridType::Bool ? Kind::Bool
           : type == GridType::Fog  ? Kind::Float
                                    : Kind::Int32;
  }
  static GridValues valuesOf(GridType type) {
    if (type == GridType::Fog)
      return {0x3F800000u, 0}; // 1 and 0 as floats
    return type == GridType::Owner ? GridValues{0, 0xFFFFFFFFu} : GridValues{1, 0};
  }

  GridHeader makeHeader(Kind kind) const {
    GridHeader h{};
    h.magic = 0x304244566F6E614Eull;       // "NanoVDB0"
    h.version = 32u << 21 | 4u << 10 | 2u; // 32.4.2, the layout to 32.9
    const bool values = kind == Kind::Float || kind == Kind::Int32;
    h.flags = 1u << 5 | (values ? 1u << 2 | 1u << 3 | 1u << 4 : 0u);
    h.gridCount = 1;
    std::memcpy(h.name, job_.name.data(), job_.name.size());
    for (int k = 0; k < 3; ++k) {
      h.mapMatrix[4 * k] = job_.voxelSize[k];
      h.mapInverse[4 * k] = 1.0 / job_.voxelSize[k];
      h.mapTranslation[k] = job_.origin[k];
      h.mapMatrixF[4 * k] = static_cast<float>(h.mapMatrix[4 * k]);
      h.mapInverseF[4 * k] = static_cast<float>(h.mapInverse[4 * k]);
      h.mapTranslationF[k] = static_cast<float>(job_.origin[k]);
      h.voxelSize[k] = job_.voxelSize[k];
    }
    h.taper = 1;
    h.taperF = 1;
    h.gridClass = job_.type == GridType::Fog ? 2 : job_.type == GridType::Mask ? 6 : 0;
    h.gridType = static_cast<u32>(kind);
    for (int k = 0; k < 3; ++k) { // an empty box
      h.worldBox[k] = 1.7976931348623157e308;
      h.worldBox[3 + k] = -1.7976931348623157e308;
    }
    return h;
  }

private:
  Backend& b_;
  const MeshView& mesh_;
  const Job& job_;
  KeySpace space_{};
  u64 nodeMin_[3] = {0, 0, 0}, nodeMax_[3] = {0, 0, 0};
  LatticePoint* points_ = nullptr;
  std::int8_t* signs_ = nullptr;
  u32* errors_ = nullptr;
  Findings* findings_ = nullptr; // the backend's
  Findings found_{};
};

} // namespace tetvdb::nano
