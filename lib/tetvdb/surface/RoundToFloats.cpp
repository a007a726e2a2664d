// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/RoundToFloats.h"

#include "tetvdb/geometry/Orientation.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/CrossingGuard.h"
#include "tetvdb/surface/FloatPositions.h"
#include "tetvdb/surface/HalfEdgeMesh.h"
#include "tetvdb/surface/SelfIntersections.h"
#include "tetvdb/surface/SeparatePoints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kFirstReach = 1, kLastReach = 11; // powers of two of the unit in the last place
constexpr int kFloatDigits = 24;
constexpr std::size_t kMaxFan = 64; // faces around points that are moved or contracted

using Corners = CrossingGuard::Corners;
using Vertex = HalfEdgeMesh::VertexHandle;
using Edge = HalfEdgeMesh::EdgeHandle;
using HalfEdge = HalfEdgeMesh::HalfedgeHandle;
using Face = HalfEdgeMesh::FaceHandle;

std::uint32_t numberOf(OpenMesh::BaseHandle handle) {
  return static_cast<std::uint32_t>(handle.idx());
}

// Mends faces of rounded points that meet others or have no area.
class RoundedFaces {
public:
  RoundedFaces(TriangleMesh& mesh, HalfEdgeMesh& halfEdges, FloatRounding& rounding)
      : mesh_(mesh), halfEdges_(halfEdges), rounding_(rounding),
        guard_(mesh.points, cornersOf(mesh)) {
    double size = 0;
    for (const Vec3d& p : mesh.points) {
      used_.insert(asFloats(p));
      for (const double c : p)
        size = std::max(size, std::abs(c));
    }
    int exponent = 0;
    std::frexp(size, &exponent);
    unit_ = std::ldexp(1.0, exponent - kFloatDigits);
    halfEdges.request_vertex_status();
    halfEdges.request_edge_status();
    halfEdges.request_halfedge_status();
    halfEdges.request_face_status();
  }

  // Of these faces, and those that are changed for them.
  void mend(std::vector<std::uint32_t> faces, Progress& progress) {
    for (int reach = kFirstReach; reach <= kLastReach && !faces.empty(); ++reach) {
      reach_ = std::ldexp(unit_, reach);
      changed_ = faces;
      for (const std::uint32_t face : faces) {
        progress.check();
        while (isBad(face) && improve(face)) {
        }
      }
      faces = std::move(changed_);
      std::sort(faces.begin(), faces.end());
      faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
      faces.erase(std::remove_if(faces.begin(), faces.end(),
                                 [&](std::uint32_t face) { return !isBad(face); }),
                  faces.end());
    }
  }

  // Replaces the faces of the mesh.
  void finish() {
    std::vector<char> drops(mesh_.triangleCount(), 0);
    for (std::uint32_t face = 0; face < drops.size(); ++face) {
      drops[face] = isGone(face);
      const Corners& corners = guard_.corners(face);
      std::copy(corners.begin(), corners.end(), &mesh_.triangles[3 * std::size_t(face)]);
    }
    dropFaces(mesh_, drops);
    dropUnusedPoints(mesh_);
  }

private:
  static std::vector<Corners> cornersOf(const TriangleMesh& mesh) {
    std::vector<Corners> faces(mesh.triangleCount());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      faces[i / 3][i % 3] = mesh.triangles[i];
    return faces;
  }

  bool isGone(std::uint32_t face) const {
    return halfEdges_.status(Face(static_cast<int>(face))).deleted();
  }
  bool isBad(std::uint32_t face) {
    if (isGone(face))
      return false;
    replaced_.assign(1, face);
    added_.assign(1, guard_.corners(face));
    return guard_.crosses(added_, replaced_);
  }

