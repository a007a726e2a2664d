// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/RemoveCrossings.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/FillHoles.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/LatticeChain.h"
#include "tetvdb/surface/StitchBoundaries.h"
#include "tetvdb/surface/TriangulatePolygon.h"
#include "tetvdb/surface/TrimChain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxRounds = 6;
// Cutting does not converge where a round meets so many times as many faces as an earlier one, and
// at least so many.
constexpr std::size_t kGrowth = 2, kManyMet = 100;
constexpr std::size_t kMaxPartCorners = 4096; // of one face; they are compared with one another
constexpr double kSame = 8;                   // lattice units: closer corners are merged
constexpr double kStraight = 16;              // lattice units: tolerance of a straight line
constexpr std::uint32_t kNone = 0xFFFFFFFFu;

using Edge = std::pair<std::uint32_t, std::uint32_t>;
using EdgeCounts = std::map<Edge, int>; // several where parts overlap by rounding
using Loop = std::vector<std::uint32_t>;

bool isPositive(std::int64_t winding) {
  return winding > 0;
}

// --- Corners of parts as points of the mesh.

class PartPoints {
public:
  PartPoints(TriangleMesh& mesh, const LatticeChain& chain)
      : mesh_(mesh), chain_(chain), firstNew_(mesh.points.size()) {}

  // Registers a corner of a cut face, so that it keeps its point of the mesh.
  void addCorner(std::uint32_t latticePoint) {
    const Vec3d& p = chain_.welded.points[latticePoint];
    if (find(p) == kNone)
      insert(p, chain_.pointOf[latticePoint]);
  }
  std::uint32_t at(const Vec3d& p) {
    const std::uint32_t found = find(p);
    if (found != kNone)
      return found;
    const auto added = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back(chain_.toWorld(p));
    insert(p, added);
    return added;
  }
  // On the lattice, unrounded.
  const Vec3d& lattice(std::uint32_t point) const { return positions_.at(point); }
  const std::map<std::uint32_t, Vec3d>& positions() const { return positions_; }

  // Rounds new points to floats if `floats`; returns by point the point that replaces it.
  std::vector<std::uint32_t> round(bool floats) {
    std::vector<std::uint32_t> becomes(mesh_.points.size());
    std::iota(becomes.begin(), becomes.end(), 0u);
    std::map<Vec3d, std::uint32_t> byPosition;
    for (const auto& [point, p] : positions_)
      if (point < firstNew_)
        byPosition.try_emplace(mesh_.points[point], point);
    for (std::size_t point = firstNew_; point < becomes.size(); ++point) {
      Vec3d& p = mesh_.points[point];
      if (floats)
        p = nearestFloats(p);
      becomes[point] = byPosition.try_emplace(p, static_cast<std::uint32_t>(point)).first->second;
    }
    return becomes;
  }

private:
  using Cell = std::array<std::int64_t, 3>;
  static Cell cellOf(const Vec3d& p) {
    return {static_cast<std::int64_t>(std::floor(p[0] / (2 * kSame))),
            static_cast<std::int64_t>(std::floor(p[1] / (2 * kSame))),
            static_cast<std::int64_t>(std::floor(p[2] / (2 * kSame)))};
  }
  std::uint32_t find(const Vec3d& p) const {
    const Cell midpoint = cellOf(p);
    for (int n = 0; n < 27; ++n) {
      const auto entry = cells_.find(
          {midpoint[0] + n % 3 - 1, midpoint[1] + n / 3 % 3 - 1, midpoint[2] + n / 9 - 1});
      if (entry == cells_.end())
        continue;
      for (const auto& [at, point] : entry->second)
        if (length(minus(at, p)) <= kSame)
          return point;
    }
    return kNone;
  }
  void insert(const Vec3d& p, std::uint32_t point) {
    cells_[cellOf(p)].emplace_back(p, point);
    positions_.try_emplace(point, p);
  }

  TriangleMesh& mesh_;
  const LatticeChain& chain_;
  const std::size_t firstNew_;
  std::map<Cell, std::vector<std::pair<Vec3d, std::uint32_t>>> cells_;
  std::map<std::uint32_t, Vec3d> positions_;
};

// --- Merging the parts of one face.

