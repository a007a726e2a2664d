// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CollapseEdges.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/ClosestPoint.h"
#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CrossingGuard.h"
#include "tetvdb/surface/HalfEdgeMesh.h"

#include <OpenMesh/Tools/Decimater/BaseDecimaterT.hh>
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <queue>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = SimplifyState::kNone;
constexpr double kMinCosine = 0.5;    ///< of the angle by which a normal may change in one step
constexpr double kMinAgreement = 0.3; ///< cosine of the angle between the normals of a point and
                                      ///< its face
constexpr double kMinShape = 0.02;    ///< height over longest side of a new face, unless it
                                      ///< increases
constexpr std::size_t kManyPoints = 1024; ///< represented by the faces around a vertex
constexpr double kOnFace = 0.01;          ///< squared distance of a point that lies on its face
constexpr std::size_t kMaxFaces = 32;     ///< around a vertex
constexpr int kTries = 4;                 ///< candidate neighbours per vertex
// Weight of a squared length relative to a squared distance in the order of edges: keeps triangles
// in flat regions well-shaped.
constexpr double kLengthWeight = 1e-3;

using Vertex = HalfEdgeMesh::VertexHandle;
using HalfEdge = HalfEdgeMesh::HalfedgeHandle;
using Collapse = OpenMesh::Decimater::CollapseInfoT<HalfEdgeMesh>;

std::size_t at(OpenMesh::BaseHandle handle) {
  return static_cast<std::size_t>(handle.idx());
}

// The faces at the vertices of one region. Faces with a corner in another region are not changed.
struct Patch {
  SimplifyState& surface;
  HalfEdgeMesh mesh;
  std::vector<std::uint32_t> vertexOf; ///< in the surface
  std::vector<std::uint32_t> faceOf;
  const BoxTree& guarded; ///< where new faces may not intersect others
  /// Of the patch's faces in order, then of others nearby; null if `guarded` is empty.
  std::unique_ptr<CrossingGuard> guard;

  Patch(SimplifyState& s, const BoxTree& g) : surface(s), guarded(g) {}
  const Vec3d& point(Vertex v) const { return surface.points[vertexOf[at(v)]]; }
};

// Orders collapses. OpenMesh's quadric module has no term for lengths and is reset by each pass.
class Cost {
public:
  explicit Cost(Patch& patch) : patch_(patch) {}

  float of(const Collapse& c) const {
    const Vec3d& to = patch_.point(c.v1);
    const Vec3d step = minus(to, patch_.point(c.v0));
    return static_cast<float>(std::max(quadric(c.v0).at(to), 0.0) +
                              kLengthWeight * dot(step, step));
  }
  void collapsed(const Collapse& c) { quadric(c.v1).add(quadric(c.v0)); }

private:
  Quadric& quadric(Vertex v) const { return patch_.surface.quadrics[patch_.vertexOf[at(v)]]; }
  Patch& patch_;
};

// Rejects collapses that exceed the tolerance, turn faces over, or make needles or intersections.
class Tolerance {
public:
  explicit Tolerance(Patch& patch) : patch_(patch) {}

  // Sets faces_ and added_ to the new faces, around_ to those around v0, and gone_ to the points
  // that the new faces represent.
  bool allows(const Collapse& c) {
    if (!isManifold(c) || !isUpright(c))
      return false;
    const SimplifyState& s = patch_.surface;
    gone_.clear();
    owner_.clear();
    squares_.clear();
    if (s.original != nullptr) {
      if (!assign(vertexOf(c.v0)))
        return false;
      for (const std::uint32_t face : around_)
        for (std::uint32_t v = firstGone(face); v != kNone; v = s.nextGone[v])
          if (!assign(v))
            return false;
      if (!std::all_of(faces_.begin(), faces_.end(),
                       [&](const Face& face) { return isNearOriginal(face); }))
        return false;
    }
    return !isGuarded() || !patch_.guard->crosses(added_, around_);
  }

