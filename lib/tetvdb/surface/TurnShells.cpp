// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/core/LargeVector.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FaceSides.h"
#include "tetvdb/surface/PatchesAtEdge.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// Minimum |volume| over area^1.5 of a shell with an inside. A ball has 0.094, a cube 0.068, a cube
// without lid 0.072 about its own centroid.
constexpr double kMinVolumeOpen = 0.02;
// Above this, visibility decides the orientation of open shells.
constexpr double kMinVolumeAsked = 0.001;
constexpr std::size_t kShellsAsked = 5000;
constexpr double kMinVolumeClosed = 1e-12;
// For closed shells: above this, rounding does not affect the orientation.
constexpr double kMinVolumeSure = 1e-8;
constexpr std::size_t kSamplesPerShell = 5;

} // namespace

struct FaceSides::Shell {
  double area = 0;
  double volume = 0; ///< signed, as reversed so far; about the area's centroid
  Vec3d centroid{0, 0, 0};
  Box box; ///< in turnShells()
  bool closed = true;
  bool orientable = true;
  bool sideless = true; ///< no face has a side of its own
  bool hasSide = false;
  std::uint32_t number = 0;

  /// Dimensionless.
  double bulk() const { return area > 0 ? std::abs(volume) / std::pow(area, 1.5) : 0; }

  /// A larger shell around this one, by rank, and its winding number here.
  struct Container {
    std::uint32_t rank;
    int winding;
  };
  std::vector<Container> containers;
};

std::vector<FaceSides::Shell> FaceSides::measureShells() const {
  std::vector<Shell> shells(shellCount_);
  const auto eachFace = [&](const auto& visit) { // in their order, since sums are rounded
    for (std::uint32_t face = 0; face < areas_.size(); ++face)
      if (patches_.patchOf[face] != EdgeTable::kNone)
        visit(face, shells[shellOf(face)]);
  };
  LargeVector<Vec3d> moments(areas_.size());
  forEachIndex(areas_.size(), [&](std::size_t face) {
    moments[face] = times(centroid(static_cast<std::uint32_t>(face)), areas_[face]);
  });
  eachFace([&](std::uint32_t face, Shell& shell) {
    shell.area += areas_[face];
    shell.centroid = plus(shell.centroid, moments[face]);
  });
  for (std::uint32_t number = 0; number < shells.size(); ++number) {
    shells[number].number = number;
    if (shells[number].area > 0)
      shells[number].centroid = times(shells[number].centroid, 1 / shells[number].area);
  }
  LargeVector<double> volumes(areas_.size());
  forEachIndex(areas_.size(), [&](std::size_t i) {
    const auto face = static_cast<std::uint32_t>(i);
    if (patches_.patchOf[face] == EdgeTable::kNone)
      return;
    const Vec3d& corner = mesh_.points[mesh_.triangles[3 * i]];
    volumes[i] = dot(minus(corner, shells[shellOf(face)].centroid), normal(face)) / 6;
  });
  eachFace([&](std::uint32_t face, Shell& shell) { shell.volume += volumes[face]; });
  std::vector<std::atomic<bool>> open(shells.size());
  forEachIndex(edges_.edgeCount(), [&](std::size_t edge) {
    // All patches that do not balance by themselves are of one shell.
    int sum = 0;
    std::uint32_t shell = 0;
    eachPatchAt(static_cast<std::uint32_t>(edge), [&](std::uint32_t patch, int imbalance) {
      sum += imbalance;
      shell = imbalance == 0 ? shell : shellOf_[patch];
    });
    if (sum != 0)
      open[shell].store(true, std::memory_order_relaxed);
  });
  for (std::size_t shell = 0; shell < shells.size(); ++shell)
    shells[shell].closed = !open[shell];
  for (std::uint32_t patch = 0; patch < shellOf_.size(); ++patch) {
    Shell& shell = shells[shellOf_[patch]];
    shell.orientable = shell.orientable && patches_.orientable[patch] != 0;
    shell.sideless = shell.sideless && sideless_[patch] != 0;
  }
  for (Shell& shell : shells)
    shell.hasSide =
        shell.orientable && shell.bulk() > (shell.closed ? kMinVolumeClosed : kMinVolumeOpen);
  return shells;
}

bool FaceSides::allShellsLookOutward() const {
  const std::vector<Shell> shells = measureShells();
  return std::all_of(shells.begin(), shells.end(), [](const Shell& shell) {
    return shell.closed && shell.volume > 0 && shell.bulk() > kMinVolumeSure;
  });
}

// Open shells with much area for their volume, for example a tub of thin walls with holes: the
// visibility of their faces, within the shell only, decides their orientation.
void FaceSides::askOpenShells(std::vector<Shell>& shells, Progress& progress) {
  std::vector<std::uint32_t> asked;
  for (const Shell& shell : shells)
    if (!shell.hasSide && !shell.closed && shell.orientable && shell.bulk() > kMinVolumeAsked)
      asked.push_back(shell.number);
  std::stable_sort(asked.begin(), asked.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::abs(shells[a].volume) > std::abs(shells[b].volume);
  });
  asked.resize(std::min(asked.size(), kShellsAsked));
  if (asked.empty())
    return;
  scene();
  const FaceLists lists = listByGroup(patches_, shellOf_, shellCount_);
  tbb::parallel_for(std::size_t(0), asked.size(), [&](std::size_t i) {
    progress.check();
    Shell& shell = shells[asked[i]];
    const Poll votes = poll(lists.begin(shell.number), lists.end(shell.number), kFacesPerPoll);
    shell.hasSide = votes.isSureOf(std::max(votes.outward, votes.inward));
    if (shell.hasSide)
      shell.volume =
          votes.outward > votes.inward ? std::abs(shell.volume) : -std::abs(shell.volume);
  });
}

