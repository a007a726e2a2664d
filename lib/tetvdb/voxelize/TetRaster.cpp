// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TetRaster.h"

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/ColumnBounds.h"
#include "tetvdb/geometry/Ownership.h"
#include "tetvdb/geometry/TetFaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Vectors never cross a function that is not inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace tetvdb {
namespace {

// Up to this extent (32 voxels) cross products of edges, and the sum of three, are exact in double.
constexpr double kExactExtent = static_cast<double>(std::int64_t(1) << 25);
// Adding and subtracting 1.5 * 2^52 rounds to the nearest integer.
constexpr double kRound = 6755399441055744.0;

constexpr int kLanes = 4;
typedef double Doubles __attribute__((vector_size(kLanes * sizeof(double))));
typedef std::int64_t Longs __attribute__((vector_size(kLanes * sizeof(std::int64_t))));
typedef std::int32_t Ints __attribute__((vector_size(kLanes * sizeof(std::int32_t))));

// All bits of a double but its sign.
constexpr std::int64_t kAbsolute = 0x7FFFFFFFFFFFFFFF;

// A face plane as a bound on z in each column: below it the voxels are out (a lower bound), or from
// it on (an upper one).
struct Plane {
  double x, y, z;        // a vertex on it, voxels
  double slopeX, slopeY; // dz/dx, dz/dy
  double tolerance;      // voxels; bound on the error of z at the tet's columns
  int face;              // the vertex opposite
};

struct Tet {
  LatticePoint v[4];
  int sign = 0; // orientation
  Plane lower[3], upper[3];
  int lowers = 0, uppers = 0;
  int vertical[3] = {0, 0, 0}; // faces parallel to z
  int verticals = 0;
};

// A vertex of a face.
const LatticePoint& cornerOf(const Tet& t, int face) {
  return t.v[inwardCorner(face, 0)];
}

// Inward normal, exact.
ExactVector exactNormal(const Tet& t, int face) {
  const ExactVector n =
      triangleNormal(cornerOf(t, face), t.v[inwardCorner(face, 1)], t.v[inwardCorner(face, 2)]);
  return t.sign > 0 ? n : ExactVector{-n.x, -n.y, -n.z};
}

// The exact planes of a tet's faces, each computed when it is first needed: where cells are aligned
// with voxels, whole faces pass through voxel centres.
class ExactPlanes {
public:
  explicit ExactPlanes(const Tet& t) : t_(t) {}

  // First voxel of column (x, y) beyond the plane.
  TETVDB_APART std::int64_t bound(const Plane& plane, std::int64_t x, std::int64_t y,
                                  std::int64_t zNear) {
    return exactBound(normal(plane.face), cornerOf(t_, plane.face), plane.tolerance >= kSteep, x, y,
                      zNear);
  }

  // Narrows [yBegin, yEnd) to the rows of column x that are inside a face parallel to z.
  TETVDB_APART void narrow(int face, std::int64_t x, std::int64_t& yBegin, std::int64_t& yEnd) {
    const ExactVector& n = normal(face);
    const LatticePoint& o = cornerOf(t_, face);
    const Int128 ex = n.x * unitsFrom(o.x, x);
    const bool tieIn = tieSign(n.x, n.y, n.z) > 0;
    if (n.y == 0) {
      if (!(ex > 0 || (ex == 0 && tieIn)))
        yEnd = yBegin;
      return;
    }
    const std::int64_t bound = firstBeyond(n.y, ex, tieIn, o.y, floorVoxel(o.y));
    if (n.y > 0)
      yBegin = std::max(yBegin, bound);
    else
      yEnd = std::min(yEnd, bound);
  }

private:
  const ExactVector& normal(int face) {
    if ((known_ >> face & 1) == 0) {
      normals_[face] = exactNormal(t_, face);
      known_ |= 1u << face;
    }
    return normals_[face];
  }

