// SPDX-License-Identifier: Apache-2.0
//
// Triangle meshes made for tests and benchmarks. All are welded and turned outward; what spoils
// them (unwelded, flipped, withFacesFlipped, without, ...) is a function of its own.
#pragma once

#include "Meshes.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace tetvdb::meshes {

inline void addTriangle(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh.triangles.insert(mesh.triangles.end(), {a, b, c});
}

/// The faces of `other` after those of `mesh`; points are not welded.
inline void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const std::uint32_t v : other.triangles)
    mesh.triangles.push_back(first + v);
  mesh.faceCount = mesh.triangleCount();
}

inline TriangleMesh joined(std::initializer_list<TriangleMesh> meshes) {
  TriangleMesh all;
  for (const TriangleMesh& mesh : meshes)
    append(all, mesh);
  return all;
}

/// Points that an integer grid numbers, so that faces share them.
class PointTable {
public:
  using Key = std::array<int, 3>;
  template <typename Position>
  std::uint32_t at(TriangleMesh& mesh, const Key& key, const Position& position) {
    const auto [entry, isNew] =
        numbers_.try_emplace(key, static_cast<std::uint32_t>(mesh.points.size()));
    if (isNew)
      mesh.points.push_back(position(key));
    return entry->second;
  }

private:
  std::map<Key, std::uint32_t> numbers_;
};

/// A box whose sides are n x n squares of two triangles each: 12 n^2 faces.
inline TriangleMesh box(const Vec3d& low = {0, 0, 0}, const Vec3d& high = {1, 1, 1}, int n = 1) {
  TriangleMesh mesh;
  PointTable table;
  const auto position = [&](const PointTable::Key& key) {
    Vec3d p;
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = key[axis] == n ? high[axis]
                               : low[axis] + (high[axis] - low[axis]) * double(key[axis]) / n;
    return p;
  };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::array<std::uint32_t, 4> v;
          for (std::size_t k = 0; k < 4; ++k) {
            PointTable::Key key;
            key[axis] = side * n;
            key[(axis + 1) % 3] = i + (k == 1 || k == 2);
            key[(axis + 2) % 3] = j + (k >= 2);
            v[k] = table.at(mesh, key, position);
          }
          if (side == 0)
            std::swap(v[1], v[3]);
          addTriangle(mesh, v[0], v[1], v[2]);
          addTriangle(mesh, v[0], v[2], v[3]);
        }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// An octahedron whose edges are cut in n, drawn onto the sphere: 8 n^2 faces.
inline TriangleMesh sphere(const Vec3d& center = {0, 0, 0}, double radius = 1, int n = 8) {
  TriangleMesh mesh;
  PointTable table;
  const auto position = [&](const PointTable::Key& key) {
    const double length =
        std::sqrt(double(key[0] * key[0] + key[1] * key[1] + key[2] * key[2])) / radius;
    return Vec3d{center[0] + key[0] / length, center[1] + key[1] / length,
                 center[2] + key[2] / length};
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto number = [&](int i, int j) {
      return table.at(mesh, {sx * (n - i - j), sy * i, sz * j}, position);
    };
    using Step = std::array<int, 2>;
    const auto add = [&](const Step& first, const Step& second, const Step& third) {
      // One by one: compilers differ in the order of arguments, and points are numbered by it.
      const std::uint32_t c = number(third[0], third[1]), b = number(second[0], second[1]),
                          a = number(first[0], first[1]);
      sx* sy* sz > 0 ? addTriangle(mesh, a, b, c) : addTriangle(mesh, a, c, b);
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add({i, j}, {i + 1, j}, {i, j + 1});
        if (i + j + 1 < n)
          add({i + 1, j}, {i + 1, j + 1}, {i, j + 1});
      }
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// Around the z axis: 2 * around * across faces.
inline TriangleMesh torus(double ringRadius = 1, double tubeRadius = 0.4, int around = 24,
                          int across = 12) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double u = 2 * kPi * i / around, v = 2 * kPi * j / across;
      const double r = ringRadius + tubeRadius * std::cos(v);
      mesh.points.push_back({r * std::cos(u), r * std::sin(u), tubeRadius * std::sin(v)});
    }
  const auto number = [&](int i, int j) {
    return static_cast<std::uint32_t>((i % around) * across + j % across);
  };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      addTriangle(mesh, number(i, j), number(i + 1, j), number(i + 1, j + 1));
      addTriangle(mesh, number(i, j), number(i + 1, j + 1), number(i, j + 1));
    }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// n x n squares on [0, 1]^2 at height z, normals up.
inline TriangleMesh sheet(int n = 4, double z = 0) {
  TriangleMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      mesh.points.push_back({double(i) / n, double(j) / n, z});
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (n + 1) + j);
      const auto b = a + static_cast<std::uint32_t>(n + 1);
      addTriangle(mesh, a, b, b + 1);
      addTriangle(mesh, a, b + 1, a + 1);
    }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// A cylinder around z from 0 to `height`. Each lid is a fan around one point, which therefore has