// Directed edges; those in opposite directions cancel.
class EdgeSum {
public:
  void add(std::uint32_t from, std::uint32_t to, int count = 1) {
    int& sum = sums_[{std::min(from, to), std::max(from, to)}];
    sum += from < to ? count : -count;
  }
  // Adds an edge through corners at the given distances from its first point.
  void add(const Edge& edge, const std::map<std::uint32_t, double>& between, int count = 1) {
    std::vector<std::pair<double, std::uint32_t>> ordered;
    ordered.reserve(between.size() + 1);
    for (const auto& [v, along] : between)
      ordered.emplace_back(along, v);
    std::sort(ordered.begin(), ordered.end());
    ordered.emplace_back(0, edge.second);
    std::uint32_t from = edge.first;
    for (const auto& [along, to] : ordered) {
      add(from, to, count);
      from = to;
    }
  }
  EdgeCounts edges() const {
    EdgeCounts edges;
    for (const auto& [edge, sum] : sums_)
      if (sum != 0)
        edges.emplace(sum > 0 ? edge : Edge{edge.second, edge.first}, std::abs(sum));
    return edges;
  }

private:
  std::map<Edge, int> sums_; ///< low first
};

// The remainder of a face in one orientation: edges with the face on their left.
struct Region {
  std::uint32_t face; ///< of the chain
  bool inverse;
  EdgeCounts edges;
  std::set<std::uint32_t> inner; ///< corners of other faces inside it, off its edges
  bool whole = false;            ///< a face that was not cut
};

std::vector<Edge> repeated(const EdgeCounts& counts) {
  std::vector<Edge> edges;
  for (const auto& [edge, count] : counts)
    edges.insert(edges.end(), static_cast<std::size_t>(count), edge);
  return edges;
}

bool isBetween(const Vec3d& a, const Vec3d& b, const Vec3d& p, double& along) {
  const Vec3d way = minus(b, a), to = minus(p, a);
  const double size = length(way);
  if (!(size > 0))
    return false;
  along = dot(to, way) / size;
  return along > kSame && along < size - kSame && length(cross(way, to)) <= kStraight * size;
}

// Corners by their positions on the lattice.
class CornerTree {
public:
  CornerTree(const PartPoints& points, const std::set<std::uint32_t>& corners)
      : points_(points), corners_(corners.begin(), corners.end()), tree_(boxesOf(points, corners)) {
  }

  // Those on the edge between its ends, with their distances from its first point.
  std::map<std::uint32_t, double> between(const Edge& edge) const {
    const Vec3d &a = points_.lattice(edge.first), &b = points_.lattice(edge.second);
    Box box;
    box.add(a);
    box.add(b);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.low[axis] -= kStraight;
      box.high[axis] += kStraight;
    }
    std::map<std::uint32_t, double> found;
    tree_.visit([&](const Box& other) { return other.meets(box); },
                [&](std::uint32_t item) {
                  double along;
                  if (isBetween(a, b, points_.lattice(corners_[item]), along))
                    found.emplace(corners_[item], along);
                  return false;
                });
    return found;
  }

private:
  static std::vector<Box> boxesOf(const PartPoints& points,
                                  const std::set<std::uint32_t>& corners) {
    std::vector<Box> boxes;
    boxes.reserve(corners.size());
    for (const std::uint32_t v : corners)
      boxes.push_back(Box{points.lattice(v), points.lattice(v)});
    return boxes;
  }

  const PartPoints& points_;
  std::vector<std::uint32_t> corners_;
  BoxTree tree_;
};

class Regions {
public:
  Regions(const TriangleMesh& mesh, PartPoints& points) : mesh_(mesh), points_(points) {}

  // Returns false if there are too many corners.
  bool add(std::uint32_t face, const std::vector<FacePart>& parts) {
    for (const bool inverse : {false, true}) {
      std::vector<Loop> outlines;
      std::set<std::uint32_t> corners;
      Region region{face, inverse, {}, {}, false};
      for (const FacePart& part : parts) {
        if (part.inverse != inverse)
          continue;
        Loop loop;
        for (const Vec3d& p : part.outline) {
          const std::uint32_t v = points_.at(p);
          if (loop.empty() || (loop.back() != v && loop.front() != v))
            loop.push_back(v);
        }
        if (loop.size() < 3)
          continue;
        if (inverse)
          std::reverse(loop.begin(), loop.end());
        corners.insert(loop.begin(), loop.end());
        outlines.push_back(std::move(loop));
      }
      if (corners.size() > kMaxPartCorners)
        return false;
      if (corners.empty())
        continue;
      const CornerTree tree(points_, corners);
      EdgeSum edges;
      for (const Loop& loop : outlines)
        for (std::size_t i = 0; i < loop.size(); ++i) {
          const Edge edge{loop[i], loop[(i + 1) % loop.size()]};
          edges.add(edge, tree.between(edge));
        }
      region.edges = edges.edges();
      if (!region.edges.empty())
        regions_.push_back(std::move(region));
    }
    return true;
  }