  const Tet& t_;
  unsigned known_ = 0;
  ExactVector normals_[4];
};

// Reads the tet and finds its planes. False for a flat one.
TETVDB_INLINE bool prepare(const SnappedMesh& mesh, std::size_t index, Tet& t) {
  const std::uint32_t* id = mesh.tets + 4 * index;
  for (int i = 0; i < 4; ++i)
    t.v[i] = mesh.points[id[i]];
  const LatticeBox box = boxOf(t.v[0], t.v[1], t.v[2], t.v[3]);
  const double ex = box.high.x - box.low.x, ey = box.high.y - box.low.y,
               ez = box.high.z - box.low.z;
  const double size = box.extent();

  double n[4][3]; // inward normals of a positive tet
  if (size <= kExactExtent) {
    const double ux = t.v[1].x - t.v[0].x, uy = t.v[1].y - t.v[0].y, uz = t.v[1].z - t.v[0].z;
    const double vx = t.v[2].x - t.v[0].x, vy = t.v[2].y - t.v[0].y, vz = t.v[2].z - t.v[0].z;
    const double wx = t.v[3].x - t.v[0].x, wy = t.v[3].y - t.v[0].y, wz = t.v[3].z - t.v[0].z;
    n[1][0] = vy * wz - vz * wy;
    n[1][1] = vz * wx - vx * wz;
    n[1][2] = vx * wy - vy * wx;
    n[2][0] = wy * uz - wz * uy;
    n[2][1] = wz * ux - wx * uz;
    n[2][2] = wx * uy - wy * ux;
    n[3][0] = uy * vz - uz * vy;
    n[3][1] = uz * vx - ux * vz;
    n[3][2] = ux * vy - uy * vx;
    for (int k = 0; k < 3; ++k)
      n[0][k] = -(n[1][k] + n[2][k] + n[3][k]);
    const double det = ux * n[1][0] + uy * n[1][1] + uz * n[1][2];
    // The products and sums round five times at most, each below size^3 2^-50.
    const double bound = std::ldexp(1.0, -46) * size * size * size;
    if (det > bound)
      t.sign = 1;
    else if (det < -bound)
      t.sign = -1;
    else
      t.sign = signOf(orientation(t.v[0], t.v[1], t.v[2], t.v[3]));
    if (t.sign == 0)
      return false;
  } else {
    t.sign = tetOrientation(t.v[0], t.v[1], t.v[2], t.v[3]);
    if (t.sign == 0)
      return false;
    for (int i = 0; i < 4; ++i) {
      const ExactVector e =
          triangleNormal(cornerOf(t, i), t.v[inwardCorner(i, 1)], t.v[inwardCorner(i, 2)]);
      n[i][0] = static_cast<double>(e.x);
      n[i][1] = static_cast<double>(e.y);
      n[i][2] = static_cast<double>(e.z);
    }
  }

  const double columnsX = ex * kVoxelsPerUnit + 1, columnsY = ey * kVoxelsPerUnit + 1,
               height = ez * kVoxelsPerUnit + 256;
  t.lowers = t.uppers = t.verticals = 0;
  for (int i = 0; i < 4; ++i) {
    const double nz = t.sign > 0 ? n[i][2] : -n[i][2];
    if (nz == 0) {
      // A tet has at most three faces parallel to z.
      t.vertical[t.verticals++] = i;
      continue;
    }
    Plane& p = nz > 0 ? t.lower[t.lowers++] : t.upper[t.uppers++];
    const LatticePoint& o = cornerOf(t, i);
    p.face = i;
    p.x = o.x * kVoxelsPerUnit;
    p.y = o.y * kVoxelsPerUnit;
    p.z = o.z * kVoxelsPerUnit;
    p.slopeX = -n[i][0] / n[i][2];
    p.slopeY = -n[i][1] / n[i][2];
    // As in FaceRaster: three roundings a slope, one more a product and sum, doubled.
    p.tolerance = (std::abs(p.slopeX) * columnsX + std::abs(p.slopeY) * columnsY + height) *
                  (1.0 / static_cast<double>(std::int64_t(1) << 49));
  }
  return true;
}

TETVDB_INLINE Doubles select(Longs mask, Doubles a, Doubles b) {
  return reinterpret_cast<Doubles>((reinterpret_cast<Longs>(a) & mask) |
                                   (reinterpret_cast<Longs>(b) & ~mask));
}

// Bounds of one row of columns, and which lanes they leave in doubt.
TETVDB_INLINE void bound(const Plane& p, double rowBase, const Doubles& y, Doubles& z,
                         Longs& doubt) {
  const Doubles crossing = rowBase + p.slopeY * (y - p.y);
  const Doubles nearest = (crossing + kRound) - kRound;
  const Doubles off = crossing - nearest;
  const Doubles size = reinterpret_cast<Doubles>(reinterpret_cast<Longs>(off) & kAbsolute);
  // A comparison that holds has all bits set.
  doubt |= size <= p.tolerance;
  const Doubles one = {1, 1, 1, 1};
  z = nearest + reinterpret_cast<Doubles>((off > 0.0) & reinterpret_cast<Longs>(one));
}

// Calls emit(row, lo, hi) with lo < hi for every run of voxels of the slab that the tet owns.
template <typename Emit>
TETVDB_INLINE void rasterize(const Tet& t, const TetBox& box, const SlabOrigin& slab,
                             const Emit& emit) {
  const std::int64_t xBegin = std::max(box.min[0], slab.x);
  const std::int64_t xEnd = std::min(box.max[0], slab.x + kLeafSize - 1) + 1;
  const std::int64_t yFirst = std::max(box.min[1], slab.y);
  const std::int64_t yLast = std::min(box.max[1], slab.y + kNodeSize - 1) + 1;
  const std::int64_t zFirst = std::max(box.min[2] - slab.z, std::int64_t(0));
  const std::int64_t zLast = std::min(box.max[2] - slab.z, std::int64_t(kNodeSize - 1)) + 1;
  if (zFirst >= zLast)
    return;
  const auto zBegin = static_cast<double>(zFirst), zEnd = static_cast<double>(zLast);
  const auto z0 = static_cast<double>(slab.z);
  const Doubles lanes = {0, 1, 2, 3};
  ExactPlanes planes(t);

  for (std::int64_t x = xBegin; x < xEnd; ++x) {
    std::int64_t yBegin = yFirst, yEnd = yLast;
    for (int i = 0; i < t.verticals; ++i)
      planes.narrow(t.vertical[i], x, yBegin, yEnd);
    double lowerBase[3], upperBase[3];
    const auto xd = static_cast<double>(x);
    for (int i = 0; i < t.lowers; ++i)
      lowerBase[i] = (t.lower[i].z - z0) + t.lower[i].slopeX * (xd - t.lower[i].x);
    for (int i = 0; i < t.uppers; ++i)
      upperBase[i] = (t.upper[i].z - z0) + t.upper[i].slopeX * (xd - t.upper[i].x);
    const int rowBase = static_cast<int>(x - slab.x) * kNodeSize;

    for (std::int64_t y = yBegin; y < yEnd; y += kLanes) {
      const Doubles yd = lanes + static_cast<double>(y);
      Doubles lo = {zBegin, zBegin, zBegin, zBegin}, hi = {zEnd, zEnd, zEnd, zEnd}, z;
      Longs doubt = {0, 0, 0, 0};
      for (int i = 0; i < t.lowers; ++i) {
        bound(t.lower[i], lowerBase[i], yd, z, doubt);
        lo = select(z > lo, z, lo);
      }
      for (int i = 0; i < t.uppers; ++i) {
        bound(t.upper[i], upperBase[i], yd, z, doubt);
        hi = select(z < hi, z, hi);
      }
      // What is outside the clipped range anyway must not overflow the conversion.
      lo = select(lo < zEnd, lo, Doubles{zEnd, zEnd, zEnd, zEnd});
      hi = select(hi > zBegin, hi, Doubles{zBegin, zBegin, zBegin, zBegin});
      Ints lows = __builtin_convertvector(lo, Ints), highs = __builtin_convertvector(hi, Ints);
      const int count = static_cast<int>(std::min<std::int64_t>(kLanes, yEnd - y));
      if ((doubt[0] | doubt[1] | doubt[2] | doubt[3]) != 0) {
        for (int k = 0; k < count; ++k) {
          if (doubt[k] == 0)
            continue;
          std::int64_t low = zFirst, high = zLast;
          const auto exact = [&](const Plane& p, double base) {
            const double crossing = base + p.slopeY * (static_cast<double>(y + k) - p.y);
            const double nearest = std::nearbyint(crossing);
            if (p.tolerance < kSteep) {
              if (std::abs(crossing - nearest) > p.tolerance || std::abs(crossing) > 1e6)
                return static_cast<std::int64_t>(
                    std::min(std::max(std::ceil(crossing), -1.0), 1.0 + kNodeSize));
              return planes.bound(p, x, y + k, slab.z + static_cast<std::int64_t>(nearest)) -
                     slab.z;
            }
            return planes.bound(p, x, y + k, slab.z) - slab.z;
          };
          for (int i = 0; i < t.lowers; ++i)
            low = std::max(low, exact(t.lower[i], lowerBase[i]));
          for (int i = 0; i < t.uppers; ++i)
            high = std::min(high, exact(t.upper[i], upperBase[i]));
          lows[k] = static_cast<std::int32_t>(std::min(low, zLast));
          highs[k] = static_cast<std::int32_t>(std::max(high, zFirst));
        }
      }
      for (int k = 0; k < count; ++k)
        if (lows[k] < highs[k])
          emit(rowBase + static_cast<int>(y - slab.y) + k, lows[k], highs[k]);
    }
  }
}

TETVDB_INLINE TetBox boxOf(const Tet& t) {
  return voxelBox(boxOf(t.v[0], t.v[1], t.v[2], t.v[3]));
}

TETVDB_INLINE void countOrientation(const Tet& t, const TetBox& box, const SlabOrigin& slab,
                                    OrientationCounts& counts) {
  const bool first = box.min[0] >= slab.x && box.min[0] < slab.x + kLeafSize &&
                     box.min[1] >= slab.y && box.min[1] < slab.y + kNodeSize &&
                     box.min[2] >= slab.z && box.min[2] < slab.z + kNodeSize;
  if (first && !box.spansNodes())
    counts.count(t.sign);
}

} // namespace