  // Before a collapse, the one that was asked about last.
  void prepare(const Collapse& c) {
    keepPoints();
    if (CrossingGuard* guard = patch_.guard.get()) {
      guard->remove(static_cast<std::uint32_t>(c.fl.idx()));
      guard->remove(static_cast<std::uint32_t>(c.fr.idx()));
      for (std::size_t i = 0; i < faces_.size(); ++i)
        guard->change(faces_[i].number, added_[i]);
    }
    merged_ = {isFeature(c.v0vl) || isFeature(c.vlv1), isFeature(c.vrv0) || isFeature(c.v1vr)};
  }

  // After it.
  void collapsed(const Collapse& c) {
    HalfEdgeMesh& mesh = patch_.mesh;
    const std::array<Vertex, 2> others{c.vl, c.vr};
    for (std::size_t i = 0; i < 2; ++i)
      if (merged_[i])
        mesh.status(mesh.edge_handle(mesh.find_halfedge(c.v1, others[i]))).set_feature(true);
  }

private:
  struct Face {
    std::uint32_t number; ///< in the patch
    std::array<Vec3d, 3> corners;
    Vec3d normal; ///< of unit length
  };

  bool isFeature(HalfEdge h) { return patch_.mesh.status(patch_.mesh.edge_handle(h)).feature(); }
  std::uint32_t vertexOf(Vertex v) const { return patch_.vertexOf[at(v)]; }
  std::uint32_t& firstGone(std::uint32_t face) {
    return patch_.surface.firstGone[patch_.faceOf[face]];
  }

  // Whether one of the new faces is where intersections are excluded.
  bool isGuarded() const {
    const std::vector<Vec3d>& points = patch_.surface.mesh.points;
    return std::any_of(added_.begin(), added_.end(), [&](const CrossingGuard::Corners& corners) {
      Box box;
      for (const std::uint32_t v : corners)
        box.add(points[v]);
      bool meets = false;
      patch_.guarded.visit([&](const Box& other) { return other.meets(box); },
                           [&](std::uint32_t) { return meets = true; });
      return meets;
    });
  }

  static double shape(const Vec3d& twiceNormal, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = minus(b, a), bc = minus(c, b), ca = minus(a, c);
    return length(twiceNormal) / std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
  }

  // In addition to OpenMesh's tests: no vertex has fewer than three or more than kMaxFaces faces.
  bool isManifold(const Collapse& c) {
    HalfEdgeMesh& mesh = patch_.mesh;
    return mesh.valence(c.v0) + mesh.valence(c.v1) <= kMaxFaces + 4 && mesh.valence(c.vl) > 3 &&
           mesh.valence(c.vr) > 3;
  }

  // Whether the faces around v0 keep their orientation and shape when v0 moves to v1.
  bool isUpright(const Collapse& c) {
    HalfEdgeMesh& mesh = patch_.mesh;
    const Vec3d& old = patch_.point(c.v0);
    const Vec3d& moved = patch_.point(c.v1);
    const std::vector<Vec3d>& places = patch_.surface.mesh.points; // as they came, for exact signs
    faces_.clear();
    added_.clear();
    around_.clear();
    for (auto h = mesh.voh_begin(c.v0); h.is_valid(); ++h) {
      const auto face = mesh.face_handle(*h);
      around_.push_back(static_cast<std::uint32_t>(face.idx()));
      if (face == c.fl || face == c.fr)
        continue;
      const Vertex va = mesh.to_vertex_handle(*h);
      const Vertex vb = mesh.to_vertex_handle(mesh.next_halfedge_handle(*h));
      const Vec3d& a = patch_.point(va);
      const Vec3d& b = patch_.point(vb);
      // The tet between the old and the new face must not be taken from the solid.
      if (patch_.surface.outward && orientation(places[vertexOf(c.v1)], places[vertexOf(va)],
                                                places[vertexOf(vb)], places[vertexOf(c.v0)]) > 0)
        return false;
      const Vec3d before = cross(minus(a, old), minus(b, old));
      const Vec3d after = cross(minus(a, moved), minus(b, moved));
      if (!(dot(before, after) > kMinCosine * length(before) * length(after) &&
            shape(after, moved, a, b) > std::min(kMinShape, shape(before, old, a, b) * (1 - 1e-9))))
        return false;
      faces_.push_back({around_.back(), {moved, a, b}, times(after, 1 / length(after))});
      added_.push_back({vertexOf(c.v1), vertexOf(va), vertexOf(vb)});
    }
    return true;
  }