  // Adds a whole face, which does not change unless corners of others lie on its edges or inside.
  // Returns false if its own corners are as close to one another as rounding.
  bool addWhole(std::uint32_t face, bool inverse, const std::array<Vec3d, 3>& corners) {
    Loop outline;
    for (const Vec3d& p : corners)
      outline.push_back(points_.at(p));
    if (outline[0] == outline[1] || outline[1] == outline[2] || outline[2] == outline[0])
      return false;
    if (inverse)
      std::reverse(outline.begin(), outline.end());
    regions_.push_back({face, inverse, {}, {}, true});
    for (std::size_t i = 0; i < 3; ++i)
      regions_.back().edges.insert({{outline[i], outline[(i + 1) % 3]}, 1});
    return true;
  }

  // Assigns corners of others that lie in a face to the region, from `first`
  // on, that contains them. Corners close to edges are left to
  // addCornersOfOthers().
  void addWithin(std::size_t first, const std::vector<std::uint32_t>& corners) {
    for (const std::uint32_t v : corners) {
      others_.insert(v);
      const Vec3d& p = points_.lattice(v);
      for (std::size_t i = first; i < regions_.size(); ++i)
        if (isWithin(regions_[i], p))
          regions_[i].inner.insert(v);
    }
  }

  // Adds a corner on edges of regions.
  void addOther(std::uint32_t corner) { others_.insert(corner); }

  std::size_t size() const { return regions_.size(); }

  // Removes whole faces that did not change; calls left(face) for each.
  template <typename Left>
  void takeBackWhole(const Left& left) {
    const auto isLeft = [&](const Region& region) {
      if (!region.whole || region.edges.size() != 3 || !region.inner.empty())
        return false;
      left(region.face);
      return true;
    };
    regions_.erase(std::remove_if(regions_.begin(), regions_.end(), isLeft), regions_.end());
  }

  // Removes corners that are straight in every region that has them, except corners of faces.
  void dropStraightCorners(const std::set<std::uint32_t>& faceCorners) {
    std::map<std::uint32_t, std::vector<std::size_t>> regionsAt;
    for (std::size_t i = 0; i < regions_.size(); ++i)
      for (const auto& [edge, count] : regions_[i].edges)
        if (auto& at = regionsAt[edge.first]; at.empty() || at.back() != i)
          at.push_back(i);
    std::map<Edge, std::set<std::uint32_t>> dropped; // removed corners of an edge, low first
    for (const auto& [v, at] : regionsAt) {
      if (faceCorners.count(v) > 0)
        continue;
      std::vector<std::set<std::uint32_t>> passed; // by region
      std::vector<Edge> spans; // from the previous corner to the next, by region
      for (const std::size_t i : at) {
        Edge span{kNone, kNone};
        int out = 0, in = 0;
        const EdgeCounts& edges = regions_[i].edges;
        for (auto e = edges.lower_bound({v, 0}); e != edges.end() && e->first.first == v; ++e) {
          span.second = e->first.second;
          out += e->second;
        }
        for (const auto& [edge, count] : edges)
          if (edge.second == v) {
            span.first = edge.first;
            in += count;
          }
        passed.push_back({v});
        for (const std::uint32_t other : {span.first, span.second})
          if (const auto past = dropped.find({std::min(v, other), std::max(v, other)});
              past != dropped.end())
            passed.back().insert(past->second.begin(), past->second.end());
        if (in != 1 || out != 1 || edges.count({span.first, span.second}) > 0 ||
            span.first == span.second || !runsPast(span, passed.back())) {
          spans.clear();
          break;
        }
        spans.push_back(span);
      }
      for (std::size_t k = 0; k < spans.size(); ++k) {
        EdgeCounts& edges = regions_[at[k]].edges;
        edges.erase({spans[k].first, v});
        edges.erase({v, spans[k].second});
        edges.emplace(spans[k], 1);
        dropped[{std::min(spans[k].first, spans[k].second),
                 std::max(spans[k].first, spans[k].second)}]
            .insert(passed[k].begin(), passed[k].end());
      }
    }
  }

