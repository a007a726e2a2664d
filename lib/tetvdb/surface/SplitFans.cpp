// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SplitFans.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

std::uint32_t next(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

class Splitting {
public:
  Splitting(TriangleMesh& mesh, Progress& progress)
      : mesh_(mesh), partner_(mesh.triangles.size(), kNone) {
    const EdgeTable edges(mesh);
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
      if (edge % 65536 == 0)
        progress.check();
      const EdgeTable::Sides sides = edges.sides(edge);
      const std::uint32_t from = mesh.triangles[sides.first[0]];
      if (sides.size() == 2 && mesh.triangles[sides.first[1]] != from)
        join(sides.first[0], sides.first[1]);
      else
        pairAround(sides);
    }
  }

  void splitPoints();
  void cutSharedEdges();

private:
  struct Leaf {
    double angle; ///< of its face around the edge
    bool closes;  ///< the solid is at smaller angles, else at larger ones
    std::uint32_t side;
  };

  void join(std::uint32_t a, std::uint32_t b) {
    partner_[a] = b;
    partner_[b] = a;
  }

  const Vec3d& corner(std::uint32_t side) const { return mesh_.points[mesh_.triangles[side]]; }

  // A face that runs in the edge's direction has its normal toward larger angles, and so the solid
  // at smaller ones; the other faces have it at larger ones. As with brackets, each face that opens
  // a wedge of the solid is paired with the next that closes one. At equal angles, closing comes
  // first.
  void pairAround(const EdgeTable::Sides& sides) {
    const std::uint32_t first = sides.first[0];
    const std::uint32_t from = mesh_.triangles[first];
    const Vec3d& start = corner(first);
    const Vec3d axis = minus(corner(next(first)), start);
    const Vec3d u = cross(axis, minus(corner(next(next(first))), start));
    const Vec3d v = cross(axis, u);
    const double lengthU = length(u), lengthV = length(v);
    std::vector<Leaf> leaves;
    int balance = 0;
    for (const std::uint32_t side : sides) {
      const Vec3d arm = minus(corner(next(next(side))), start);
      const double x = lengthV > 0 ? -dot(arm, v) / lengthV : 0;
      const double y = lengthU > 0 ? dot(arm, u) / lengthU : 0;
      const bool along = mesh_.triangles[side] == from;
      leaves.push_back({std::atan2(y, x), along, side});
      balance += along ? 1 : -1;
    }
    if (balance != 0)
      throw Error(Status::Invalid, "", "the surface is not closed");
    std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
      if (a.angle != b.angle)
        return a.angle < b.angle;
      return a.closes != b.closes ? a.closes : a.side < b.side;
    });
    std::vector<std::uint32_t> open;
    for (int round = 0; round < 2; ++round)
      for (const Leaf& leaf : leaves) {
        if (partner_[leaf.side] != kNone)
          continue;
        if (!leaf.closes) {
          if (round == 0)
            open.push_back(leaf.side);
        } else if (!open.empty()) {
          join(leaf.side, open.back());
          open.pop_back();
        }
      }
  }

  void cut(std::uint32_t side);

  TriangleMesh& mesh_;
  std::vector<std::uint32_t> partner_; ///< by side: the side with which it shares its edge
  std::vector<char> toCut_;            ///< by side
};

// Merges corners of one point that are connected across paired sides into one point. The first fan
// of a point keeps its number.
void Splitting::splitPoints() {
  std::vector<std::uint32_t>& corners = mesh_.triangles;
  DisjointSets fans(corners.size());
  for (std::uint32_t side = 0; side < corners.size(); ++side) {
    fans.join(side, next(partner_[side]));
    fans.join(next(side), partner_[side]);
  }
  std::vector<char> isUsed(mesh_.points.size(), 0);
  std::vector<std::uint32_t> pointOfFan(corners.size(), kNone);
  for (std::uint32_t corner = 0; corner < corners.size(); ++corner) {
    std::uint32_t& point = pointOfFan[fans.find(corner)];
    if (point == kNone && isUsed[corners[corner]]) {
      point = static_cast<std::uint32_t>(mesh_.points.size());
      mesh_.points.push_back(Vec3d(mesh_.points[corners[corner]]));
    } else if (point == kNone) {
      point = corners[corner];
      isUsed[point] = 1;
    }
    corners[corner] = point;
  }
}

// Splits all but the first of the pairs between two points.
void Splitting::cutSharedEdges() {
  const EdgeTable edges(mesh_);
  toCut_.assign(mesh_.triangles.size(), 0);
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    if (sides.size() == 2)
      continue;
    for (const std::uint32_t side : sides)
      toCut_[side] =
          side != sides.first[0] && partner_[side] != sides.first[0] && side < partner_[side];
  }
  for (std::uint32_t side = 0; side < toCut_.size(); ++side) // its size increases
    if (toCut_[side])
      cut(side);
}

// Face (a, b, c) with side a - b becomes (a, m, c); (m, b, c) is appended.
void Splitting::cut(std::uint32_t side) {
  const std::uint32_t other = partner_[side];
  const auto midpoint = static_cast<std::uint32_t>(mesh_.points.size());
  mesh_.points.push_back(times(plus(corner(side), corner(next(side))), 0.5));
  std::array<std::uint32_t, 2> added{};
  for (int k = 0; k < 2; ++k) {
    const std::uint32_t s = k == 0 ? side : other, after = next(s);
    const std::uint32_t b = mesh_.triangles[after], c = mesh_.triangles[next(after)];
    const auto first = static_cast<std::uint32_t>(mesh_.triangles.size());
    added[static_cast<std::size_t>(k)] = first;
    mesh_.triangles.insert(mesh_.triangles.end(), {midpoint, b, c});
    mesh_.triangles[after] = midpoint;
    partner_.resize(first + 3);
    toCut_.resize(first + 3, 0);
    std::swap(toCut_[first + 1], toCut_[after]);
    join(first + 1, partner_[after]);
    join(first + 2, after);
  }
  join(side, added[1]);
  join(other, added[0]);
  toCut_[side] = 0;
}

} // namespace

void splitFans(TriangleMesh& mesh, Progress& progress) {
  Splitting splitting(mesh, progress);
  splitting.splitPoints();
  splitting.cutSharedEdges();
  mesh.faceCount = mesh.triangleCount();
}

} // namespace tetvdb
