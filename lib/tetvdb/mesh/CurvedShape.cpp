// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/CurvedShape.h"

#include "tetvdb/mesh/CellMesh.h"

namespace tetvdb {
namespace {

using Place = std::array<double, 3>;

constexpr Place midpoint(const Place& a, const Place& b) {
  return {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
}

constexpr std::array<Place, 27> kHexahedron{{
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, // corners
    {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1},  //
    {0, -1, -1},  {1, 0, -1},  {0, 1, -1}, {-1, 0, -1}, // mids of edges: below, above, between
    {0, -1, 1},   {1, 0, 1},   {0, 1, 1},  {-1, 0, 1},  //
    {-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, 0},  //
    {-1, 0, 0},   {1, 0, 0},   {0, -1, 0}, {0, 1, 0},   // of faces
    {0, 0, -1},   {0, 0, 1},   {0, 0, 0},
}};
constexpr std::array<Place, 18> kWedge{{
    {0, 0, -1},
    {1, 0, -1},
    {0, 1, -1},
    {0, 0, 1},
    {1, 0, 1},
    {0, 1, 1},
    {0.5, 0, -1},
    {0.5, 0.5, -1},
    {0, 0.5, -1},
    {0.5, 0, 1},
    {0.5, 0.5, 1},
    {0, 0.5, 1},
    {0, 0, 0},
    {1, 0, 0},
    {0, 1, 0},
    {0.5, 0, 0},
    {0.5, 0.5, 0},
    {0, 0.5, 0},
}};
constexpr Place kTetCorners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr std::uint8_t kTetEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
constexpr Place kPyramidCorners[5] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
constexpr std::uint8_t kPyramidEdges[8][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0},
                                              {0, 4}, {1, 4}, {2, 4}, {3, 4}};

/// A number and its derivatives by the three coordinates.
struct Dual {
  double value = 0;
  std::array<double, 3> by{};

  Dual() = default;
  Dual(double v) : value(v) {} // NOLINT: constants mix with numbers
  static Dual variable(double v, std::size_t axis) {
    Dual x(v);
    x.by[axis] = 1;
    return x;
  }
  friend Dual operator+(const Dual& a, const Dual& b) {
    Dual r(a.value + b.value);
    for (std::size_t k = 0; k < 3; ++k)
      r.by[k] = a.by[k] + b.by[k];
    return r;
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    Dual r(a.value - b.value);
    for (std::size_t k = 0; k < 3; ++k)
      r.by[k] = a.by[k] - b.by[k];
    return r;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r(a.value * b.value);
    for (std::size_t k = 0; k < 3; ++k)
      r.by[k] = a.by[k] * b.value + a.value * b.by[k];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    Dual r(a.value / b.value);
    for (std::size_t k = 0; k < 3; ++k)
      r.by[k] = (a.by[k] - r.value * b.by[k]) / b.value;
    return r;
  }
};

// Lagrange's of degree two, with nodes at -1, 0 and 1.
template <typename T>
T lagrange(double node, const T& x) {
  return node == 0 ? T(1) - x * x : T(0.5) * x * (x + T(node));
}

template <typename T>
void tet(const T& x, const T& y, const T& z, T* out) {
  const T l[4] = {T(1) - x - y - z, x, y, z};
  for (std::size_t i = 0; i < 4; ++i)
    out[i] = l[i] * (T(2) * l[i] - T(1));
  for (std::size_t e = 0; e < 6; ++e)
    out[4 + e] = T(4) * l[kTetEdges[e][0]] * l[kTetEdges[e][1]];
}

template <typename T>
void hexahedron20(const T& x, const T& y, const T& z, T* out) {
  const T at[3] = {x, y, z};
  for (std::size_t i = 0; i < 20; ++i) {
    T product(i < 8 ? 0.125 : 0.25);
    T sum(-2);
    for (std::size_t k = 0; k < 3; ++k) {
      const double node = kHexahedron[i][k];
      product = product * (node == 0 ? T(1) - at[k] * at[k] : T(1) + T(node) * at[k]);
      sum = sum + T(node) * at[k];
    }
    out[i] = i < 8 ? product * sum : product;
  }
}

template <typename T>
void hexahedron27(const T& x, const T& y, const T& z, T* out) {
  for (std::size_t i = 0; i < 27; ++i)
    out[i] = lagrange(kHexahedron[i][0], x) * lagrange(kHexahedron[i][1], y) *
             lagrange(kHexahedron[i][2], z);
}

// Of the triangle's six nodes: corners, mids of 01, 12, 02.
template <typename T>
void triangle(const T& x, const T& y, T* out) {
  const T l[3] = {T(1) - x - y, x, y};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = l[i] * (T(2) * l[i] - T(1));
    out[3 + i] = T(4) * l[i] * l[(i + 1) % 3];
  }
}

template <typename T>
void wedge15(const T& x, const T& y, const T& z, T* out) {
  const T l[3] = {T(1) - x - y, x, y};
  const T between = T(1) - z * z;
  for (std::size_t i = 0; i < 3; ++i) {
    const T corner = T(2) * l[i] - T(1);
    const T edge = T(2) * l[i] * l[(i + 1) % 3];
    out[i] = T(0.5) * l[i] * (corner * (T(1) - z) - between);
    out[3 + i] = T(0.5) * l[i] * (corner * (T(1) + z) - between);
    out[6 + i] = edge * (T(1) - z);
    out[9 + i] = edge * (T(1) + z);
    out[12 + i] = l[i] * between;
  }
}

template <typename T>
void wedge18(const T& x, const T& y, const T& z, T* out) {
  T flat[6];
  triangle(x, y, flat);
  const T below = lagrange(-1, z), between = lagrange(0, z), above = lagrange(1, z);
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = flat[i] * below;
    out[3 + i] = flat[i] * above;
    out[6 + i] = flat[3 + i] * below;
    out[9 + i] = flat[3 + i] * above;
    out[12 + i] = flat[i] * between;
    out[15 + i] = flat[3 + i] * between;
  }
}

