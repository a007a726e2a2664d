// SPDX-License-Identifier: Apache-2.0
//
// Rasterises tets into a dense array of leaf masks, without sorting: the method for small grids.
// Columns are computed in floats with a bound on their error; where these do not decide,
// TetColumns.h does.
#pragma once

#include "BuildLevels.h"
#include "TetColumns.h"

namespace tetvdb::nano {

/// Lower nodes first .. first + size - 1 of the key space and the masks of their leaves.
struct DenseBox {
  static constexpr u64 kMaxNodes = 16; ///< along an axis: units of the lattice fit 32 bits
  u64 first[3], size[3];
  i64 voxel[3]; ///< the first
  u64* mask;    ///< eight words a leaf; leaves of a node as in its table, nodes x, y, z
  TETVDB_HD u64 nodes() const { return size[0] * size[1] * size[2]; }
};

/// Lattice units from the box's first voxel.
struct alignas(16) DensePoint {
  i32 x, y, z, unused;
};

/// A tet's faces as bounds on z by column, relative to the first voxel of its box; compare
/// TetPlanes.
struct alignas(16) DensePlane {
  float base, slopeX, slopeY;
  float tolerance; // negative for an upper bound; +-1: floats say nothing
};
struct alignas(16) DenseTet {
  DensePlane plane[4]; // of the face opposite to vertex i
  u32 xy, zDepth;      // first voxel from the DenseBox's: x | y << 16; z | voxels along z << 16
  u32 height;          // voxels along y | a bit a face << 16: parallel to z | kNegative, kPlain
  float perHeight;     // 1 / height
};

constexpr u32 kNegative = 1u << 24; // orientation
constexpr u32 kPlain = 1u << 25;    // floats say something of all faces, and none is parallel to z

constexpr u32 kManyColumns = 2048; // tets of more columns are processed by all teams together

/// a b - c d, within 3 u of the result (u = 2^-24; Jeannerod, Louvet and Muller 2013).
TETVDB_HD inline float differenceOfProducts(float a, float b, float c, float d) {
  const float right = c * d;
  const float lost = fmaf(-c, d, right);
  return fmaf(a, b, -right) + lost;
}

TETVDB_HD inline void crossOf(const float (&a)[3], const float (&b)[3], float (&n)[3]) {
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int k = 0; k < 3; ++k) {
    const int i = k == 2 ? 0 : k + 1, j = k == 0 ? 2 : k - 1;
    n[k] = differenceOfProducts(a[i], b[j], a[j], b[i]);
  }
}

// Edges up to 16 voxels long are exact in floats, and components of normals are off by 3 u of
// themselves. Longer edges are off by u, so that normals are off by 3 u more of the products that
// they are made of.
constexpr float kExactExtent = 16;
constexpr float kFloatError = 0x1p-19f; // 32 u

constexpr float kVoxelOfUnit = 0x1p-20f;

/// From a to b, in voxels.
TETVDB_HD inline void edgeOf(const DensePoint& a, const DensePoint& b, float (&edge)[3]) {
  edge[0] = static_cast<float>(b.x - a.x) * kVoxelOfUnit;
  edge[1] = static_cast<float>(b.y - a.y) * kVoxelOfUnit;
  edge[2] = static_cast<float>(b.z - a.z) * kVoxelOfUnit;
}

/// The z component of the normal of face i, exactly: products of 32-bit differences.
TETVDB_HD inline i64 exactNormalZ(const DensePoint (&v)[4], int i) {
  const DensePoint &a = v[inwardCorner(i, 0)], &b = v[inwardCorner(i, 1)],
                   &c = v[inwardCorner(i, 2)];
  return i64(b.x - a.x) * (c.y - a.y) - i64(b.y - a.y) * (c.x - a.x);
}