  // Splits edges at corners of other regions that lie on them.
  void addCornersOfOthers() {
    std::set<std::uint32_t> all = others_;
    for (const Region& region : regions_)
      for (const auto& [edge, count] : region.edges)
        all.insert(edge.first);
    const CornerTree corners(points_, all);
    for (Region& region : regions_) {
      EdgeSum edges;
      for (const auto& [edge, count] : region.edges)
        edges.add(edge, corners.between(edge), count);
      region.edges = edges.edges();
    }
  }

  // Triangulates all regions with the replaced points; returns false if one cannot be triangulated.
  bool triangulate(const LatticeChain& chain, const std::vector<std::uint32_t>& becomes,
                   std::vector<std::uint32_t>& corners) const {
    std::vector<Vec3d> lattice(mesh_.points.size());
    for (const auto& [v, p] : points_.positions())
      lattice[v] = p;
    for (const Region& region : regions_) {
      const std::array<Vec3d, 3> c = chain.welded.cornersOf(region.face);
      const Vec3d normal =
          times(cross(minus(c[1], c[0]), minus(c[2], c[0])), region.inverse ? -1.0 : 1.0);
      const EdgeTaken none = [](std::uint32_t, std::uint32_t) { return false; };
      EdgeSum sum;
      for (const auto& [edge, count] : region.edges)
        if (becomes[edge.first] != becomes[edge.second])
          sum.add(becomes[edge.first], becomes[edge.second], count);
      const std::vector<Edge> rounded = repeated(sum.edges());
      std::set<std::uint32_t> inner;
      for (const std::uint32_t v : region.inner)
        inner.insert(becomes[v]);
      for (const Edge& edge : rounded)
        inner.erase(edge.first);
      if (rounded.empty() || triangulateEdges(mesh_.points, rounded, {inner.begin(), inner.end()},
                                              normal, none, Overlaps::Refused, corners))
        continue;
      // Rounding makes edges cross: triangles of the unrounded points, some of which collapse.
      const std::vector<Edge> edges = repeated(region.edges);
      std::vector<std::uint32_t> unrounded;
      if (!triangulateEdges(lattice, edges, {region.inner.begin(), region.inner.end()}, normal,
                            none, Overlaps::Merged, unrounded))
        return false;
      for (std::size_t i = 0; i < unrounded.size(); i += 3) {
        const std::array<std::uint32_t, 3> face{becomes[unrounded[i]], becomes[unrounded[i + 1]],
                                                becomes[unrounded[i + 2]]};
        if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0])
          corners.insert(corners.end(), face.begin(), face.end());
      }
    }
    return true;
  }

private:
  // For a convex region: farther from each edge than the tolerance of corners on it.
  bool isWithin(const Region& region, const Vec3d& p) const {
    Vec3d normal{0, 0, 0};
    const Vec3d& origin = points_.lattice(region.edges.begin()->first.first);
    for (const auto& [edge, count] : region.edges)
      normal = plus(normal, cross(minus(points_.lattice(edge.first), origin),
                                  minus(points_.lattice(edge.second), origin)));
    return std::all_of(region.edges.begin(), region.edges.end(), [&](const auto& entry) {
      const Edge& edge = entry.first;
      const Vec3d way = minus(points_.lattice(edge.second), points_.lattice(edge.first));
      const Vec3d to = minus(p, points_.lattice(edge.first));
      return dot(cross(way, to), normal) > kStraight * length(way) * length(normal);
    });
  }

  bool runsPast(const Edge& edge, const std::set<std::uint32_t>& corners) const {
    return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
      double along;
      return isBetween(points_.lattice(edge.first), points_.lattice(edge.second),
                       points_.lattice(v), along);
    });
  }

  const TriangleMesh& mesh_;
  PartPoints& points_;
  std::vector<Region> regions_;
  std::set<std::uint32_t> others_; ///< corners that are not those of regions
};

enum class Round { Done, Again, GivenUp };