// sides[i] is 0 on the face opposite to that of base edge i.
template <typename T>
void pyramid13(const T& x, const T& y, const T& z, T* out) {
  const T below = T(1) - z;
  const T sides[4] = {y + z - x - T(1), z - x - y - T(1), x - y + z - T(1), x + y + z - T(1)};
  const T toCorner[4] = {x, y, T(0) - x, T(0) - y};
  out[4] = T(2) * z * (z - T(0.5));
  for (std::size_t i = 0; i < 4; ++i) {
    const T pair = sides[i] * sides[(i + 1) % 4] / below;
    out[i] = T(0.5) * pair * (toCorner[i] - T(0.5));
    out[5 + i] = T(-0.5) * pair * sides[(i + 2) % 4];
    out[9 + i] = z * pair;
  }
}

// The function of the base's centre, and its share in those of the base's other nodes.
template <typename T>
void pyramid14(const T& x, const T& y, const T& z, T* out) {
  pyramid13(x, y, z, out);
  const T below = T(1) - z;
  const T central = (y + z - x - T(1)) * (z - x - y - T(1)) / below * (x - y + z - T(1)) *
                    (x + y + z - T(1)) / below;
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = out[i] + T(0.25) * central;
    out[5 + i] = out[5 + i] - T(0.5) * central;
  }
  out[13] = central;
}

template <typename T>
void hexahedron8(const T& x, const T& y, const T& z, T* out) {
  const T low[3] = {T(0.5) - T(0.5) * x, T(0.5) - T(0.5) * y, T(0.5) - T(0.5) * z};
  const T high[3] = {T(0.5) + T(0.5) * x, T(0.5) + T(0.5) * y, T(0.5) + T(0.5) * z};
  const T flat[4] = {low[0] * low[1], high[0] * low[1], high[0] * high[1], low[0] * high[1]};
  for (std::size_t i = 0; i < 4; ++i) {
    out[i] = flat[i] * low[2];
    out[4 + i] = flat[i] * high[2];
  }
}

template <typename T>
void wedge6(const T& x, const T& y, const T& z, T* out) {
  const T l[3] = {T(1) - x - y, x, y};
  const T low = T(0.5) - T(0.5) * z, high = T(0.5) + T(0.5) * z;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = l[i] * low;
    out[3 + i] = l[i] * high;
  }
}

// In each section across the axis z, a square of half diagonal 1 - z, bilinear times 1 - z.
template <typename T>
void pyramid5(const T& x, const T& y, const T& z, T* out) {
  const T below = T(1) - z;
  const T sides[4] = {y - x - below, T(0) - x - y - below, x - y - below, x + y - below};
  for (std::size_t i = 0; i < 4; ++i)
    out[i] = T(0.25) * (sides[i] * sides[(i + 1) % 4] / below);
  out[4] = z;
}

template <typename T>
void evaluate(CurvedShape shape, const T& x, const T& y, const T& z, T* out) {
  switch (shape) {
  case CurvedShape::Tet10:
    return tet(x, y, z, out);
  case CurvedShape::Hex20:
    return hexahedron20(x, y, z, out);
  case CurvedShape::Hex27:
    return hexahedron27(x, y, z, out);
  case CurvedShape::Wedge15:
    return wedge15(x, y, z, out);
  case CurvedShape::Wedge18:
    return wedge18(x, y, z, out);
  case CurvedShape::Pyramid13:
    return pyramid13(x, y, z, out);
  case CurvedShape::Pyramid14:
    return pyramid14(x, y, z, out);
  case CurvedShape::Hex8:
    return hexahedron8(x, y, z, out);
  case CurvedShape::Wedge6:
    return wedge6(x, y, z, out);
  case CurvedShape::Pyramid5:
    return pyramid5(x, y, z, out);
  }
}