/// Prepares a tet whose box has voxels; returns its columns, 0 where there are none. `sign`
/// receives the orientation; `exactSign()` is asked for it where floats do not decide. A flat tet
/// has no columns.
template <typename ExactSign>
TETVDB_HD inline u32 prepareDense(const DensePoint (&v)[4], const ExactSign& exactSign, int& sign,
                                  DenseTet& t) {
  float u[3], w[3], q[3];
  edgeOf(v[0], v[1], u);
  edgeOf(v[0], v[2], w);
  edgeOf(v[0], v[3], q);
  const auto lowest = [](i32 a, i32 b, i32 c, i32 d) {
    const i32 e = a < b ? a : b, f = c < d ? c : d;
    return e < f ? e : f;
  };
  const auto highest = [](i32 a, i32 b, i32 c, i32 d) {
    const i32 e = a > b ? a : b, f = c > d ? c : d;
    return e > f ? e : f;
  };
  const i32 low[3] = {lowest(v[0].x, v[1].x, v[2].x, v[3].x),
                      lowest(v[0].y, v[1].y, v[2].y, v[3].y),
                      lowest(v[0].z, v[1].z, v[2].z, v[3].z)};
  const i32 high[3] = {highest(v[0].x, v[1].x, v[2].x, v[3].x),
                       highest(v[0].y, v[1].y, v[2].y, v[3].y),
                       highest(v[0].z, v[1].z, v[2].z, v[3].z)};
  float extent[3];
  for (int k = 0; k < 3; ++k)
    extent[k] = static_cast<float>(high[k] - low[k]) * kVoxelOfUnit;
  const bool wide =
      extent[0] > kExactExtent || extent[1] > kExactExtent || extent[2] > kExactExtent;
  float n[3]; // of the face opposite to vertex 1, inward for a positive tet
  crossOf(w, q, n);
  // Four roundings and those of the normal add up to 7 u of the products' sizes.
  const float det = u[0] * n[0] + u[1] * n[1] + u[2] * n[2];
  float size = fabsf(u[0] * n[0]) + fabsf(u[1] * n[1]) + fabsf(u[2] * n[2]);
  if (wide)
    size += 6 * (extent[0] * extent[1] * extent[2]);
  sign = det > kFloatError * size ? 1 : det < -kFloatError * size ? -1 : exactSign();
  if (sign == 0)
    return 0;
  i32 first[3], count[3];
  bool empty = false;
  for (int k = 0; k < 3; ++k) {
    const u32 up = static_cast<u32>(low[k]) + ((1u << kLatticeBits) - 1);
    first[k] = static_cast<i32>(up >> kLatticeBits);
    count[k] = (high[k] >> kLatticeBits) - first[k] + 1;
    empty = empty || count[k] <= 0;
  }
  if (empty)
    return 0;
  u32 sides = 0, plain = kPlain;
  const float s = sign > 0 ? 1.0f : -1.0f;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    const DensePoint& a = v[i == 0 ? 1 : 0]; // a corner of the face
    const auto from = [&](i32 voxel, i32 unit) {
      return static_cast<float>(static_cast<i32>(static_cast<u32>(voxel) << kLatticeBits) - unit) *
             kVoxelOfUnit;
    };
    const float x = from(first[0], a.x), y = from(first[1], a.y), z = from(first[2], a.z);
    if (i == 0) {
      float e[3], f[3];
      edgeOf(v[1], v[3], e);
      edgeOf(v[1], v[2], f);
      crossOf(e, f, n);
    } else if (i == 1) {
      crossOf(w, q, n);
    } else if (i == 2) {
      crossOf(q, u, n);
    } else {
      crossOf(u, w, n);
    }
    // Products in a component are at most those of the extents.
    const float productsZ = 2 * extent[0] * extent[1];
    DensePlane plane;
    bool upper = false;
    if (wide ? fabsf(n[2]) > kFloatError * productsZ : n[2] != 0) {
      upper = (n[2] > 0) != (sign > 0);
      const float r = reciprocal(n[2]);
      plane.slopeX = -n[0] * r;
      plane.slopeY = -n[1] * r;
      const float along =
          fabsf(plane.slopeX) * (extent[0] + 1) + fabsf(plane.slopeY) * (extent[1] + 1);
      // Slopes are off by 11 u of themselves; base, products and sums of a crossing round to 9 u of
      // what they are made of.
      float error = extent[2] + 1 + along;
      // And by (3 u p + |slope| 3 u p_z) / (3/4 |n_z|) where edges are not exact.
      if (wide)
        error += fabsf(r) * (4 * extent[0] * extent[1] * extent[2] + productsZ * along);
      error *= kFloatError;
      plane.base = plane.slopeX * x + plane.slopeY * y - z;
      plane.tolerance = error < 0.25f ? error : 1.0f; // 1: floats say nothing of this one
    } else {
      const i64 exact = wide ? exactNormalZ(v, i) : 0;
      if (exact == 0) {
        sides |= 1u << (16 + i);
        plane.base = s * (n[0] * x + n[1] * y);
        plane.slopeX = s * n[0];
        plane.slopeY = s * n[1];
        plane.tolerance = fabsf(n[0]) * (extent[0] + 1) + fabsf(n[1]) * (extent[1] + 1);
        if (wide)
          plane.tolerance += 4 * extent[2] * (extent[0] + 1) * (extent[1] + 1);
        plane.tolerance *= kFloatError;
      } else {
        upper = (exact > 0) != (sign > 0);
        plane = {0, 0, 0, 1};
      }
      plain = 0;
    }
    if (plane.tolerance == 1.0f)
      plain = 0;
    if (upper)
      plane.tolerance = -plane.tolerance;
    t.plane[i] = plane;
  }
  t.xy = static_cast<u32>(first[0]) | static_cast<u32>(first[1]) << 16;
  t.zDepth = static_cast<u32>(first[2]) | static_cast<u32>(count[2]) << 16;
  t.height = static_cast<u32>(count[1]) | sides | plain | (sign < 0 ? kNegative : 0u);
  t.perHeight = 1.0f / static_cast<float>(count[1]);
  return static_cast<u32>(count[0]) * static_cast<u32>(count[1]);
}

