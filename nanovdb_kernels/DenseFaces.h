// SPDX-License-Identifier: Apache-2.0
//
// Leaf masks from the faces of a closed soup by a dense array of signed crossings, one number a
// voxel: no sorting, for small grids. What each crossing is FaceColumns.h decides.
#pragma once

#include "DenseTets.h"
#include "FaceColumns.h"
#include "SoupFaces.h"
#include "tetvdb/geometry/FillRule.h"

namespace tetvdb::nano {

/// The leaves whose voxels have a number, from the first voxel of the DenseBox on.
struct CrossingBox {
  u64 first[3], size[3]; ///< leaves
  i32* sum;              ///< [z][x][y], so that columns beside each other are read together
  TETVDB_HD u64 voxels() const { return size[0] * size[1] * size[2] * 512; }
};

/// Place for a face: memory that threads share may not have a constructor.
struct FacePlace {
  alignas(CrossedFace) u8 bytes[sizeof(CrossedFace)];
  TETVDB_HD CrossedFace& face() { return *reinterpret_cast<CrossedFace*>(bytes); }
};

struct DenseFacesShared {
  static constexpr int kThreads = 32, kOccupancy = 20;
  FacePlace place[32];
  u32 offset[32], spare[32]; // columns before each face
};

struct ManyFaceColumnsShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  FacePlace place;
};

template <typename Backend>
class DenseFaces {
public:
  /// `first`, `size`: the leaves that crossings lie in, counted from the first of `box`.
  DenseFaces(Backend& backend, const DenseBox& box, const u64 (&first)[3], const u64 (&size)[3],
             const LatticePoint* points, u64 pointCount, const u32* triangles, u64 triangleCount)
      : b_(backend), box_(box), points_(points), triangles_(triangles), pointCount_(pointCount),
        triangleCount_(triangleCount) {
    for (int k = 0; k < 3; ++k) {
      crossings_.first[k] = first[k];
      crossings_.size[k] = size[k];
    }
  }

  /// Clears masks and crossings.
  void begin() {
    const u64 words = box_.nodes() * 4096 * 8;
    box_.mask = b_.template temp<u64>(words);
    b_.zero(box_.mask, words * sizeof(u64));
    const u64 voxels = crossings_.voxels();
    // With the length of the list of faces of many columns.
    crossings_.sum = b_.template temp<i32>(voxels + 1);
    b_.zero(crossings_.sum, (voxels + 1) * sizeof(i32));
    many_ = b_.template temp<u32>(triangleCount_);
  }

  /// A team takes some triangles: a member prepares one, then all share the columns. Indices
  /// without a point and triangles that are too long are passed over.
  void add(u32* errors) {
    const DenseBox box = box_;
    const CrossingBox crossings = crossings_;
    const LatticePoint* points = points_;
    const u32* triangles = triangles_;
    const u64 pointCount = pointCount_, end = triangleCount_;
    u32* many = many_;
    i32* manyCount = crossings_.sum + crossings_.voxels();
    // Enough teams for all multiprocessors first.
    const u64 perTeam = end < 400000 ? 8 : 32;
    b_.template forTeams<DenseFacesShared>(
        (end + perTeam - 1) / perTeam, 32,
        TETVDB_KERNEL(const Team& team, u64 part, DenseFacesShared& s) {
          const u64 first = part * perTeam;
          for (int k = team.rank(); k < 32; k += team.size()) {
            const u64 t = first + static_cast<u64>(k);
            u32 columns = 0;
            if (static_cast<u64>(k) < perTeam && t < end &&
                checkTriangle(points, pointCount, triangles + 3 * t, errors)) {
              s.place[k].face() = faceOf(points, triangles, t);
              columns = columnsOf(s.place[k].face());
              if (columns > kManyColumns) {
                many[addTo(manyCount, 1)] = static_cast<u32>(t);
                columns = 0;
              }
            }
            s.offset[k] = columns;
          }
          team.sync();
          const u32 total = sumsBefore(team, s.offset, s.spare, 32);
          for (u32 i = static_cast<u32>(team.rank()); i < total;
               i += static_cast<u32>(team.size())) {
            u32 k = 0;
            for (u32 step = 16; step != 0; step >>= 1)
              if (s.offset[k + step] <= i)
                k += step;
            addColumn(box, crossings, s.place[k].face(), i - s.offset[k]);
          }
          team.sync();
        });
  }