// Pyramids' functions are quotients that have limits, but no values, at the apex.
Vec3d belowApex(CurvedShape shape, Vec3d at) {
  constexpr double kNearest = 1e-9;
  const bool pyramid = shape == CurvedShape::Pyramid13 || shape == CurvedShape::Pyramid14 ||
                       shape == CurvedShape::Pyramid5;
  if (pyramid && at[2] > 1 - kNearest && at[2] < 1 + kNearest)
    at[2] = 1 - kNearest;
  return at;
}

} // namespace

std::optional<CurvedShape> curvedShape(CellType type, std::size_t nodes) {
  switch (type) {
  case CellType::Tetra:
    return nodes == 10 ? std::optional(CurvedShape::Tet10) : std::nullopt;
  case CellType::Hexahedron:
    return nodes == 20   ? std::optional(CurvedShape::Hex20)
           : nodes == 27 ? std::optional(CurvedShape::Hex27)
                         : std::nullopt;
  case CellType::Wedge:
    return nodes == 15   ? std::optional(CurvedShape::Wedge15)
           : nodes == 18 ? std::optional(CurvedShape::Wedge18)
                         : std::nullopt;
  case CellType::Pyramid:
    return nodes == 13   ? std::optional(CurvedShape::Pyramid13)
           : nodes == 14 ? std::optional(CurvedShape::Pyramid14)
                         : std::nullopt;
  default:
    return {};
  }
}

std::optional<CurvedShape> cornerShape(CellType type) {
  switch (type) {
  case CellType::Voxel:
  case CellType::Hexahedron:
    return CurvedShape::Hex8;
  case CellType::Wedge:
    return CurvedShape::Wedge6;
  case CellType::Pyramid:
    return CurvedShape::Pyramid5;
  default:
    return {};
  }
}

bool isLinear(CurvedShape shape) {
  return shape == CurvedShape::Hex8 || shape == CurvedShape::Wedge6 ||
         shape == CurvedShape::Pyramid5;
}

std::size_t nodeCount(CurvedShape shape) {
  constexpr std::size_t counts[] = {10, 20, 27, 15, 18, 13, 14, 8, 6, 5};
  return counts[static_cast<std::size_t>(shape)];
}

std::size_t placeCount(CurvedShape shape) {
  constexpr std::size_t counts[] = {10, 27, 27, 18, 18, 14, 14, 8, 6, 5};
  return counts[static_cast<std::size_t>(shape)];
}

Vec3d placeOf(CurvedShape shape, std::size_t i) {
  Place place{};
  switch (shape) {
  case CurvedShape::Tet10:
    place = i < 4 ? kTetCorners[i]
                  : midpoint(kTetCorners[kTetEdges[i - 4][0]], kTetCorners[kTetEdges[i - 4][1]]);
    break;
  case CurvedShape::Hex20:
  case CurvedShape::Hex27:
  case CurvedShape::Hex8:
    place = kHexahedron[i];
    break;
  case CurvedShape::Wedge15:
  case CurvedShape::Wedge18:
  case CurvedShape::Wedge6:
    place = kWedge[i];
    break;
  case CurvedShape::Pyramid13:
  case CurvedShape::Pyramid14:
  case CurvedShape::Pyramid5:
    if (i < 13)
      place = i < 5 ? kPyramidCorners[i]
                    : midpoint(kPyramidCorners[kPyramidEdges[i - 5][0]],
                               kPyramidCorners[kPyramidEdges[i - 5][1]]);
    break;
  }
  return {place[0], place[1], place[2]};
}

void shapeFunctions(CurvedShape shape, const Vec3d& where, double* values) {
  const Vec3d at = belowApex(shape, where);
  evaluate<double>(shape, at[0], at[1], at[2], values);
}

void shapeFunctions(CurvedShape shape, const Vec3d& where, double* values,
                    std::array<double, 3>* gradients) {
  const Vec3d at = belowApex(shape, where);
  std::array<Dual, kMaxCurvedNodes> all;
  evaluate<Dual>(shape, Dual::variable(at[0], 0), Dual::variable(at[1], 1),
                 Dual::variable(at[2], 2), all.data());
  for (std::size_t i = 0; i < nodeCount(shape); ++i) {
    values[i] = all[i].value;
    gradients[i] = all[i].by;
  }
}

} // namespace tetvdb
