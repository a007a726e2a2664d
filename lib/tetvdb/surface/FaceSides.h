// SPDX-License-Identifier: Apache-2.0
//
// Which way every face of a mesh has to look: the steps of cleanTriangles() that turn faces. The
// mesh stays as it is until all is decided. docs/algorithms.md has the rules.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FacePatches.h"
#include "tetvdb/surface/TriangleScene.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace tetvdb {

/// The mesh and the table must outlive it.
class FaceSides {
public:
  FaceSides(const TriangleMesh& mesh, const EdgeTable& edges, Progress& progress);

  /// Makes the faces of every patch agree that can; the way that leaves the larger area as it is,
  /// where faces `withoutSide` (1, by face; may be empty) do not count.
  void alignPatches(const std::vector<std::uint8_t>& withoutSide);
  /// In shells where the sides of an edge of several faces do not balance: turns patches so that
  /// what is outside of the shell, as rays see it, lies before them. (AlignByVisibility.cpp)
  void alignByVisibility(Progress& progress);
  /// Turns shells that are inside out, with what is nested in them. (TurnShells.cpp)
  void turnShells(Progress& progress);

  /// Whether every shell is closed and has a volume clearly above 0. Patches are aligned.
  bool allShellsLookOutward() const;

  const std::vector<std::uint8_t>& turned() const { return turned_; } ///< by face
  const FacePatches& patches() const { return patches_; }
  double area(std::uint32_t face) const { return areas_[face]; }
  std::uint32_t shellCount() const { return shellCount_; } ///< once patches are aligned
  std::uint32_t shellOfPatch(std::uint32_t patch) const { return shellOf_[patch]; }
  std::size_t turnedShells() const { return turnedShells_; }
  bool insideOut() const { return insideOut_; } ///< the roots of most volume were turned

private:
  struct Shell;

  Vec3d normal(std::uint32_t face) const; ///< as turned; its length is twice the area
  Vec3d centroid(std::uint32_t face) const;
  std::uint32_t shellOf(std::uint32_t face) const { return shellOf_[patches_.patchOf[face]]; }
  int direction(std::uint32_t side) const { // as turned: 1 where it ascends, -1
    return edges_.ascends(side) != (turned_[EdgeTable::faceOf(side)] != 0) ? 1 : -1;
  }
  /// Calls visit(patch, imbalance) for every patch at an edge; imbalance: sides that ascend
  /// less those that descend.
  template <typename Visit>
  void eachPatchAt(std::uint32_t edge, const Visit& visit) const;
  void findShells();

  /// Of the mesh as given, built when first asked for.
  const TriangleScene& scene();
  /// The `number`-th of fixed directions from a face, of length 1.
  static Vec3d directionFrom(std::uint32_t face, std::uint32_t number);
  /// Crossings of the ray from the centroid of a face, apart from those with the face itself.
  void shoot(std::uint32_t face, const Vec3d& direction,
             std::vector<TriangleScene::Hit>& hits) const;

  enum class Balance : std::uint8_t {
    Even,
    Odd,  ///< of three faces or so one is left over
    Wrong ///< sides do not cancel that could
  };
  /// What faces say about which way they look.
  struct Poll {
    int asked = 0, outward = 0, inward = 0;
    /// Nine of ten that know say so, and half of all know.
    bool isSureOf(int votes) const {
      return 10 * votes >= 9 * (outward + inward) && 2 * (outward + inward) >= asked && votes > 0;
    }
  };
  static constexpr std::size_t kFacesPerPoll = 32;

  std::vector<Balance> balanceOfShells() const;
  int visibilityVote(std::uint32_t face) const;
  Poll poll(const std::uint32_t* begin, const std::uint32_t* end, std::size_t faces) const;

  std::vector<Shell> measureShells() const;
  void askOpenShells(std::vector<Shell>& shells, Progress& progress);
  void findContainers(std::vector<Shell>& ranked, Progress& progress);

  const TriangleMesh& mesh_;
  const EdgeTable& edges_;
  FacePatches patches_;
  std::vector<double> areas_; ///< by face
  double diagonal_ = 0;       ///< of the mesh's box
  std::vector<std::uint8_t> turned_;
  std::vector<std::uint8_t> sideless_; ///< by patch: 1 where no face has a side of its own
  /// By patch. Patches whose sides at an edge do not balance belong together there; one that is
  /// balanced by itself only touches the others: two boxes with an edge in common are two shells.
  std::vector<std::uint32_t> shellOf_;
  std::uint32_t shellCount_ = 0;
  std::unique_ptr<TriangleScene> scene_;
  std::size_t turnedShells_ = 0;
  bool insideOut_ = false;
};

} // namespace tetvdb
