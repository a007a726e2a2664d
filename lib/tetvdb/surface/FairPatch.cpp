// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/FairPatch.h"

#include "tetvdb/geometry/VectorMath.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

using Corners = HolePatch::Corners;

constexpr int kMaxRounds = 24; // of splitting
constexpr int kMaxFlips = 12;  // rounds of flipping after each split
constexpr int kFairings = 3;   // each with cotangents of the previous surface
constexpr double kMinCot = 0.02, kMaxCot = 50;

double cotangent(const Vec3d& apex, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = minus(a, apex), v = minus(b, apex);
  const double size = length(cross(u, v));
  return size > 0 ? dot(u, v) / size : (dot(u, v) > 0 ? kMaxCot : -kMaxCot);
}

// --- Refinement.

class Refinement {
public:
  Refinement(std::vector<Vec3d>& points, const HolePatch& patch, const EdgeTaken& isTaken)
      : points_(points), faces_(patch.faces), isTaken_(isTaken), loopEnd_(points.size()) {
    std::map<std::uint32_t, std::pair<double, int>> edges;
    std::set<std::uint32_t> loop;
    for (const Corners& c : patch.faces)
      loop.insert(c.begin(), c.end());
    for (const Corners& c : patch.around)
      for (std::size_t k = 0; k < 3; ++k) {
        const double size = length(minus(points[c[k]], points[c[(k + 1) % 3]]));
        for (const std::uint32_t v : {c[k], c[(k + 1) % 3]})
          if (loop.count(v) > 0) {
            edges[v].first += size;
            ++edges[v].second;
          }
      }
    for (const std::uint32_t v : loop)
      scale_[v] = edges[v].second > 0 ? edges[v].first / edges[v].second : 0;
  }

  // Returns false if there are too many points.
  bool run(Progress& progress) {
    for (int round = 0; round < kMaxRounds; ++round) {
      progress.check();
      const std::size_t before = faces_.size();
      for (std::size_t face = 0; face < before; ++face)
        split(face);
      if (points_.size() - loopEnd_ > kMaxFairPoints)
        return false;
      flip();
      if (faces_.size() == before)
        return true;
    }
    return true;
  }

  const std::vector<Corners>& faces() const { return faces_; }

  void flip() {
    for (int round = 0; round < kMaxFlips; ++round)
      if (!flipOnce())
        return;
  }

private:
  void split(std::size_t face) {
    const Corners c = faces_[face];
    Vec3d midpoint{0, 0, 0};
    double scale = 0;
    for (const std::uint32_t v : c) {
      midpoint = plus(midpoint, times(points_[v], 1.0 / 3));
      scale += scale_[v] / 3;
    }
    for (const std::uint32_t v : c) {
      const double away = std::sqrt(2.0) * length(minus(midpoint, points_[v]));
      if (!(away > scale) || !(away > scale_[v]))
        return;
    }
    const auto added = static_cast<std::uint32_t>(points_.size());
    points_.push_back(midpoint);
    scale_[added] = scale;
    faces_[face] = {c[0], c[1], added};
    faces_.push_back({c[1], c[2], added});
    faces_.push_back({c[2], c[0], added});
  }

  Vec3d normal(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return cross(minus(points_[b], points_[a]), minus(points_[c], points_[a]));
  }

  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  using Side = std::pair<Edge, std::size_t>; // 3 face + k

  // Ascending; of several with one edge the last.
  std::vector<Side> sortedSides() const {
    std::vector<Side> sides;
    for (std::size_t s = 0; s < 3 * faces_.size(); ++s)
      sides.push_back({{faces_[s / 3][s % 3], faces_[s / 3][(s + 1) % 3]}, s});
    std::sort(sides.begin(), sides.end(), std::greater<>());
    const auto sameEdge = [](const Side& a, const Side& b) { return a.first == b.first; };
    sides.erase(std::unique(sides.begin(), sides.end(), sameEdge), sides.end());
    std::reverse(sides.begin(), sides.end());
    return sides;
  }

