// SPDX-License-Identifier: Apache-2.0
//
// A closed manifold whose edges can be collapsed. Half-edge h = 3 face + k runs from corner k of
// the face to the next corner.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tetvdb {

class HalfEdges {
public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  /// Throws Error(Invalid) unless every edge has two faces that run along it in opposite
  /// directions. That vertices have one fan each is not checked.
  explicit HalfEdges(const TriangleMesh& mesh)
      : start_(mesh.triangles), twin_(mesh.triangles.size(), kNone),
        out_(mesh.points.size(), kNone) {
    const EdgeTable edges(mesh);
    for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
      const EdgeTable::Sides sides = edges.sides(edge);
      if (sides.size() != 2 || start(sides.first[0]) == start(sides.first[1]))
        throw Error(Status::Invalid, "", "the surface is no closed manifold");
      twin_[sides.first[0]] = sides.first[1];
      twin_[sides.first[1]] = sides.first[0];
    }
    for (std::size_t h = start_.size(); h-- > 0;)
      out_[start_[h]] = static_cast<std::uint32_t>(h);
  }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t start(std::uint32_t h) const { return start_[h]; }
  std::uint32_t end(std::uint32_t h) const { return start_[next(h)]; }
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }
  /// A half-edge that starts at a vertex; kNone once the vertex is gone, or if no face uses it.
  std::uint32_t out(std::uint32_t vertex) const { return out_[vertex]; }
  /// The next one around its start.
  std::uint32_t turn(std::uint32_t h) const { return twin_[previous(h)]; }
  bool isDeleted(std::uint32_t face) const { return start_[3 * std::size_t(face)] == kNone; }
  std::uint32_t faceCount() const { return static_cast<std::uint32_t>(start_.size() / 3); }

  template <class Visit>
  void forEachOut(std::uint32_t vertex, const Visit& visit) const {
    const std::uint32_t first = out_[vertex];
    std::uint32_t h = first;
    do {
      visit(h);
      h = turn(h);
    } while (h != first);
  }

  /// Moves the start of h onto its end; the two faces at h vanish. The caller has made sure that
  /// the ends of h have exactly two neighbours in common, of four faces or more each. Writes only
  /// to half-edges of faces around the start, and to the twins and out() of these faces' corners.
  void collapse(std::uint32_t h) {
    const std::uint32_t from = start(h), to = end(h), back = twin_[h];
    const std::uint32_t left = start(previous(h)), right = start(previous(back));
    const std::uint32_t toLeft = twin_[previous(h)], fromLeft = twin_[next(h)];
    const std::uint32_t fromRight = twin_[next(back)], toRight = twin_[previous(back)];
    for (std::uint32_t corner = turn(h); corner != h;) {
      const std::uint32_t following = turn(corner);
      start_[corner] = to;
      corner = following;
    }
    join(toLeft, fromLeft);
    join(fromRight, toRight);
    out_[from] = kNone;
    out_[to] = toLeft;
    out_[left] = fromLeft;
    out_[right] = fromRight;
    erase(h / 3);
    erase(back / 3);
  }

private:
  void join(std::uint32_t a, std::uint32_t b) {
    twin_[a] = b;
    twin_[b] = a;
  }
  void erase(std::uint32_t face) {
    for (std::size_t k = 0; k < 3; ++k)
      start_[3 * std::size_t(face) + k] = twin_[3 * std::size_t(face) + k] = kNone;
  }

  std::vector<std::uint32_t> start_, twin_, out_;
};

} // namespace tetvdb