  // Whether an operation at the face left fewer pairs that meet.
  bool improve(std::uint32_t number) {
    const Face face(static_cast<int>(number));
    std::array<HalfEdge, 3> sides;
    std::copy(halfEdges_.cfh_begin(face), halfEdges_.cfh_end(face), sides.begin());
    for (const HalfEdge side : sides)
      if (flips(halfEdges_.edge_handle(side)))
        return true;
    for (const HalfEdge side : sides)
      if (moves({halfEdges_.to_vertex_handle(side)}))
        return true;
    for (const HalfEdge side : sides)
      if (contracts(side) || contracts(halfEdges_.opposite_halfedge_handle(side)))
        return true;
    for (const HalfEdge side : sides)
      if (moves({halfEdges_.from_vertex_handle(side), halfEdges_.to_vertex_handle(side)}))
        return true;
    return false;
  }

  bool flips(Edge edge) {
    const HalfEdge h = halfEdges_.halfedge_handle(edge, 0), o = halfEdges_.halfedge_handle(edge, 1);
    const std::uint32_t a = numberOf(halfEdges_.from_vertex_handle(h)),
                        b = numberOf(halfEdges_.to_vertex_handle(h)),
                        c = numberOf(halfEdges_.opposite_vh(h)),
                        d = numberOf(halfEdges_.opposite_vh(o));
    if (!halfEdges_.is_flip_ok(edge) || !areNear(a, b, c, d))
      return false;
    replaced_ = {numberOf(halfEdges_.face_handle(h)), numberOf(halfEdges_.face_handle(o))};
    added_ = {{a, d, c}, {d, b, c}};
    const Vec3d before = plus(normalOf(guard_.corners(replaced_[0])), // of both faces
                              normalOf(guard_.corners(replaced_[1])));
    if (!(dot(normalOf(added_[0]), before) > 0) || !(dot(normalOf(added_[1]), before) > 0) ||
        !leavesFewer(crossingsOfReplaced()))
      return false;
    halfEdges_.flip(edge);
    // OpenMesh decides which face takes which corners.
    for (const std::uint32_t face : replaced_) {
      std::size_t k = 0;
      Corners corners{};
      for (const Vertex v : halfEdges_.fv_range(Face(static_cast<int>(face))))
        corners[k++] = numberOf(v);
      guard_.change(face, corners);
    }
    took(rounding_.flippedEdges, 1, 0);
    return true;
  }

  // Whether the lines through a, b and through c, d pass one another within the reach.
  bool areNear(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const std::vector<Vec3d>& p = mesh_.points;
    const Vec3d normal = cross(minus(p[b], p[a]), minus(p[d], p[c]));
    return std::abs(dot(normal, minus(p[c], p[a]))) <= reach_ * length(normal);
  }