Round cutOnce(TriangleMesh& mesh, bool floats, std::size_t& fewestMet, CrossingCounts& counts,
              Progress& progress) {
  const LatticeChain chain = latticeChain(mesh);
  const TrimmedChain trimmed = trimChain(chain.welded, isPositive, progress);
  if (!trimmed.complete)
    return Round::GivenUp;
  const auto metFaces =
      static_cast<std::size_t>(std::count(trimmed.isMet.begin(), trimmed.isMet.end(), char(1)));
  if (counts.rounds == 0)
    counts.metFaces = metFaces;
  if (metFaces >= kManyMet && metFaces > kGrowth * fewestMet)
    return Round::GivenUp;
  fewestMet = std::min(fewestMet, metFaces);
  // Keeps the remaining faces of the mesh. The back of a remaining face is inside, since its
  // winding number is higher than that of the front: the orientation is unchanged.
  std::vector<char> drops(mesh.triangleCount(), 1);
  PartPoints points(mesh, chain);
  Regions regions(mesh, points);
  std::set<std::uint32_t> faceCorners;
  std::size_t cut = 0, kept = 0;
  for (const auto& [face, parts] : trimmed.parts)
    for (const std::uint32_t corner : chain.welded.faces[face].corners) {
      points.addCorner(corner);
      faceCorners.insert(chain.pointOf[corner]);
    }
  for (const auto& [face, parts] : trimmed.parts) {
    ++cut;
    if (!regions.add(face, parts))
      return Round::GivenUp;
  }
  for (std::size_t i = 0; i < trimmed.fates.size(); ++i)
    if (trimmed.stays(i)) {
      ++kept;
      drops[chain.source[i]] = 0;
    }
  // Faces that others touch, divided into parts by edges that lie in them.
  const std::vector<MetFace> touched = findMetFaces(chain, trimmed);
  const auto isInverse = [&](std::uint32_t face) {
    return trimmed.fates[face] == PartFate::StaysInverse;
  };
  for (const MetFace& face : touched)
    for (const std::uint32_t corner : face.corners) {
      points.addCorner(corner);
      faceCorners.insert(chain.pointOf[corner]);
    }
  for (const MetFace& face : touched)
    for (const std::uint32_t corner : chain.welded.faces[face.face].corners) {
      points.addCorner(corner);
      faceCorners.insert(chain.pointOf[corner]);
    }
  const auto cornersIn = [&](const MetFace& face) {
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t corner : face.corners)
      corners.push_back(points.at(chain.welded.points[corner]));
    return corners;
  };
  for (const MetFace& face : touched) {
    if (face.parts.empty())
      continue;
    const std::size_t first = regions.size();
    for (const std::vector<Vec3d>& part : face.parts)
      if (!regions.add(face.face, {{part, isInverse(face.face)}}))
        return Round::GivenUp;
    regions.addWithin(first, cornersIn(face));
    drops[chain.source[face.face]] = 1;
    --kept;
    ++cut;
  }
  regions.dropStraightCorners(faceCorners);
  for (const MetFace& face : touched) {
    if (!face.parts.empty())
      continue;
    const std::size_t first = regions.size();
    if (!regions.addWhole(face.face, isInverse(face.face), chain.welded.cornersOf(face.face)))
      continue;
    regions.addWithin(first, cornersIn(face));
    drops[chain.source[face.face]] = 1;
    --kept;
    ++cut;
  }
  for (const Vec3d& p : crossingsOfEdges(chain, trimmed))
    regions.addOther(points.at(p));
  regions.addCornersOfOthers();
  regions.takeBackWhole([&](std::uint32_t face) {
    drops[chain.source[face]] = 0;
    ++kept;
    --cut;
  });
  if (cut == 0 && kept + chain.welded.flat == mesh.triangleCount())
    return Round::Done; // faces without area intersect nothing
  std::vector<std::uint32_t> added;
  if (!regions.triangulate(chain, points.round(floats), added))
    return Round::GivenUp;
  counts.cutFaces += cut;
  counts.addedFaces += added.size() / 3;
  counts.removedFaces += dropFaces(mesh, drops) - cut;
  mesh.triangles.insert(mesh.triangles.end(), added.begin(), added.end());
  mesh.faceCount = mesh.triangleCount();
  dropUnusedPoints(mesh);
  stitchBoundaries(mesh, progress);
  fillHoles(mesh, progress); // closes slits that rounding leaves
  return mesh.triangles.empty() ? Round::GivenUp : Round::Again;
}

} // namespace

CrossingCounts removeCrossings(TriangleMesh& mesh, NewCorners corners, Progress& progress) {
  CrossingCounts counts;
  const TriangleMesh before = mesh;
  const bool floats = corners == NewCorners::FloatsAsGiven && areFloats(mesh.points);
  std::size_t fewestMet = SIZE_MAX; // of the rounds so far
  Round round = Round::Again;
  for (; round == Round::Again && counts.rounds < kMaxRounds; ++counts.rounds)
    round = cutOnce(mesh, floats, fewestMet, counts, progress);
  if (round == Round::GivenUp) {
    counts.complete = false;
    mesh = before;
  }
  return counts;
}

} // namespace tetvdb