/// Of a tet that is kPlain: the first and the end of column (dx, dy), counted from the tet's first
/// voxel, by the maximum of the lower and the minimum of the upper bounds; false where floats do
/// not decide.
TETVDB_HD inline bool plainRun(const DenseTet& t, float dx, float dy, int span, int& first,
                               int& end) {
  // Half a voxel outside of the range, and as far as possible from every integer.
  const float below = -0.5f, above = static_cast<float>(span) + 0.5f;
  float lower = below, upper = above, tolerance = 0;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
  for (int i = 0; i < 4; ++i) {
    const DensePlane plane = t.plane[i];
    const float value = multiplyAdd(plane.slopeY, dy, multiplyAdd(plane.slopeX, dx, plane.base));
    if (plane.tolerance > 0)
      lower = fmaxf(lower, value);
    else
      upper = fminf(upper, value);
    tolerance = fmaxf(tolerance, fabsf(plane.tolerance));
  }
  lower = fminf(lower, above);
  upper = fmaxf(upper, below);
  const float nearLower = rintf(lower), nearUpper = rintf(upper);
  first = static_cast<int>(nearLower) + (lower > nearLower ? 1 : 0);
  end = static_cast<int>(nearUpper) + (upper > nearUpper ? 1 : 0);
  first = first > 0 ? first : 0;
  end = end < span ? end : span;
  return fminf(fabsf(lower - nearLower), fabsf(upper - nearUpper)) > tolerance;
}

/// As plainRun(), of any tet and bound by bound, exactly.
TETVDB_HD inline void exactRun(const DenseTet& t, const TetSource& source, const i64 (&voxel)[3],
                               int dx, int dy, int span, int& first, int& end) {
  first = 0;
  end = span;
  const float low = -4.5f, high = static_cast<float>(span) + 4.5f;
  const i64 x = voxel[0] + static_cast<i64>(t.xy & 0xFFFF) + dx,
            y = voxel[1] + static_cast<i64>(t.xy >> 16) + dy,
            bottom = voxel[2] + static_cast<i64>(t.zDepth & 0xFFFF);
  const int sign = (t.height & kNegative) != 0 ? -1 : 1;
  const auto fx = static_cast<float>(dx), fy = static_cast<float>(dy);
  for (int i = 0; i < 4; ++i) {
    const DensePlane plane = t.plane[i];
    const float tolerance = fabsf(plane.tolerance);
    const float value = multiplyAdd(plane.slopeY, fy, multiplyAdd(plane.slopeX, fx, plane.base));
    if ((t.height >> (16 + i) & 1) != 0) {
      bool inside = value > 0;
      if (fabsf(value) <= tolerance)
        inside = exactInside(source, sign, i, x, y);
      if (!inside)
        end = 0;
      continue;
    }
    const float crossing = value < low ? low : value > high ? high : value;
    const float nearest = rintf(crossing);
    int z = static_cast<int>(nearest);
    if (fabsf(crossing - nearest) <= tolerance) {
      const bool steep = tolerance == 1.0f;
      const i64 exact =
          exactBound(source, sign, i, steep, x, y, steep ? bottom : bottom + z) - bottom;
      z = static_cast<int>(exact < -4 ? -4 : exact > span + 4 ? span + 4 : exact);
    } else {
      z += crossing > nearest ? 1 : 0;
    }
    if (plane.tolerance > 0)
      first = z > first ? z : first;
    else
      end = z < end ? z : end;
  }
}