  // All by the same way.
  bool moves(const std::vector<Vertex>& vertices) {
    if (!takeFans(vertices))
      return false;
    const std::size_t before = crossingsOfReplaced();
    if (before == 0)
      return false;
    added_.clear();
    std::vector<Vec3d> normals, from;
    for (const std::uint32_t face : replaced_) {
      added_.push_back(guard_.corners(face));
      normals.push_back(normalOf(added_.back()));
    }
    for (const Vertex v : vertices)
      from.push_back(mesh_.points[numberOf(v)]);
    // Returns false if one of the positions is another point's.
    const auto place = [&](const Vec3d& way) {
      std::set<FloatPosition> taken;
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        Vec3d& p = mesh_.points[numberOf(vertices[i])];
        p = nearestFloats(plus(from[i], way));
        if (used_.count(asFloats(p)) == 0)
          taken.insert(asFloats(p));
      }
      return taken.size() == vertices.size();
    };
    const auto setUsed = [&] {
      for (const Vertex v : vertices)
        used_.insert(asFloats(mesh_.points[numberOf(v)]));
    };
    for (const Vec3d& p : from)
      used_.erase(asFloats(p));
    for (double step = unit_; step <= reach_; step *= 2)
      for (int way = 1; way < 27; ++way) { // not 0, which stays
        const std::array<int, 3> digits{way % 3, way / 3 % 3, way / 9};
        Vec3d by;
        for (std::size_t axis = 0; axis < 3; ++axis)
          by[axis] = step * (digits[axis] < 2 ? digits[axis] : -1);
        if (!place(by) || !keepNormals(normals) || !leavesFewer(before))
          continue;
        setUsed();
        for (std::size_t i = 0; i < replaced_.size(); ++i)
          guard_.change(replaced_[i], added_[i]);
        took(rounding_.movedPoints, vertices.size(), length(by));
        return true;
      }
    place({0, 0, 0});
    setUsed();
    return false;
  }

  // Into its end point.
  bool contracts(HalfEdge side) {
    const Vertex from = halfEdges_.from_vertex_handle(side), to = halfEdges_.to_vertex_handle(side);
    const double far = length(minus(mesh_.points[numberOf(to)], mesh_.points[numberOf(from)]));
    if (far > reach_ || !halfEdges_.is_collapse_ok(side) || !takeFans({from}))
      return false;
    const std::size_t before = crossingsOfReplaced();
    const std::uint32_t left = numberOf(halfEdges_.face_handle(side)),
                        right = numberOf(
                            halfEdges_.face_handle(halfEdges_.opposite_halfedge_handle(side)));
    std::vector<std::uint32_t> kept;
    std::vector<Vec3d> normals;
    added_.clear();
    for (const std::uint32_t face : replaced_) {
      if (face == left || face == right)
        continue;
      kept.push_back(face);
      normals.push_back(normalOf(guard_.corners(face)));
      added_.push_back(guard_.corners(face));
      std::replace(added_.back().begin(), added_.back().end(), numberOf(from), numberOf(to));
    }
    if (!keepNormals(normals) || !leavesFewer(before))
      return false;
    halfEdges_.collapse(side);
    guard_.remove(left);
    guard_.remove(right);
    for (std::size_t i = 0; i < kept.size(); ++i)
      guard_.change(kept[i], added_[i]);
    replaced_ = kept;
    took(rounding_.contractedEdges, 1, far);
    return true;
  }

  // Sets `replaced_` to the faces around vertices.
  bool takeFans(const std::vector<Vertex>& vertices) {
    replaced_.clear();
    for (const Vertex vertex : vertices)
      for (const Face face : halfEdges_.vf_range(vertex))
        replaced_.push_back(numberOf(face));
    std::sort(replaced_.begin(), replaced_.end());
    replaced_.erase(std::unique(replaced_.begin(), replaced_.end()), replaced_.end());
    return replaced_.size() <= kMaxFan;
  }

  std::size_t crossingsOfReplaced() {
    std::vector<Corners> faces;
    for (const std::uint32_t face : replaced_)
      faces.push_back(guard_.corners(face));
    return guard_.crossings(faces, replaced_, SIZE_MAX);
  }
  bool leavesFewer(std::size_t before) {
    return guard_.crossings(added_, replaced_, before) < before;
  }

  // Whether the added faces are turned by less than a right angle; thinner ones than the reach may
  // turn further, since rounding may have turned them over.
  bool keepNormals(const std::vector<Vec3d>& before) const {
    for (std::size_t i = 0; i < added_.size(); ++i) {
      double longest = 0;
      for (std::size_t k = 0; k < 3; ++k)
        longest = std::max(longest, length(minus(mesh_.points[added_[i][(k + 1) % 3]],
                                                 mesh_.points[added_[i][k]])));
      const double twiceArea = length(before[i]);
      if (twiceArea > 2 * reach_ * longest && !(dot(normalOf(added_[i]), before[i]) > 0))
        return false;
    }
    return true;
  }

  Vec3d normalOf(const Corners& corners) const {
    const std::vector<Vec3d>& p = mesh_.points;
    return cross(minus(p[corners[1]], p[corners[0]]), minus(p[corners[2]], p[corners[0]]));
  }

  void took(std::size_t& count, std::size_t more, double move) {
    count += more;
    rounding_.largestMove = std::max(rounding_.largestMove, move);
    changed_.insert(changed_.end(), replaced_.begin(), replaced_.end());
  }

  TriangleMesh& mesh_; ///< its faces are those of the guard until finish()
  HalfEdgeMesh& halfEdges_;
  FloatRounding& rounding_;
  CrossingGuard guard_;
  std::set<FloatPosition> used_;
  double unit_ = 0;                    ///< in the last place of the largest coordinate
  double reach_ = 0;                   ///< of operations, world units
  std::vector<std::uint32_t> changed_; ///< faces at this reach, and those to begin with
  std::vector<Corners> added_;         ///< of an operation, in place of these:
  std::vector<std::uint32_t> replaced_;
};