// `ranked`: the shells with an orientation, the largest volume first.
void FaceSides::findContainers(std::vector<Shell>& ranked, Progress& progress) {
  std::vector<Box> boxes;
  std::vector<std::uint32_t> rankOf(shellCount_, EdgeTable::kNone);
  for (std::uint32_t rank = 0; rank < ranked.size(); ++rank) {
    boxes.push_back(ranked[rank].box);
    rankOf[ranked[rank].number] = rank;
  }
  const BoxTree tree(std::move(boxes));
  std::vector<std::uint32_t> candidates; // ranks of shells whose box lies in a larger shell's
  for (std::uint32_t rank = 1; rank < ranked.size(); ++rank)
    tree.visit([&](const Box& box) { return box.contains(ranked[rank].box); },
               [&](std::uint32_t other) {
                 if (other < rank)
                   candidates.push_back(rank);
                 return other < rank;
               });
  if (candidates.empty())
    return;
  scene();
  const FaceLists lists = listByGroup(patches_, shellOf_, shellCount_);

  const auto findFor = [&](std::uint32_t rank) {
    Shell& shell = ranked[rank];
    const std::size_t faces = lists.size(shell.number);
    const std::size_t samples = std::min(kSamplesPerShell, faces);
    struct Crossing {
      std::uint32_t rank;
      int winding;
    };
    std::vector<Crossing> ofRay, inside; // inside: one for each sample and shell around it
    std::vector<TriangleScene::Hit> hits;
    for (std::size_t sample = 0; sample < samples; ++sample) {
      const std::uint32_t face =
          lists.begin(shell.number)[(2 * sample + 1) * faces / (2 * samples)];
      const Vec3d origin = centroid(face);
      shoot(face, directionFrom(face, 0), hits);
      ofRay.clear();
      for (const TriangleScene::Hit& hit : hits) {
        const std::uint32_t other = rankOf[shellOf(hit.triangle)];
        if (other < rank && ranked[other].box.contains(origin))
          ofRay.push_back({other, hit.leaving != (turned_[hit.triangle] != 0) ? 1 : -1});
      }
      std::sort(ofRay.begin(), ofRay.end(),
                [](const Crossing& a, const Crossing& b) { return a.rank < b.rank; });
      for (std::size_t i = 0, end; i < ofRay.size(); i = end) {
        int winding = 0;
        for (end = i; end < ofRay.size() && ofRay[end].rank == ofRay[i].rank; ++end)
          winding += ofRay[end].winding;
        if ((end - i) % 2 == 1)
          inside.push_back({ofRay[i].rank, winding});
      }
    }
    std::sort(inside.begin(), inside.end(),
              [](const Crossing& a, const Crossing& b) { return a.rank < b.rank; });
    for (std::size_t i = 0, end; i < inside.size(); i = end) {
      int winding = 0;
      for (end = i; end < inside.size() && inside[end].rank == inside[i].rank; ++end)
        winding += inside[end].winding;
      if (2 * (end - i) > samples)
        shell.containers.push_back({inside[i].rank, winding > 0 ? 1 : winding < 0 ? -1 : 0});
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, candidates.size(), 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      progress.check();
                      for (std::size_t i = range.begin(); i != range.end(); ++i)
                        findFor(candidates[i]);
                    });
}

void FaceSides::turnShells(Progress& progress) {
  std::vector<Shell> shells = measureShells(), ranked;
  for (std::uint32_t face = 0; face < areas_.size(); ++face)
    for (std::size_t k = 0; k < 3 && patches_.patchOf[face] != EdgeTable::kNone; ++k)
      shells[shellOf(face)].box.add(mesh_.points[mesh_.triangles[3 * std::size_t(face) + k]]);
  askOpenShells(shells, progress);
  for (const Shell& shell : shells)
    if (shell.hasSide)
      ranked.push_back(shell);
  std::stable_sort(ranked.begin(), ranked.end(), [](const Shell& a, const Shell& b) {
    return std::abs(a.volume) > std::abs(b.volume);
  });
  progress.check();
  findContainers(ranked, progress);

  // Containers have lower ranks and are decided first. A shell is reversed with the smallest shell
  // around it. It is reversed once more, with all that it contains, if it is then oriented inward
  // without a solid around it.
  std::vector<int> turn(ranked.size(), 1);
  double rootVolume = 0, turnedRootVolume = 0;
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) {
    const Shell& shell = ranked[rank];
    int around = 0;
    for (const Shell::Container& container : shell.containers) {
      turn[rank] = turn[container.rank];
      around += container.winding * turn[container.rank];
    }
    const bool looksInward = shell.volume * turn[rank] < 0;
    if (shell.sideless ? looksInward != (around > 0) : looksInward && around <= 0)
      turn[rank] = -turn[rank];
    if (shell.containers.empty()) {
      rootVolume += std::abs(shell.volume);
      turnedRootVolume += turn[rank] < 0 ? std::abs(shell.volume) : 0;
    }
  }
  insideOut_ = 2 * turnedRootVolume > rootVolume;

  std::vector<std::uint8_t> shellTurns(shells.size(), 0);
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) {
    shellTurns[ranked[rank].number] = turn[rank] < 0;
    turnedShells_ += turn[rank] < 0;
  }
  for (std::uint32_t face = 0; face < turned_.size(); ++face)
    if (patches_.patchOf[face] != EdgeTable::kNone && shellTurns[shellOf(face)])
      turned_[face] ^= 1;
}

} // namespace tetvdb
