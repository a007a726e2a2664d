// SPDX-License-Identifier: Apache-2.0
//
// Meshes of quadratic cells, their nodes said by the edges and faces whose middles they are.
#pragma once

#include "tetvdb/mesh/CellMesh.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace tetvdb::meshes {

/// A kind of cell: its corners in a unit cube, and of each further node the corners that it is in
/// the middle of.
struct QuadraticKind {
  std::string name;
  CellType type;
  std::vector<Vec3d> corners;
  std::vector<std::vector<int>> middles;
  std::size_t nodes() const { return corners.size() + middles.size(); }
};

inline std::vector<QuadraticKind> quadraticKinds() {
  using Sets = std::vector<std::vector<int>>;
  const auto with = [](Sets sets, const Sets& more) {
    sets.insert(sets.end(), more.begin(), more.end());
    return sets;
  };
  const std::vector<Vec3d> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Vec3d> wedge{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  const std::vector<Vec3d> pyramid{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}};
  const Sets tetEdges{{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const Sets cubeEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                       {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
  const Sets wedgeEdges{{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}};
  const Sets pyramidEdges{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}};
  const Sets cubeFaces{{0, 3, 4, 7},
                       {1, 2, 5, 6},
                       {0, 1, 4, 5},
                       {2, 3, 6, 7},
                       {0, 1, 2, 3},
                       {4, 5, 6, 7},
                       {0, 1, 2, 3, 4, 5, 6, 7}};
  return {
      {"tet10", CellType::Tetra, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, tetEdges},
      {"hex20", CellType::Hexahedron, cube, cubeEdges},
      {"hex27", CellType::Hexahedron, cube, with(cubeEdges, cubeFaces)},
      {"wedge15", CellType::Wedge, wedge, wedgeEdges},
      {"wedge18", CellType::Wedge, wedge,
       with(wedgeEdges, {{0, 1, 3, 4}, {1, 2, 4, 5}, {0, 2, 3, 5}})},
      {"pyramid13", CellType::Pyramid, pyramid, pyramidEdges},
      {"pyramid14", CellType::Pyramid, pyramid, with(pyramidEdges, {{0, 1, 2, 3}})},
  };
}

/// A mesh that is built cell by cell; nodes at one place before place() are one point.
class QuadraticMesh {
public:
  /// Adds a cell whose corner c lies at `corner(c)`.
  template <typename Corner>
  void add(const QuadraticKind& kind, const Corner& corner) {
    std::vector<Vec3d> at;
    for (const Vec3d& c : kind.corners)
      at.push_back(corner(c));
    for (const Vec3d& p : at)
      mesh_.nodes.push_back(point(p));
    for (const std::vector<int>& set : kind.middles) {
      Vec3d midpoint{0, 0, 0};
      for (const int c : set)
        for (std::size_t k = 0; k < 3; ++k)
          midpoint[k] += at[static_cast<std::size_t>(c)][k] / static_cast<double>(set.size());
      mesh_.nodes.push_back(point(midpoint));
    }
    auto& runs = mesh_.runs;
    if (runs.empty() || runs.back().fileType != kind.name)
      runs.push_back({kind.type, static_cast<std::uint32_t>(kind.nodes()), 0, kind.name, true});
    ++runs.back().count;
  }

  /// The mesh, with every point moved by `place` and the array "f" of f(place) at the points.
  template <typename Place, typename F>
  CellMesh finish(const Place& place, const F& f) const {
    CellMesh mesh = mesh_;
    std::vector<double> values;
    for (Vec3d& p : mesh.points) {
      p = place(p);
      values.push_back(f(p));
    }
    mesh.attributes.push_back({"f", Attribute::On::Points, 1, std::move(values)});
    return mesh;
  }

private:
  std::uint32_t point(const Vec3d& p) {
    std::array<long, 3> key{};
    for (std::size_t k = 0; k < 3; ++k)
      key[k] = std::lround(p[k] * 1e9);
    const auto [at, fresh] = known_.try_emplace(key, static_cast<std::uint32_t>(known_.size()));
    if (fresh)
      mesh_.points.push_back(p);
    return at->second;
  }

  CellMesh mesh_;
  std::map<std::array<long, 3>, std::uint32_t> known_;
};

/// A block of n^3 unit cells of a kind: cubes as they are, or each cut into wedges or pyramids;
/// tets: one corner of each.
inline QuadraticMesh quadraticBlock(const QuadraticKind& kind, int n) {
  QuadraticMesh mesh;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z) {
        const auto shifted = [&](const Vec3d& p) { return Vec3d{x + p[0], y + p[1], z + p[2]}; };
        switch (kind.type) {
        case CellType::Wedge:
          mesh.add(kind, shifted);
          mesh.add(kind, [&](const Vec3d& p) { return shifted({1 - p[0], 1 - p[1], p[2]}); });
          break;
        case CellType::Pyramid: // one on each face, apexes in the middle
          for (std::size_t axis = 0; axis < 3; ++axis)
            for (const bool above : {false, true})
              mesh.add(kind, [&](const Vec3d& p) {
                Vec3d q{};
                q[axis] = above ? 1 - p[2] / 2 : p[2] / 2;
                q[(axis + 1) % 3] = p[0];
                q[(axis + 2) % 3] = p[1];
                return shifted(q);
              });
          break;
        default:
          mesh.add(kind, shifted);
        }
      }
  return mesh;
}

} // namespace tetvdb::meshes
