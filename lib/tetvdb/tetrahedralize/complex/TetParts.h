// SPDX-License-Identifier: Apache-2.0
//
// Parallel work on one mesh that gives the same mesh for any number of threads.
//
// The mesh is partitioned by the centres of its tets into parts of some thousand tets, each a mesh
// of its own. One task works on one part, serially; points that two parts share are fixed. The
// parts are then joined in order. The partition depends on the mesh alone; the next round cuts
// along other planes, so that points that were fixed can change.
//
//   for (int round = 0; round < TetParts::kRounds; ++round)
//     TetParts(complex, round).run([&](TetParts::Part& part) { smooth(part.complex); }, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace tetvdb {

class TetParts {
public:
  static constexpr int kRounds = 3; ///< directions of the planes that parts are cut along
  static constexpr std::size_t kTetsPerPart = 6000;

  struct Part {
    TetComplex complex;
    /// Of the points that the part began with, their numbers in the whole mesh, ascending; points
    /// that are added come after them.
    std::vector<std::uint32_t> pointOfWhole;
    std::size_t index = 0;

    /// The part's number of a point of the whole mesh; TetComplex::kNone: it is not in the part.
    std::uint32_t local(std::uint32_t pointOfWhole) const;
  };

  /// Parts of about `tetsPerPart` tets; one part, and no points fixed anew, for a mesh of less than
  /// twice that or for round < 0. The whole mesh's tets move into the parts.
  TetParts(TetComplex& whole, int round, std::size_t tetsPerPart = kTetsPerPart);

  std::size_t count() const { return parts_.size(); }

  /// Calls work(part) for every part, in parallel, and joins the parts: tets are numbered anew;
  /// points keep their numbers, new ones follow in the order of parts. On an exception, as of
  /// Progress, the whole mesh is lost.
  void run(const std::function<void(Part&)>& work, Progress& progress);

private:
  std::vector<std::vector<std::uint32_t>> cut(int round, int levels);
  void findBorders();
  void extract(std::size_t index, const std::vector<std::uint32_t>& tets);
  void join();
  void copyBack(Part& part, std::size_t firstTet, std::size_t firstPoint);
  void joinBorders();

  TetComplex& whole_;
  std::vector<Part> parts_;
  std::vector<std::uint32_t> partOfTet_;
  std::vector<std::uint32_t> indexInPart_;            // of tets of the whole mesh
  std::vector<std::uint32_t> partOfPoint_;            // kShared: several
  std::vector<std::array<std::uint32_t, 4>> borders_; // numbers of faces between parts, by tet
  std::size_t borderCount_ = 0;
};

} // namespace tetvdb
