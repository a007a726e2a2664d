// SPDX-License-Identifier: Apache-2.0
//
// Determines the orientation of every face of a mesh: the steps of cleanTriangles() that reverse
// faces. The mesh itself is not changed. docs/algorithms.md has the rules.
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

  /// A scene of the mesh, for rays; without it the first step that needs one builds it. It must
  /// outlive this.
  void setScene(const TriangleScene& scene) { scene_ = &scene; }

  /// Orients the faces of each orientable patch consistently. Keeps the orientation of the larger
  /// area, not counting faces with `withoutSide` 1 (by face; may be empty).
  void alignPatches(const std::vector<std::uint8_t>& withoutSide);
  /// Reverses patches of shells whose orientations do not balance at edges of several faces, so
  /// that their front sides face the outside, as seen by rays. (AlignByVisibility.cpp)
  void alignByVisibility(Progress& progress);
  /// Reverses shells that are inside out, with the shells nested in them. (TurnShells.cpp)
  void turnShells(Progress& progress);

  /// Whether every shell is closed and has a volume clearly above 0. Requires aligned patches.
  bool allShellsLookOutward() const;

  const std::vector<std::uint8_t>& turned() const { return turned_; } ///< by face
  const FacePatches& patches() const { return patches_; }
  double area(std::uint32_t face) const { return areas_[face]; }
  std::uint32_t shellCount() const { return shellCount_; } ///< after alignPatches()
  std::uint32_t shellOfPatch(std::uint32_t patch) const { return shellOf_[patch]; }
  std::size_t turnedShells() const { return turnedShells_; }
  bool insideOut() const { return insideOut_; } ///< most of the outermost volume was reversed

private:
  struct Shell;

  Vec3d normal(std::uint32_t face) const; ///< as reversed; its length is twice the area
  Vec3d centroid(std::uint32_t face) const;
  std::uint32_t shellOf(std::uint32_t face) const { return shellOf_[patches_.patchOf[face]]; }
  int direction(std::uint32_t side) const { // with the new orientation: 1 if it ascends, else -1
    return edges_.ascends(side) != (turned_[EdgeTable::faceOf(side)] != 0) ? 1 : -1;
  }
  /// Calls visit(patch, imbalance) for every patch at an edge; imbalance: the number of ascending
  /// sides minus that of descending ones.
  template <typename Visit>
  void eachPatchAt(std::uint32_t edge, const Visit& visit) const;
  void findShells();

  /// Of the given mesh; built on the first call where none was given.
  const TriangleScene& scene();
  /// Direction `number` of a fixed set for a face, of length 1.
  static Vec3d directionFrom(std::uint32_t face, std::uint32_t number);
  /// Crossings of the ray from the centroid of a face, without those with the face itself.
  void shoot(std::uint32_t face, const Vec3d& direction,
             std::vector<TriangleScene::Hit>& hits) const;

  enum class Balance : std::uint8_t {
    Even,
    Odd,  ///< one face of an odd number is left over
    Wrong ///< more than one face is not cancelled
  };
  /// Votes of faces about their orientation.
  struct Poll {
    int asked = 0, outward = 0, inward = 0;
    /// At least nine of ten decided faces agree, and at least half of all are decided.
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
  std::vector<std::uint8_t> sideless_; ///< by patch: 1 if no face has a side of its own
  /// By patch. Patches whose sides do not balance at an edge are of one shell. A patch that
  /// balances by itself only touches the others: two boxes with a common edge are two shells.
  std::vector<std::uint32_t> shellOf_;
  std::uint32_t shellCount_ = 0;
  std::unique_ptr<TriangleScene> ownScene_;
  const TriangleScene* scene_ = nullptr;
  std::size_t turnedShells_ = 0;
  bool insideOut_ = false;
};

} // namespace tetvdb