TetBox voxelBox(const SnappedMesh& mesh, std::size_t tet) {
  Tet t;
  for (std::size_t i = 0; i < 4; ++i)
    t.v[i] = mesh.points[mesh.tets[4 * tet + i]];
  return boxOf(t);
}

TETVDB_MULTIVERSION void rasterizeTets(const SnappedMesh& mesh, const std::uint32_t* tets,
                                       std::size_t count, const SlabOrigin& slab, SlabBits& bits,
                                       OrientationCounts& counts) {
  Tet t;
  for (std::size_t i = 0; i < count; ++i) {
    const bool solid = prepare(mesh, tets[i], t);
    const TetBox box = boxOf(t);
    countOrientation(t, box, slab, counts);
    if (!solid)
      continue;
    rasterize(t, box, slab, [&](int row, int lo, int hi) { setRun(bits.rows[row], lo, hi); });
  }
}

TETVDB_MULTIVERSION void rasterizeOwners(const SnappedMesh& mesh, const std::uint32_t* tets,
                                         std::size_t count, const SlabOrigin& slab, SlabBits& bits,
                                         std::uint32_t* owners, OrientationCounts& counts) {
  Tet t;
  for (std::size_t i = 0; i < count; ++i) {
    const bool solid = prepare(mesh, tets[i], t);
    const TetBox box = boxOf(t);
    countOrientation(t, box, slab, counts);
    if (!solid)
      continue;
    const std::uint32_t id = tets[i];
    rasterize(t, box, slab, [&](int row, int lo, int hi) {
      std::uint64_t run[2] = {0, 0};
      setRun(run, lo, hi);
      std::uint64_t* bit = bits.rows[row];
      std::uint32_t* owner = owners + std::ptrdiff_t(row) * kNodeSize;
      if (((run[0] & bit[0]) | (run[1] & bit[1])) == 0) {
        for (int z = lo; z < hi; ++z)
          owner[z] = id;
      } else {
        for (int z = lo; z < hi; ++z)
          if ((bit[z >> 6] >> (z & 63) & 1) == 0)
            owner[z] = id;
      }
      bit[0] |= run[0];
      bit[1] |= run[1];
    });
  }
}

