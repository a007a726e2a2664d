// SPDX-License-Identifier: Apache-2.0
//
// The mesh that the mesher works on: tets with their neighbours, and faces with the input surfaces
// that they lie on.
//
// Every change goes through replace(), collapse() or move(): a set of connected tets is replaced by
// others that fill the same space. Tets are positive and the mesh is conforming before and after.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/geometry/TetFaces.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace tetvdb {

/// Signed multiplicities of the inputs' surfaces on a face, or winding numbers in a tet: digit k in
/// base 2^bits (balanced, from -2^(bits-1) up) is that of input k. Chains are added and negated as
/// integers.
using Chain = std::int32_t;
/// Inputs that one mesh can tell apart: 3 bits each, multiplicities of -4 to 3.
constexpr std::size_t kMaxInputs = 10;
/// Bits of a digit for that many inputs.
constexpr int chainBits(std::size_t inputs) {
  return inputs <= 1 ? 32 : static_cast<int>(32 / inputs);
}
/// The chain of weight 1 of an input.
constexpr Chain unitChain(std::size_t input, std::size_t inputs) {
  return input == 0 ? 1
                    : static_cast<Chain>(std::uint32_t(1)
                                         << (chainBits(inputs) * static_cast<int>(input)));
}

/// The corners k, l that make (i, j, k, l) an even permutation: for a positive tet the tet of these
/// corners in this order is positive too. Nothing for i = j.
constexpr std::array<std::array<std::array<std::uint8_t, 2>, 4>, 4> kEdgeOthers{
    {{{{0, 0}, {2, 3}, {3, 1}, {1, 2}}},
     {{{3, 2}, {0, 0}, {0, 3}, {2, 0}}},
     {{{1, 3}, {3, 0}, {0, 0}, {0, 1}}},
     {{{2, 1}, {0, 2}, {1, 0}, {0, 0}}}}};

class TetComplex {
public:
  static constexpr std::uint32_t kOutside = 0xFFFFFFFFu; ///< neighbour: beyond the box
  /// Neighbours from here on, below kOutside, lie in another part (TetParts.h).
  static constexpr std::uint32_t kElsewhere = 0x80000000u;
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  struct alignas(64) Tet {
    std::array<std::uint32_t, 4> corners; ///< [0] is kNone where the tet is gone
    std::array<std::uint32_t, 4> neighbours;
    /// Of the face opposite each corner: the surfaces on it, positive where they look out of this
    /// tet. The winding number here is that of the neighbour plus this.
    std::array<Chain, 4> chains;
    std::array<bool, 4> tracked; ///< the face lies on input, its chain may be 0 where sheets cancel
    float energy;                ///< for the owner of the complex; replace() sets it to 0
    std::uint32_t mark;          ///< private to TetComplex
    /// Weight of the tet's energy: less where quality matters less. Differs across tracked faces
    /// alone.
    float weight = 1;

    bool exists() const { return corners[0] != kNone; }
    /// Which corner a point is; 4: none.
    unsigned cornerOf(std::uint32_t point) const {
      return corners[0] == point   ? 0u
             : corners[1] == point ? 1u
             : corners[2] == point ? 2u
             : corners[3] == point ? 3u
                                   : 4u;
    }
  };

  struct Point {
    Vec3d at;                  ///< lattice point
    std::uint32_t tet = kNone; ///< one that has it for a corner; kNone: the point is gone
    bool fixed = false;        ///< on the box's sides or between parts: never moved or removed
    bool onBoundary = false;   ///< on a boundary edge of the input: stays within their envelope
    /// Every change around the point sets all bits; an operation that fails here clears its own.
    std::uint8_t changed = 0xFF;
    std::uint8_t fineness = 0; ///< how short edges shall be here (EdgeSizes.h)
    bool exists() const { return tet != kNone; }
    void setChanged(std::uint8_t bits) { changed = static_cast<std::uint8_t>(changed | bits); }
    void clearChanged(std::uint8_t bits) { changed = static_cast<std::uint8_t>(changed & ~bits); }
  };

  std::vector<Point> points;
  std::vector<Tet> tets;

  const Vec3d& at(std::uint32_t point) const { return points[point].at; }
  /// Tets that exist.
  std::size_t tetCount() const { return tets.size() - free_.size(); }