  // Tests the centroid of a new face and the side that is new.
  bool isNearOriginal(const Face& face) const {
    const SimplifyState& s = patch_.surface;
    const auto& [a, b, c] = face.corners;
    const Vec3d side = minus(b, a);
    if (!s.isNear(plus(a, times(side, 0.5))))
      return false;
    if (dot(side, side) > s.longSide)
      for (const double t : {0.25, 0.75})
        if (!s.isNear(plus(a, times(side, t))))
          return false;
    return s.isNear(times(plus(a, plus(b, c)), 1.0 / 3));
  }

  // The squared distance of a point from a face, or `limit` if it is not smaller. Most points are
  // beside or far from most faces: a lower bound, from the plane and the lines of the edges,
  // decides.
  static double squaredDistance(const Face& face, const Vec3d& p, double limit) {
    const std::array<Vec3d, 3> at{minus(face.corners[0], p), minus(face.corners[1], p),
                                  minus(face.corners[2], p)};
    const double height = dot(face.normal, at[0]), squared = height * height;
    bool isOver = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& a = at[k];
      const Vec3d& b = at[(k + 1) % 3];
      const double area = dot(face.normal, cross(a, b)); // twice; negative beyond this edge
      if (area >= 0)
        continue;
      isOver = false;
      const Vec3d edge = minus(b, a);
      if (area * area >= (limit - squared) * dot(edge, edge))
        return limit;
    }
    return isOver ? squared : nearestOnTriangle(at[0], at[1], at[2]).squared;
  }

  // Finds the nearest of faces_ whose normal agrees with that of a removed point.
  bool assign(std::uint32_t v) {
    const Vec3d& p = patch_.surface.points[v];
    double nearest = kHeldTolerance * kHeldTolerance;
    std::uint32_t owner = kNone;
    const std::array<float, 3>& n = patch_.surface.normals[v];
    for (const Face& face : faces_) {
      if (!(face.normal[0] * n[0] + face.normal[1] * n[1] + face.normal[2] * n[2] > kMinAgreement))
        continue;
      const double squared = squaredDistance(face, p, nearest);
      if (squared < nearest) {
        nearest = squared;
        owner = face.number;
        if (squared < 1e-12)
          break;
      }
    }
    if (owner == kNone)
      return false;
    gone_.push_back(v);
    owner_.push_back(owner);
    squares_.push_back(nearest);
    return true;
  }

  void keepPoints() {
    if (patch_.surface.original == nullptr)
      return;
    for (const std::uint32_t face : around_)
      firstGone(face) = kNone;
    // On large flat faces, every second point that lies on them is tested.
    const bool many = gone_.size() > kManyPoints;
    for (std::size_t i = 0; i < gone_.size(); ++i) {
      if (many && i % 2 == 1 && squares_[i] < kOnFace)
        continue;
      patch_.surface.nextGone[gone_[i]] = firstGone(owner_[i]);
      firstGone(owner_[i]) = gone_[i];
    }
  }

  Patch& patch_;
  std::array<bool, 2> merged_{};
  std::vector<Face> faces_;
  std::vector<CrossingGuard::Corners> added_;
  std::vector<std::uint32_t> around_, gone_, owner_;
  std::vector<double> squares_; ///< of the distances from gone_ to owner_
};

// OpenMesh's DecimaterT tests all modules for every half-edge around the vertices near a collapse.
// This class orders by cost alone and tests the tolerance when a vertex is first in the queue: the
// same collapses with a fraction of the tests (docs/benchmarks.md). The base class tests the edges.
class LazyDecimater : public OpenMesh::Decimater::BaseDecimaterT<HalfEdgeMesh> {
public:
  using Base = OpenMesh::Decimater::BaseDecimaterT<HalfEdgeMesh>;

  LazyDecimater(Patch& patch, Progress& progress)
      : Base(patch.mesh), patch_(patch), progress_(progress), cost_(patch), tolerance_(patch),
        stamp_(patch.mesh.n_vertices(), 0) {}