/// Sets voxels z0 + lo .. z0 + hi - 1 of column (x, y), counted from the box's first voxel.
TETVDB_HD inline void setDenseRun(const DenseBox& d, u32 x, u32 y, u32 z0, int lo, int hi) {
  const u32 column =
      ((x >> 7) * static_cast<u32>(d.size[1]) + (y >> 7)) * static_cast<u32>(d.size[2]);
  const u32 inNode = ((x >> 3) & 15) << 8 | ((y >> 3) & 15) << 4;
  const u32 half = (x & 7) * 2 + ((y >> 2) & 1); // of the leaf's sixteen 32-bit words
  const u32 end = z0 + static_cast<u32>(hi);
  for (u32 z = z0 + static_cast<u32>(lo); z < end;) {
    const u32 next = (z | 7) + 1 < end ? (z | 7) + 1 : end;
    const u32 leaf = (column + (z >> 7)) << 12 | inNode | ((z >> 3) & 15);
    const u32 bits = ((1u << (next - z)) - 1) << (z & 7);
    orInto(reinterpret_cast<u32*>(d.mask) + (u64(leaf) * 16 + half), bits << (8 * (y & 3)));
    z = next;
  }
}

struct DenseShared {
  static constexpr int kThreads = 32, kOccupancy = 28;
  DenseTet tet[32];
  u32 offset[32], spare[32]; // columns before each tet
  u32 flipped, flat;
};

struct ManyColumnsShared {
  static constexpr int kThreads = 256, kOccupancy = 16;
  DenseTet tet;
  u32 columns;
};

constexpr u64 kTallies = 32; // places for one count, so that teams do not wait for each other

template <typename Backend>
class DenseRasterizer {
public:
  DenseRasterizer(Backend& backend, const DenseBox& box, const LatticePoint* points, u64 pointCount,
                  const u32* tets, u64 tetCount)
      : b_(backend), box_(box), points_(points), tets_(tets), pointCount_(pointCount),
        tetCount_(tetCount) {}

  /// Clears the masks.
  void begin() {
    const u64 words = box_.nodes() * 4096 * 8;
    // Masks, the length of the list of tets of many columns, counts of flipped and flat tets.
    box_.mask = b_.template temp<u64>(words + 1 + 2 * kTallies);
    b_.zero(box_.mask, (words + 1 + 2 * kTallies) * sizeof(u64));
    manyCount_ = box_.mask + words;
    tallies_ = manyCount_ + 1;
    many_ = b_.template temp<u32>(tetCount_);
    DensePoint* dense = b_.template temp<DensePoint>(pointCount_);
    dense_ = dense;
    const LatticePoint* points = points_;
    const DenseBox box = box_;
    b_.forEach(
        pointCount_, TETVDB_KERNEL(u64 i) {
          const auto from = [](double unit, i64 voxel) {
            return static_cast<i32>(static_cast<i64>(unit) - voxel * kUnitsPerVoxel);
          };
          const LatticePoint p = points[i];
          dense[i] = {from(p.x, box.voxel[0]), from(p.y, box.voxel[1]), from(p.z, box.voxel[2]), 0};
        });
  }

