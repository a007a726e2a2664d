// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/NodeOrder.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tetvdb {
namespace {

constexpr std::size_t kLook = 1000; // cells
constexpr std::uint8_t kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};

using Order = std::array<std::uint8_t, 6>; ///< by edge: the index of its midpoint among the six

std::optional<Order> orderIn(const std::uint32_t* nodes, const std::vector<Vec3d>& points) {
  Order order;
  order.fill(6);
  for (std::uint8_t m = 0; m < 6; ++m) {
    const Vec3d& mid = points[nodes[4 + m]];
    std::size_t nearest = 0;
    double min = 0;
    for (std::size_t e = 0; e < 6; ++e) {
      const Vec3d& a = points[nodes[kEdges[e][0]]];
      const Vec3d& b = points[nodes[kEdges[e][1]]];
      double distance = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double d = mid[k] - (a[k] + b[k]) / 2;
        distance += d * d;
      }
      if (e == 0 || distance < min) {
        nearest = e;
        min = distance;
      }
    }
    if (order[nearest] != 6)
      return {};
    order[nearest] = m;
  }
  return order;
}

std::optional<Order> orderOf(const std::uint32_t* nodes, std::size_t cells,
                             const std::vector<Vec3d>& points) {
  std::optional<Order> found;
  for (std::size_t i = 0; i < std::min(cells, kLook); ++i) {
    const std::optional<Order> own = orderIn(nodes + 10 * i, points);
    if (own && found && *own != *found)
      return {};
    if (own)
      found = own;
  }
  return found;
}

} // namespace

void orderMids(CellMesh& mesh) {
  std::uint32_t* from = mesh.nodes.data();
  std::uint32_t* to = from;
  for (CellRun& run : mesh.runs) {
    const std::size_t each = run.nodesPerCell;
    if (run.type != CellType::Tetra || each != 10) {
      to = std::copy(from, from + each * run.count, to);
      from += each * run.count;
      continue;
    }
    const std::optional<Order> order = orderOf(from, run.count, mesh.points);
    for (std::size_t i = 0; i < run.count; ++i, from += 10) {
      std::array<std::uint32_t, 10> cell{};
      std::copy_n(from, 10, cell.begin());
      to = std::copy_n(cell.begin(), 4, to);
      for (std::size_t e = 0; order && e < 6; ++e)
        *to++ = cell[4 + (*order)[e]];
    }
    run.nodesPerCell = order ? 10 : 4;
  }
  mesh.nodes.resize(static_cast<std::size_t>(to - mesh.nodes.data()));
}

} // namespace tetvdb