  /// Performs at most `max` collapses; returns their number.
  std::size_t decimate(std::size_t max) {
    for (const Vertex v : patch_.mesh.vertices())
      if (isOpen(v))
        enqueue(v);
    std::size_t collapses = 0;
    for (std::size_t steps = 0; !queue_.empty() && collapses < max; ++steps) {
      if (steps % 1024 == 0)
        progress_.check();
      const Entry entry = queue_.top();
      queue_.pop();
      const Vertex v(static_cast<int>(entry.vertex));
      if (!patch_.mesh.status(v).deleted() && stamp_[entry.vertex] == entry.stamp)
        collapses += tryToRemove(v);
    }
    return collapses;
  }

private:
  struct Entry {
    float cost;
    std::uint32_t vertex, stamp;
    bool operator<(const Entry& other) const { // the top of the queue is its largest element
      return cost != other.cost ? cost > other.cost : vertex > other.vertex;
    }
  };
  struct Choice {
    float cost;
    HalfEdge halfEdge;
    int end;
  };

  void choose(Vertex v) {
    choices_.clear();
    for (auto h = patch_.mesh.voh_begin(v); h.is_valid(); ++h)
      choices_.push_back(
          {cost_.of(Collapse(patch_.mesh, *h)), *h, patch_.mesh.to_vertex_handle(*h).idx()});
  }

  void enqueue(Vertex v) {
    choose(v);
    float min = std::numeric_limits<float>::infinity();
    for (const Choice& choice : choices_)
      min = std::min(min, choice.cost);
    ++stamp_[at(v)];
    if (!choices_.empty())
      queue_.push({min, static_cast<std::uint32_t>(v.idx()), stamp_[at(v)]});
  }

  bool tryToRemove(Vertex v) {
    choose(v);
    std::sort(choices_.begin(), choices_.end(), [](const Choice& a, const Choice& b) {
      return a.cost != b.cost ? a.cost < b.cost : a.end < b.end;
    });
    // Most edges fail at once where the surface moves to one side alone.
    int tries = patch_.surface.outward ? std::numeric_limits<int>::max() : kTries;
    for (const Choice& choice : choices_) {
      if (tries-- == 0)
        break;
      Collapse collapse(patch_.mesh, choice.halfEdge);
      if (!is_collapse_legal(collapse) || !tolerance_.allows(collapse))
        continue;
      tolerance_.prepare(collapse);
      for (auto n = patch_.mesh.vv_begin(v); n.is_valid(); ++n)
        isTested(*n) = 0;
      patch_.mesh.collapse(choice.halfEdge);
      cost_.collapsed(collapse);
      tolerance_.collapsed(collapse);
      neighbours_ = {collapse.v1};
      for (auto n = patch_.mesh.vv_begin(collapse.v1); n.is_valid(); ++n)
        neighbours_.push_back(*n);
      for (const Vertex n : neighbours_)
        if (isOpen(n))
          enqueue(n);
      return true;
    }
    isTested(v) = 1;
    return false;
  }

  // Whether a vertex may be removed, as far as is known. Flags of other regions' vertices, which
  // are locked, are not read: these may change meanwhile.
  bool isOpen(Vertex v) { return !patch_.mesh.status(v).locked() && isTested(v) == 0; }
  char& isTested(Vertex v) { return patch_.surface.isTested[patch_.vertexOf[at(v)]]; }

  Patch& patch_;
  Progress& progress_;
  Cost cost_;
  Tolerance tolerance_;
  std::priority_queue<Entry> queue_;
  std::vector<std::uint32_t> stamp_; ///< by vertex: its newest entry in the queue
  std::vector<Choice> choices_;
  std::vector<Vertex> neighbours_; ///< of the vertex that a collapse keeps, and itself
};