Cover classifyBox(const SnappedMesh& mesh, std::size_t tet, const TetBox& box) {
  Tet t;
  for (std::size_t i = 0; i < 4; ++i)
    t.v[i] = mesh.points[mesh.tets[4 * tet + i]];
  t.sign = tetOrientation(t.v[0], t.v[1], t.v[2], t.v[3]);
  if (t.sign == 0)
    return Cover::Outside;
  Cover cover = Cover::Inside;
  for (int i = 0; i < 4; ++i) {
    const ExactVector n = exactNormal(t, i);
    const LatticePoint& o = cornerOf(t, i);
    const double normal[3] = {static_cast<double>(n.x), static_cast<double>(n.y),
                              static_cast<double>(n.z)};
    const double origin[3] = {o.x, o.y, o.z};
    double min = 0, max = 0, size = 0;
    for (int k = 0; k < 3; ++k) {
      const double low =
          static_cast<double>(box.min[k]) * static_cast<double>(kUnitsPerVoxel) - origin[k];
      const double high =
          static_cast<double>(box.max[k]) * static_cast<double>(kUnitsPerVoxel) - origin[k];
      min += normal[k] * (normal[k] > 0 ? low : high);
      max += normal[k] * (normal[k] > 0 ? high : low);
      size += std::abs(normal[k]) * (std::abs(low) + std::abs(high));
    }
    const double error = 1e-14 * size;
    if (max < -error)
      return Cover::Outside;
    if (!(min > error))
      cover = Cover::Partial;
  }
  return cover;
}

} // namespace tetvdb