// The faces of a mesh, apart by whether they have an area.
struct FacesByArea {
  std::vector<std::uint32_t> with, corners; ///< of each with an area, three corners
  std::vector<std::uint32_t> without;

  explicit FacesByArea(const TriangleMesh& mesh) {
    for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face) {
      const std::uint32_t* c = &mesh.triangles[3 * std::size_t(face)];
      if (areCollinear(mesh.points[c[0]], mesh.points[c[1]], mesh.points[c[2]])) {
        without.push_back(face);
        continue;
      }
      with.push_back(face);
      corners.insert(corners.end(), c, c + 3);
    }
  }
};

// Faces without area, then faces at a point of `moved` that meet others.
std::vector<std::uint32_t> badFaces(const TriangleMesh& mesh, const std::vector<char>& moved,
                                    Progress& progress) {
  const FacesByArea faces(mesh);
  std::vector<char> looked(faces.with.size(), 0);
  for (std::size_t i = 0; i < faces.corners.size(); ++i)
    looked[i / 3] = looked[i / 3] != 0 || moved[faces.corners[i]] != 0;
  std::vector<std::uint32_t> bad = faces.without;
  for (const std::uint32_t i : facesThatMeetOthers(mesh.points, faces.corners, looked, progress))
    bad.push_back(faces.with[i]);
  return bad;
}

std::size_t crossingsOf(const TriangleMesh& mesh, Progress& progress) {
  const FacesByArea faces(mesh);
  return faces.without.size() +
         countIntersections(mesh.points, faces.corners, SIZE_MAX, progress).pairs;
}

} // namespace

FloatRounding roundToFloats(TriangleMesh& mesh, Progress& progress) {
  FloatRounding rounding;
  std::vector<char> moved(mesh.points.size(), 0);
  for (std::size_t point = 0; point < moved.size(); ++point) {
    const Vec3d to = nearestFloats(mesh.points[point]);
    moved[point] = to != mesh.points[point];
    rounding.roundedPoints += to != mesh.points[point];
    mesh.points[point] = to;
  }
  if (rounding.roundedPoints == 0)
    return rounding;
  HalfEdgeMesh halfEdges;
  const std::vector<Vec3d> before = mesh.points;
  rounding.complete = addClosedManifold(halfEdges, mesh.points.size(), mesh.triangles) &&
                      separateEqualPoints(mesh, mesh.points.size(), progress).complete;
  if (!rounding.complete)
    return rounding;
  for (std::size_t point = 0; point < moved.size(); ++point)
    moved[point] = moved[point] != 0 || mesh.points[point] != before[point];
  const std::vector<std::uint32_t> bad = badFaces(mesh, moved, progress);
  rounding.crossingFaces = bad.size();
  if (bad.empty())
    return rounding;
  RoundedFaces faces(mesh, halfEdges, rounding);
  faces.mend(bad, progress);
  faces.finish();
  rounding.crossings = crossingsOf(mesh, progress);
  return rounding;
}

} // namespace tetvdb