/// `around` neighbours; without lids it is an open tube.
inline TriangleMesh cylinder(double radius = 1, double height = 1, int around = 32,
                             bool lids = true) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < 2; ++k)
      mesh.points.push_back({radius * std::cos(2 * kPi * i / around),
                             radius * std::sin(2 * kPi * i / around), k * height});
  const auto low = static_cast<std::uint32_t>(mesh.points.size());
  if (lids) {
    mesh.points.push_back({0, 0, 0});
    mesh.points.push_back({0, 0, height});
  }
  for (int i = 0; i < around; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i);
    const auto b = static_cast<std::uint32_t>(2 * ((i + 1) % around));
    addTriangle(mesh, a, b, b + 1);
    addTriangle(mesh, a, b + 1, a + 1);
    if (lids) {
      addTriangle(mesh, low, b, a);
      addTriangle(mesh, low + 1, a + 1, b + 1);
    }
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// A strip with half a twist: 2 n faces, not orientable.
inline TriangleMesh moebius(int n = 24, double radius = 1, double width = 0.5) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i)
    for (const double side : {-0.5, 0.5}) {
      const double u = 2 * kPi * i / n, w = side * width;
      const double r = radius + w * std::cos(u / 2);
      mesh.points.push_back({r * std::cos(u), r * std::sin(u), w * std::sin(u / 2)});
    }
  for (int i = 0; i < n; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i), b = a + 1;
    const std::uint32_t c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
    addTriangle(mesh, a, c, d);
    addTriangle(mesh, a, d, b);
  }
  mesh.faceCount = mesh.triangleCount();
  return mesh;
}

/// Each triangle with points of its own, as in an STL.
inline TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh soup;
  for (const std::uint32_t v : mesh.triangles)
    soup.points.push_back(mesh.points[v]);
  soup.triangles.resize(soup.points.size());
  std::iota(soup.triangles.begin(), soup.triangles.end(), 0u);
  soup.faceCount = soup.triangleCount();
  return soup;
}

inline void flipFace(TriangleMesh& mesh, std::size_t face) {
  std::swap(mesh.triangles[3 * face + 1], mesh.triangles[3 * face + 2]);
}

/// Every face reversed.
inline TriangleMesh flipped(TriangleMesh mesh) {
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    flipFace(mesh, face);
  return mesh;
}

/// About that share of the faces reversed, by chance.
inline TriangleMesh withFacesFlipped(TriangleMesh mesh, double share, std::uint64_t seed = 1) {
  Random random(seed);
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    if (random.unit() < share)
      flipFace(mesh, face);
  return mesh;
}

/// Without the faces for which drop(face) is true; points stay.
template <typename Drop>
TriangleMesh without(const TriangleMesh& mesh, const Drop& drop) {
  TriangleMesh rest;
  rest.points = mesh.points;
  for (std::size_t face = 0; face < mesh.triangleCount(); ++face)
    if (!drop(face))
      addTriangle(rest, mesh.triangles[3 * face], mesh.triangles[3 * face + 1],
                  mesh.triangles[3 * face + 2]);
  rest.faceCount = rest.triangleCount();
  return rest;
}

/// Without the faces whose centroid has a larger height along `axis`; points stay.
inline TriangleMesh withoutCap(const TriangleMesh& mesh, const Vec3d& axis, double height) {
  return without(mesh, [&](std::size_t face) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        sum += mesh.points[mesh.triangles[3 * face + k]][i] * axis[i] / 3;
    return sum > height;
  });
}

/// Points moved by position(p).
template <typename Position>
TriangleMesh moved(TriangleMesh mesh, const Position& position) {
  for (Vec3d& p : mesh.points)
    p = position(p);
  return mesh;
}

/// Faces in another order, each beginning at another of its corners.
inline TriangleMesh shuffledFaces(const TriangleMesh& mesh, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<std::size_t> order(mesh.triangleCount());
  std::iota(order.begin(), order.end(), std::size_t(0));
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[random.below(i)]);
  TriangleMesh result = mesh;
  result.triangles.clear();
  for (const std::size_t face : order) {
    const std::size_t turn = random.below(3);
    for (std::size_t k = 0; k < 3; ++k)
      result.triangles.push_back(mesh.triangles[3 * face + (k + turn) % 3]);
  }
  return result;
}

/// Signed volume, by tetrahedra to the origin.
inline double signedVolume(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& a = mesh.points[mesh.triangles[i]];
    const Vec3d& b = mesh.points[mesh.triangles[i + 1]];
    const Vec3d& c = mesh.points[mesh.triangles[i + 2]];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

/// The generalised winding number at `p` by the solid angles of all faces: an oracle.
double windingNumberAt(const TriangleMesh& mesh, const Vec3d& p);

} // namespace tetvdb::meshes