  bool flipOnce() {
    const std::vector<Side> sides = sortedSides();
    const auto find = [&](const Edge& edge) {
      const auto at = std::lower_bound(sides.begin(), sides.end(), Side{edge, 0});
      return at != sides.end() && at->first == edge ? at : sides.end();
    };
    std::vector<char> touched(faces_.size(), 0);
    std::set<Edge> made;
    bool flipped = false;
    for (const auto& [edge, s] : sides) {
      const auto [a, b] = edge;
      const auto back = find({b, a});
      if (a > b || back == sides.end())
        continue;
      const std::size_t f = s / 3, g = back->second / 3;
      if (touched[f] != 0 || touched[g] != 0)
        continue;
      const std::uint32_t c = faces_[f][(s + 2) % 3], d = faces_[g][(back->second + 2) % 3];
      if (c == d || find({c, d}) != sides.end() || find({d, c}) != sides.end() ||
          made.count({std::min(c, d), std::max(c, d)}) > 0 ||
          (c < loopEnd_ && d < loopEnd_ && isTaken_(c, d)))
        continue;
      const double now = cotangent(points_[c], points_[a], points_[b]) +
                         cotangent(points_[d], points_[a], points_[b]);
      if (!(now < -1e-6))
        continue;
      // Neither new normal opposes both old ones.
      const Vec3d before = plus(normal(a, b, c), normal(b, a, d));
      if (!(dot(normal(a, d, c), before) > 0) || !(dot(normal(d, b, c), before) > 0))
        continue;
      faces_[f] = {a, d, c};
      faces_[g] = {d, b, c};
      made.insert({std::min(c, d), std::max(c, d)});
      touched[f] = touched[g] = 1;
      flipped = true;
    }
    return flipped;
  }

  std::vector<Vec3d>& points_;
  std::vector<Corners> faces_;
  const EdgeTaken& isTaken_;
  const std::size_t loopEnd_;             ///< points from this number on are new
  std::map<std::uint32_t, double> scale_; ///< mean edge length of the mesh at a point
};

// --- Fairing.

