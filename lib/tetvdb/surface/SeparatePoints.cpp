// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/SeparatePoints.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/FaceContact.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FloatPositions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kFirstStep = -22, kLastStep = -12; // powers of two of the largest coordinate
constexpr int kThinStep = -20;                   // of the height of a face
constexpr int kMaxRounds = 8;
// The measured meshes whose points could be separated took up to 4,600.
constexpr int kMaxTests = 1 << 14; // of the faces of a point against others

class Separating {
public:
  Separating(TriangleMesh& mesh, const std::vector<std::uint32_t>& equal) : mesh_(mesh) {
    for (const Vec3d& p : mesh.points) {
      used_.insert(asFloats(p));
      for (const double c : p)
        size_ = std::max(size_, std::abs(c));
    }
    for (const std::uint32_t point : equal)
      facesAt_[point];
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      if (const auto entry = facesAt_.find(mesh.triangles[i]); entry != facesAt_.end())
        entry->second.push_back(static_cast<std::uint32_t>(i / 3));
  }

  // Moves the point; returns false if there is no position for it. With `free`, the first of many
  // at which its faces intersect no others.
  bool move(std::uint32_t point, bool free) {
    const std::vector<std::uint32_t>& faces = facesAt_[point];
    const Vec3d from = from_.try_emplace(point, mesh_.points[point]).first->second;
    const Vec3d last = mesh_.points[point];
    mesh_.points[point] = from;
    std::vector<Vec3d> before, ways(2, Vec3d{0, 0, 0});
    for (const std::uint32_t face : faces) {
      before.push_back(normal(face));
      if (const double size = length(before.back()); size > 0)
        ways[0] = minus(ways[0], times(before.back(), 1 / size));
      ways.push_back(minus(midpoint(face), from));
      ways[1] = plus(ways[1], ways.back());
    }
    for (const bool thinTurn : {false, true})
      for (int step = kFirstStep; step <= kLastStep; ++step)
        for (const Vec3d& way : ways) {
          const double size = length(way);
          if (size > 0 && moveTo(point, plus(from, times(way, std::ldexp(size_, step) / size)),
                                 faces, before, thinTurn)) {
            if (!(free || thinTurn) || !crosses(point)) {
              largestMove_ = std::max(largestMove_, moveOf(point));
              return true;
            }
            used_.erase(asFloats(mesh_.points[point]));
            mesh_.points[point] = from;
          }
        }
    mesh_.points[point] = last;
    used_.insert(asFloats(last));
    return false;
  }

  // Whether a face of the point meets another in more than their common points, or this cannot be
  // found out within the limit.
  bool crosses(std::uint32_t point) {
    if (++tests_ > kMaxTests)
      return true;
    if (tree_ == nullptr) {
      std::vector<Box> boxes(mesh_.triangleCount());
      for (std::size_t i = 0; i < mesh_.triangles.size(); ++i)
        boxes[i / 3].add(at(i));
      tree_ = std::make_unique<BoxTree>(std::move(boxes));
    }
    bool found = false;
    for (const std::uint32_t face : facesAt_[point]) {
      Box box;
      for (std::size_t k = 0; k < 3; ++k)
        box.add(at(3 * std::size_t(face) + k));
      const double margin = 2 * largestMove_; // of others since the tree was built
      for (std::size_t axis = 0; axis < 3; ++axis) {
        box.low[axis] -= margin;
        box.high[axis] += margin;
      }
      tree_->visit([&](const Box& other) { return other.meets(box); },
                   [&](std::uint32_t other) {
                     found =
                         found || (other != face && hasArea(face) && hasArea(other) &&
                                   facesMeet(mesh_.points, &mesh_.triangles[3 * std::size_t(face)],
                                             &mesh_.triangles[3 * std::size_t(other)]));
                     return found;
                   });
    }
    return found;
  }