// Builds the region's faces as a half-edge mesh, with vertices in the surface's order, and sets the
// locked vertices and the features.
void build(Patch& patch, const CollapseRegion& region, const std::vector<std::uint32_t>& regionOf) {
  const SimplifyState& s = patch.surface;
  HalfEdgeMesh& mesh = patch.mesh;
  patch.faceOf = region.faces;
  std::vector<CrossingGuard::Corners> corners;
  for (const std::uint32_t face : patch.faceOf)
    for (std::size_t k = 0; k < 3; ++k)
      patch.vertexOf.push_back(s.mesh.triangles[3 * std::size_t(face) + k]);
  std::sort(patch.vertexOf.begin(), patch.vertexOf.end());
  patch.vertexOf.erase(std::unique(patch.vertexOf.begin(), patch.vertexOf.end()),
                       patch.vertexOf.end());
  const auto numberOf = [&](std::uint32_t v) {
    const auto found = std::lower_bound(patch.vertexOf.begin(), patch.vertexOf.end(), v);
    return Vertex(static_cast<int>(found - patch.vertexOf.begin()));
  };
  mesh.reserve(patch.vertexOf.size(), 2 * patch.faceOf.size(), patch.faceOf.size());
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_halfedge_status();
  mesh.request_face_status();
  for (const std::uint32_t v : patch.vertexOf) {
    const Vec3d& p = s.points[v];
    mesh.status(mesh.add_vertex({p[0], p[1], p[2]})).set_locked(regionOf[v] != region.number);
  }
  for (const std::uint32_t face : patch.faceOf) {
    const std::uint32_t* v = &s.mesh.triangles[3 * std::size_t(face)];
    corners.push_back({v[0], v[1], v[2]});
    if (!mesh.add_face(numberOf(v[0]), numberOf(v[1]), numberOf(v[2])).is_valid())
      throw Error(Status::Invalid, "", "the surface is not a closed manifold");
    if (!isFaceWithin(region.number, &s.mesh.triangles[3 * std::size_t(face)], regionOf))
      for (std::size_t k = 0; k < 3; ++k)
        mesh.status(numberOf(v[k])).set_locked(true);
  }
  for (const std::uint32_t face : region.others) {
    const std::uint32_t* v = &s.mesh.triangles[3 * std::size_t(face)];
    corners.push_back({v[0], v[1], v[2]});
  }
  std::vector<std::uint8_t> count(patch.vertexOf.size(), 0);
  for (const VertexPair& edge : region.features) {
    const Vertex a = numberOf(edge[0]), b = numberOf(edge[1]);
    mesh.status(mesh.edge_handle(mesh.find_halfedge(a, b))).set_feature(true);
    for (const Vertex v : {a, b}) {
      mesh.status(v).set_feature(true);
      count[at(v)] = static_cast<std::uint8_t>(std::min(count[at(v)] + 1, 3));
    }
  }
  for (const auto v : mesh.vertices()) // corners, and end points of open creases
    if (mesh.status(v).feature() && count[at(v)] != 2)
      mesh.status(v).set_locked(true);
  if (patch.guarded.size() > 0)
    patch.guard = std::make_unique<CrossingGuard>(s.mesh.points, std::move(corners));
}

} // namespace

std::size_t collapseEdges(SimplifyState& state, CollapseRegion& region,
                          const std::vector<std::uint32_t>& regionOf, const BoxTree& guarded,
                          std::size_t max, Progress& progress) {
  if (region.faces.empty())
    return 0;
  Patch patch(state, guarded);
  build(patch, region, regionOf);
  LazyDecimater decimater(patch, progress);
  const std::size_t collapses = decimater.decimate(max);
  HalfEdgeMesh& mesh = patch.mesh;
  for (const auto face : mesh.all_faces()) {
    const std::uint32_t number = patch.faceOf[at(face)];
    if (!isFaceWithin(region.number, &state.mesh.triangles[3 * std::size_t(number)], regionOf))
      continue;
    state.isGone[number] = mesh.status(face).deleted();
    std::size_t k = 3 * std::size_t(number);
    if (!state.isGone[number])
      for (const auto v : mesh.fv_range(face))
        state.mesh.triangles[k++] = patch.vertexOf[at(v)];
  }
  region.features.clear();
  for (const auto edge : mesh.edges()) {
    const std::uint32_t a = patch.vertexOf[at(edge.v0())], b = patch.vertexOf[at(edge.v1())];
    if (mesh.status(edge).feature() && regionOf[a] == region.number && regionOf[b] == region.number)
      region.features.push_back({std::min(a, b), std::max(a, b)});
  }
  return collapses;
}

} // namespace tetvdb