  /// Faces of many columns: all teams share each.
  void addMany() {
    const DenseBox box = box_;
    const CrossingBox crossings = crossings_;
    const LatticePoint* points = points_;
    const u32 *triangles = triangles_, *many = many_;
    const i32* manyCount = crossings_.sum + crossings_.voxels();
    constexpr u64 kTeams = 512;
    b_.template forTeams<ManyFaceColumnsShared>(
        kTeams, 256, TETVDB_KERNEL(const Team& team, u64 which, ManyFaceColumnsShared& s) {
          const u64 count = static_cast<u64>(*manyCount);
          for (u64 i = 0; i < count; ++i) {
            team.sync();
            if (team.rank() == 0)
              s.place.face() = faceOf(points, triangles, many[i]);
            team.sync();
            const u64 columns = columnsOf(s.place.face());
            // Another team begins with each face.
            const u64 place = (which + i * 97) % kTeams;
            for (u64 chunk = place * 256; chunk < columns; chunk += kTeams * 256)
              for (u64 c = chunk + static_cast<u64>(team.rank()); c < columns && c < chunk + 256;
                   c += static_cast<u64>(team.size()))
                addColumn(box, crossings, s.place.face(), static_cast<u32>(c));
          }
        });
  }

  /// Adds the crossings up along z and sets the voxels that are inside; raises kNotClosed.
  void sum(FillRule rule, u32* errors) {
    const DenseBox box = box_;
    const CrossingBox crossings = crossings_;
    b_.forEach(
        crossings.size[0] * crossings.size[1] * 64, TETVDB_KERNEL(u64 column) {
          const u64 height = crossings.size[1] * 8, area = crossings.size[0] * 8 * height;
          const u64 x = crossings.first[0] * 8 + column / height,
                    y = crossings.first[1] * 8 + column % height;
          const i32* sums = crossings.sum + column;
          i32 winding = 0;
          for (u64 leaf = 0; leaf < crossings.size[2]; ++leaf) {
            u32 run = 0;
            for (int z = 0; z < 8; ++z) {
              winding += sums[static_cast<u64>(z) * area];
              run |= u32(isInside(winding, rule)) << z;
            }
            sums += 8 * area;
            if (run != 0) {
              const u64 at = leafOf(box, x, y, crossings.first[2] + leaf);
              reinterpret_cast<u8*>(box.mask)[at * 64 + (x & 7) * 8 + (y & 7)] =
                  static_cast<u8>(run);
            }
          }
          if (isInside(winding, rule == FillRule::Odd ? rule : FillRule::NonZero))
            orInto(errors, u32(kNotClosed));
        });
  }

  const DenseBox& box() const { return box_; }

  // Public for nvcc alone, as in LevelBuilder.

  TETVDB_HD static CrossedFace faceOf(const LatticePoint* points, const u32* triangles, u64 t) {
    const u32* id = triangles + 3 * t;
    return CrossedFace(points[id[0]], points[id[1]], points[id[2]], 1);
  }
  TETVDB_HD static u32 columnsOf(const CrossedFace& f) {
    return f.crosses == 0
               ? 0
               : static_cast<u32>(f.xMax - f.xMin + 1) * static_cast<u32>(f.yMax - f.yMin + 1);
  }
  /// In DenseBox::mask; `z`: in leaves, x and y in voxels.
  TETVDB_HD static u64 leafOf(const DenseBox& box, u64 x, u64 y, u64 z) {
    const u64 node = ((x >> 7) * box.size[1] + (y >> 7)) * box.size[2] + (z >> 4);
    return node << 12 | ((x >> 3) & 15) << 8 | ((y >> 3) & 15) << 4 | (z & 15);
  }

  TETVDB_HD static void addColumn(const DenseBox& box, const CrossingBox& crossings,
                                  const CrossedFace& f, u32 column) {
    const u32 rows = static_cast<u32>(f.yMax - f.yMin + 1);
    const i64 x = i64(f.xMin) + column / rows, y = i64(f.yMin) + column % rows;
    if (!crossesColumn(f, x, y))
      return;
    // From the face's own first voxel: then its tolerance holds however high the box is.
    const i64 z = f.zMin + crossingFrom(f, x, y, f.zMin, f.zMax - f.zMin + 1);
    const auto from = [&](i64 voxel, int k) {
      return static_cast<u64>(voxel - box.voxel[k]) - crossings.first[k] * 8;
    };
    const u64 height = crossings.size[1] * 8, area = crossings.size[0] * 8 * height;
    addTo(&crossings.sum[from(z, 2) * area + from(x, 0) * height + from(y, 1)], f.weight);
  }

private:
  Backend& b_;
  DenseBox box_;
  CrossingBox crossings_{};
  const LatticePoint* points_;
  const u32* triangles_;
  u64 pointCount_, triangleCount_;
  u32* many_ = nullptr;
};

} // namespace tetvdb::nano