  double moveOf(std::uint32_t point) const {
    return length(minus(mesh_.points[point], from_.at(point)));
  }

private:
  // Whether `position`, rounded, is free and preserves the orientation of the faces, whose normals
  // are given; collinear faces may change, with `thinTurn` also those that floats hardly resolve.
  bool moveTo(std::uint32_t point, const Vec3d& position, const std::vector<std::uint32_t>& faces,
              const std::vector<Vec3d>& before, bool thinTurn) {
    const FloatPosition to = asFloats(position);
    if (used_.count(to) > 0)
      return false;
    const Vec3d from = mesh_.points[point];
    mesh_.points[point] = nearestFloats(position);
    for (std::size_t i = 0; i < faces.size(); ++i)
      if (dot(before[i], before[i]) > 0 && !(dot(normal(faces[i]), before[i]) > 0) &&
          !(thinTurn && isThin(faces[i], length(before[i])))) {
        mesh_.points[point] = from;
        return false;
      }
    used_.insert(to);
    return true;
  }
  // Whether the least height of a face of twice the area is that of some floats.
  bool isThin(std::uint32_t face, double twiceArea) const {
    const std::size_t i = 3 * std::size_t(face);
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, length(minus(at(i + k), at(i + (k + 1) % 3))));
    return twiceArea <= longest * std::ldexp(size_, kThinStep);
  }
  const Vec3d& at(std::size_t corner) const { return mesh_.points[mesh_.triangles[corner]]; }
  Vec3d normal(std::size_t face) const {
    return cross(minus(at(3 * face + 1), at(3 * face)), minus(at(3 * face + 2), at(3 * face)));
  }
  Vec3d midpoint(std::size_t face) const {
    return times(plus(plus(at(3 * face), at(3 * face + 1)), at(3 * face + 2)), 1.0 / 3);
  }

  bool hasArea(std::uint32_t face) const {
    const std::size_t i = 3 * std::size_t(face);
    return !areCollinear(at(i), at(i + 1), at(i + 2));
  }

  TriangleMesh& mesh_;
  double size_ = 0;
  std::set<FloatPosition> used_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> facesAt_;
  std::unordered_map<std::uint32_t, Vec3d> from_; ///< of moved points
  std::unique_ptr<BoxTree> tree_;                 ///< of faces, built on the first query
  double largestMove_ = 0;
  int tests_ = 0;
};

} // namespace

SeparatedPoints separateEqualPoints(TriangleMesh& mesh, std::size_t firstAdded,
                                    Progress& progress) {
  SeparatedPoints counts;
  std::vector<std::uint32_t> moving = equalAsFloats(mesh.points);
  for (std::size_t point = firstAdded; point < mesh.points.size(); ++point)
    moving.push_back(static_cast<std::uint32_t>(point));
  if (moving.empty())
    return counts;
  std::sort(moving.begin(), moving.end());
  moving.erase(std::unique(moving.begin(), moving.end()), moving.end());
  Separating separating(mesh, moving);
  std::map<FloatPosition, std::uint32_t> kept;
  std::vector<std::uint32_t> moved;
  for (const std::uint32_t point : moving) {
    progress.check();
    const auto [first, isFirst] = kept.try_emplace(asFloats(mesh.points[point]), point);
    if (isFirst && point < firstAdded)
      continue;
    if (separating.move(point, false)) {
      moved.push_back(point);
    } else if (first->second < firstAdded && separating.move(first->second, false)) {
      moved.push_back(first->second);
      first->second = point;
    } else {
      counts.complete = false;
    }
  }
  for (int round = 0; round < kMaxRounds; ++round) {
    bool again = false;
    for (const std::uint32_t point : moved) {
      progress.check();
      if (separating.crosses(point))
        again = separating.move(point, true) || again;
    }
    if (!again)
      break;
  }
  counts.points = moved.size();
  for (const std::uint32_t point : moved)
    counts.largestMove = std::max(counts.largestMove, separating.moveOf(point));
  return counts;
}

} // namespace tetvdb