// The Laplacian of the patch's points, as a function of the new points.
class Fairing {
public:
  Fairing(std::vector<Vec3d>& points, std::size_t firstNew, const std::vector<Corners>& faces,
          const std::vector<Corners>& around, Fairness fairness)
      : points_(points), firstNew_(firstNew), fairness_(fairness) {
    std::set<std::uint32_t> loop;
    for (const Corners& c : faces)
      for (const std::uint32_t v : c)
        if (v < firstNew)
          loop.insert(v);
    std::map<std::uint32_t, std::size_t> row;
    for (const std::uint32_t v : loop)
      row.emplace(v, row.size());
    for (std::size_t v = firstNew; v < points.size(); ++v)
      row.emplace(static_cast<std::uint32_t>(v), row.size());
    std::vector<std::map<std::uint32_t, double>> weights(row.size());
    std::vector<double> areas(row.size(), 0);
    for (const std::vector<Corners>* part : {&faces, &around})
      for (const Corners& c : *part) {
        const double area =
            length(cross(minus(points[c[1]], points[c[0]]), minus(points[c[2]], points[c[0]]))) / 6;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t a = c[(k + 1) % 3], b = c[(k + 2) % 3];
          const double weight =
              std::clamp(cotangent(points[c[k]], points[a], points[b]), kMinCot, kMaxCot);
          if (const auto at = row.find(a); at != row.end())
            weights[at->second][b] += weight;
          if (const auto at = row.find(b); at != row.end())
            weights[at->second][a] += weight;
          if (const auto at = row.find(c[k]); at != row.end())
            areas[at->second] += area;
        }
      }
    for (const auto& [v, i] : row)
      if (fairness == Fairness::Smooth)
        addRow(v, areas[i] > 0 ? 1 / std::sqrt(areas[i]) : 0, weights[i]);
      else if (v >= firstNew)
        addRow(v, -1, weights[i]);
  }

  // Moves the new points to where the Laplacian's sum of squares is least, or where it is 0.
  // Returns false, and moves none, where rounding hides where that is.
  bool solve() {
    const auto count = static_cast<Eigen::Index>(points_.size() - firstNew_);
    Eigen::SparseMatrix<double> ofNew(rows_, count);
    ofNew.setFromTriplets(ofNew_.begin(), ofNew_.end());
    Eigen::MatrixX3d ofFixed = Eigen::MatrixX3d::Zero(rows_, 3);
    for (std::size_t i = 0; i < ofFixed_.size(); ++i)
      for (Eigen::Index k = 0; k < 3; ++k)
        ofFixed(static_cast<Eigen::Index>(i), k) = ofFixed_[i][static_cast<std::size_t>(k)];
    if (fairness_ == Fairness::Smooth) {
      ofFixed = ofNew.transpose() * ofFixed;
      ofNew = Eigen::SparseMatrix<double>(ofNew.transpose()) * ofNew;
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(ofNew);
    if (factors.info() != Eigen::Success)
      return false;
    const Eigen::MatrixX3d found = factors.solve(-ofFixed);
    if (!found.allFinite())
      return false;
    for (Eigen::Index i = 0; i < count; ++i)
      points_[firstNew_ + static_cast<std::size_t>(i)] = {found(i, 0), found(i, 1), found(i, 2)};
    return true;
  }

private:
  // The Laplacian at a point, times `scale`, which makes its square one by area, or the matrix
  // positive.
  void addRow(std::uint32_t point, double scale, const std::map<std::uint32_t, double>& weights) {
    Vec3d fixed{0, 0, 0};
    const auto add = [&](std::uint32_t of, double weight) {
      if (of >= firstNew_)
        ofNew_.emplace_back(static_cast<int>(rows_), static_cast<int>(of - firstNew_), weight);
      else
        fixed = plus(fixed, times(points_[of], weight));
    };
    double sum = 0;
    for (const auto& [other, weight] : weights) {
      add(other, scale * weight);
      sum += weight;
    }
    add(point, -scale * sum);
    ofFixed_.push_back(fixed);
    ++rows_;
  }

  std::vector<Vec3d>& points_;
  const std::size_t firstNew_;
  const Fairness fairness_;
  Eigen::Index rows_ = 0;                     ///< points of the patch
  std::vector<Eigen::Triplet<double>> ofNew_; ///< the Laplacian's coefficients
  std::vector<Vec3d> ofFixed_;                ///< its part that does not change
};

} // namespace

std::size_t fairPatch(std::vector<Vec3d>& points, HolePatch& patch, Fairness fairness,
                      const EdgeTaken& isTaken, Progress& progress) {
  const std::size_t first = points.size();
  Refinement refinement(points, patch, isTaken);
  if (!refinement.run(progress) || points.size() == first) {
    points.resize(first);
    return 0;
  }
  Vec3d low = points[patch.faces[0][0]], high = low;
  for (const Corners& c : patch.faces)
    for (const std::uint32_t v : c)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], points[v][axis]);
        high[axis] = std::max(high[axis], points[v][axis]);
      }
  const double max = length(minus(high, low)); // of a new point from its position in the plain
                                               // patch
  const std::vector<Vec3d> before(points.begin() + static_cast<std::ptrdiff_t>(first),
                                  points.end());
  for (int i = 0; i < kFairings; ++i) {
    progress.check();
    if (!Fairing(points, first, refinement.faces(), patch.around, fairness).solve()) {
      points.resize(first);
      return 0;
    }
    refinement.flip();
  }
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!(length(minus(points[first + i], before[i])) <= max)) {
      points.resize(first);
      return 0;
    }
  patch.faces = refinement.faces();
  return before.size();
}

} // namespace tetvdb