  /// Tets begin .. end - 1. A team takes up to 32 of them: a member prepares one, then all share
  /// the columns.
  void add(u64 begin, u64 end, u32* errors) {
    const DenseBox box = box_;
    const LatticePoint* points = points_;
    const DensePoint* dense = dense_;
    const u32* tets = tets_;
    const u64 pointCount = pointCount_;
    u32* many = many_;
    u64 *manyCount = manyCount_, *tallies = tallies_;
    // Enough teams for all multiprocessors first.
    const u64 perTeam = end - begin < 400000 ? 8 : 32;
    b_.template forTeams<DenseShared>(
        (end - begin + perTeam - 1) / perTeam, 32,
        TETVDB_KERNEL(const Team& team, u64 part, DenseShared& s) {
          if (team.rank() == 0)
            s.flipped = s.flat = 0;
          team.sync();
          const u64 first = begin + part * perTeam;
          for (int k = team.rank(); k < 32; k += team.size()) {
            const u64 t = first + static_cast<u64>(k);
            u32 columns = 0;
            u32 id[4];
            if (static_cast<u64>(k) < perTeam && t < end) {
              if (loadTet(tets, t, pointCount, id)) {
                int sign;
                columns = prepare(points, dense, id, sign, s.tet[k]);
                if (sign < 0)
                  addTo(&s.flipped, 1u);
                else if (sign == 0)
                  addTo(&s.flat, 1u);
                if (columns > kManyColumns) {
                  many[addTo(manyCount, u64(1))] = static_cast<u32>(t);
                  columns = 0;
                }
              } else {
                orInto(errors, u32(kBadIndex));
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
            addColumn(box, s.tet[k], {points, tets + 4 * (first + k)}, i - s.offset[k]);
          }
          if (team.rank() == 0 && (s.flipped | s.flat) != 0) {
            addTo(&tallies[part % kTallies], u64(s.flipped));
            addTo(&tallies[kTallies + part % kTallies], u64(s.flat));
          }
          team.sync();
        });
  }

  /// Tets of many columns: all teams share each tet.
  void addMany() {
    const DenseBox box = box_;
    const LatticePoint* points = points_;
    const DensePoint* dense = dense_;
    const u32 *tets = tets_, *many = many_;
    const u64* manyCount = manyCount_;
    const u64 pointCount = pointCount_;
    constexpr u64 kTeams = 512;
    b_.template forTeams<ManyColumnsShared>(
        kTeams, 256, TETVDB_KERNEL(const Team& team, u64 which, ManyColumnsShared& s) {
          const u64 count = *manyCount;
          for (u64 i = 0; i < count; ++i) {
            const u32 t = many[i];
            team.sync();
            if (team.rank() == 0) {
              u32 id[4];
              int sign;
              loadTet(tets, t, pointCount, id);
              s.columns = prepare(points, dense, id, sign, s.tet);
            }
            team.sync();
            // Another team begins with each tet.
            const u64 place = (which + i * 97) % kTeams;
            for (u64 c = place * 256 + static_cast<u64>(team.rank()); c < s.columns;) {
              addColumn(box, s.tet, {points, tets + 4 * u64(t)}, static_cast<u32>(c));
              const u64 inChunk = c % 256 + static_cast<u64>(team.size());
              c = inChunk < 256 ? c + static_cast<u64>(team.size())
                                : c - c % 256 + kTeams * 256 + inChunk % 256;
            }
          }
        });
  }

  const DenseBox& box() const { return box_; }
  /// kTallies numbers of flipped tets, then of flat ones.
  const u64* tallies() const { return tallies_; }

  // Public only because of nvcc, as in LevelBuilder.

  // False where an index has no point.
  TETVDB_HD static bool loadTet(const u32* tets, u64 t, u64 pointCount, u32 (&id)[4]) {
#if defined(__CUDA_ARCH__)
    const uint4 four = reinterpret_cast<const uint4*>(tets)[t];
    id[0] = four.x;
    id[1] = four.y;
    id[2] = four.z;
    id[3] = four.w;
#else
    for (u64 k = 0; k < 4; ++k)
      id[k] = tets[4 * t + k];
#endif
    return id[0] < pointCount && id[1] < pointCount && id[2] < pointCount && id[3] < pointCount;
  }

  TETVDB_HD static u32 prepare(const LatticePoint* points, const DensePoint* dense,
                               const u32 (&id)[4], int& sign, DenseTet& tet) {
    const DensePoint v[4] = {dense[id[0]], dense[id[1]], dense[id[2]], dense[id[3]]};
    return prepareDense(
        v,
        [&] { return tetOrientation(points[id[0]], points[id[1]], points[id[2]], points[id[3]]); },
        sign, tet);
  }

  TETVDB_HD static void addColumn(const DenseBox& box, const DenseTet& tet, const TetSource& source,
                                  u32 column) {
    const u32 height = tet.height & 0xFFFF;
    // Two roundings of a quotient that is at least 1/2 / height from an integer: they cannot reach
    // it below 2^22 columns, and there are less than 2048^2.
    const auto dx = static_cast<u32>((static_cast<float>(column) + 0.5f) * tet.perHeight);
    const u32 dy = column - dx * height;
    const int span = static_cast<int>(tet.zDepth >> 16);
    int first, end;
    if ((tet.height & kPlain) == 0 ||
        !plainRun(tet, static_cast<float>(dx), static_cast<float>(dy), span, first, end))
      exactRun(tet, source, box.voxel, static_cast<int>(dx), static_cast<int>(dy), span, first,
               end);
    if (first < end)
      setDenseRun(box, (tet.xy & 0xFFFF) + dx, (tet.xy >> 16) + dy, tet.zDepth & 0xFFFF, first,
                  end);
  }

private:
  Backend& b_;
  DenseBox box_;
  const LatticePoint* points_;
  const u32* tets_;
  u64 pointCount_, tetCount_;
  const DensePoint* dense_ = nullptr;
  u32* many_ = nullptr;
  u64 *manyCount_ = nullptr, *tallies_ = nullptr;
};

} // namespace tetvdb::nano