  /// A tet to add: `corners` positive. Faces between two new tets get `chains` and `tracked`, which
  /// must agree in both tets; on faces next to old tets they are added to what the face has.
  struct NewTet {
    std::array<std::uint32_t, 4> corners;
    std::array<Chain, 4> chains{0, 0, 0, 0};
    std::array<bool, 4> tracked{false, false, false, false};
    float weight = 1;
  };

  /// Replaces `old` by `fresh`, which fill the same space and have the same outer faces. New tets
  /// take the numbers of old ones first. Points that lose all their tets are gone. Costs about 30
  /// ns a face.
  void replace(const std::vector<std::uint32_t>& old, const std::vector<NewTet>& fresh);

  /// Removes point `from`; tets around it get `to` for this corner, and tets with both are removed.
  /// `star` is star(from), all of it in this part; `to` is joined to it by an edge; the tets that
  /// stay have to be positive. Where a tet (from, to, x, y) is removed, the faces (from, x, y) and
  /// (to, x, y) become one: their chains add up, and it is tracked where one was. Not for pairs of
  /// which (to, x, y) lies between parts and (from, x, y) is tracked. Energies become 0. Some ten
  /// ns a tet.
  void collapse(std::uint32_t from, std::uint32_t to, const std::vector<std::uint32_t>& star);

  /// Moves a point; all tets around it have to stay positive. `star` is star(point); energies
  /// become 0.
  void move(std::uint32_t point, const Vec3d& to, const std::vector<std::uint32_t>& star);

  /// Moves a tet to the other side of its tracked faces: it gets the winding number there, and
  /// `weight`; these faces lose their chains, and its others get them. Tracked faces have to have
  /// the same chain, others none, and all neighbours to be in this part.
  void crossOver(std::uint32_t t, float weight);

  /// Adds a point without tets; it exists once replace() gives it some.
  std::uint32_t addPoint(const Vec3d& at);

  /// The tets around a point, in an order that depends on the mesh alone. Of a fixed point only
  /// those that are connected within this part. Stops once there are more than `enough`.
  void star(std::uint32_t point, std::vector<std::uint32_t>& out,
            std::size_t enough = std::numeric_limits<std::size_t>::max()) const;

  /// The tets around edge a-b in turn, and the points opposite: tet i has ring points i and i + 1,
  /// and the ring turns counter-clockwise seen from b. False, with the tets found, where the ring
  /// is not closed, as on the box's sides and between parts; without tets where there is no edge.
  /// `first`, a tet with this edge, saves the search for one.
  bool ring(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& tetsAround,
            std::vector<std::uint32_t>& ringPoints, std::uint32_t first = kNone) const;

  /// Whether there are more than `count` tets around a point; no more than these are visited.
  bool hasMoreTets(std::uint32_t point, std::size_t count) const;

  /// A tet that has edge a-b, in this part; kNone: there is none.
  std::uint32_t tetAtEdge(std::uint32_t a, std::uint32_t b) const;

  /// The local face of tet `t`, 0..3, whose neighbour is `other`.
  unsigned localFaceOf(std::uint32_t t, std::uint32_t other) const;

  /// Whether the tet is positive, exactly.
  bool isPositive(const std::array<std::uint32_t, 4>& corners) const {
    return latticeOrientation(at(corners[0]), at(corners[1]), at(corners[2]), at(corners[3])) > 0;
  }

  /// For tests and debug builds: every tet positive, neighbours mutual and over the same three
  /// points with opposite chains and the same tracking, every point's tet its own. Throws
  /// std::logic_error that says what is wrong. Linear.
  void verify() const;

private:
  std::uint32_t nextMark() const;
  void openFaces(const std::vector<std::uint32_t>& old);
  std::uint32_t addTet(const NewTet& one);
  void joinFace(std::uint32_t t, unsigned localFace);

  std::vector<std::uint32_t> free_; // numbers of tets that are gone
  mutable std::uint32_t mark_ = 0;
  mutable std::vector<std::uint32_t> stack_;
  // Scratch of replace(): faces by their points.
  struct OpenFace {
    std::array<std::uint32_t, 3> key;
    std::uint32_t tet, localFace; // of the new tet; of the old neighbour where `border`
    Chain chain;
    bool tracked, border;
    std::uint32_t round;
  };
  std::vector<OpenFace> faces_;
  std::uint32_t faceRound_ = 0;
  OpenFace& findFace(const std::array<std::uint32_t, 3>& key);

  friend class TetParts;
};

} // namespace tetvdb
