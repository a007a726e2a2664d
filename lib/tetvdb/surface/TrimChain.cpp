// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/TrimChain.h"

#include "tetvdb/core/AtomicBounds.h"
#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/FaceColumns.h"
#include "tetvdb/surface/FaceContacts.h"
#include "tetvdb/surface/FacePieces.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// Limits for all faces together, which bound memory and time.
constexpr std::size_t kMaxPieces = std::size_t(1) << 22;
constexpr std::size_t kMaxCuts = std::size_t(1) << 26;  // tested pieces
constexpr std::size_t kMaxLooks = std::size_t(1) << 29; // tested faces of columns
constexpr unsigned kMaxAttempts = 32;                   // to find a point that decides

class Trimmer {
public:
  Trimmer(const WeldedFaces& welded, bool (*isInside)(std::int64_t), Progress& progress)
      : welded_(welded), isInside_(isInside), progress_(progress), boxes_(faceBoxes(welded)),
        columns_(welded, boxes_), contacts_(findContacts(welded, boxes_, progress)) {}

  const FaceContacts& contacts() const { return contacts_; }

  // Fills fates and parts of `trimmed`; returns false if it fails.
  bool run(TrimmedChain& trimmed) {
    fates_.resize(welded_.faces.size());
    judgePatches();
    if (!gaveUp_)
      cutFaces(trimmed.parts);
    if (!gaveUp_)
      trimmed.fates = std::move(fates_);
    return !gaveUp_;
  }

private:
  // Of coincident faces, the first represents all.
  PartFate fateOf(const FacePieces& pieces, std::size_t piece, const FacePlanes& face,
                  std::uint32_t number) {
    std::size_t looked = 0;
    PartFate fate = PartFate::Undecided;
    for (unsigned attempt = 0; attempt < kMaxAttempts; ++attempt) {
      std::int64_t u, v;
      if (!pieces.innerPoint(piece, attempt, u, v))
        continue;
      const auto sides = columns_.at(face, LiftedPoint(face.plane, face.axis, u, v), looked);
      if (!sides)
        continue;
      const bool front = isInside_(sides->front), back = isInside_(sides->back);
      fate = front == back || sides->first != number ? PartFate::Goes
             : back                                  ? PartFate::Stays
                                                     : PartFate::StaysInverse;
      break;
    }
    if ((looks_ += looked) > kMaxLooks)
      gaveUp_ = true;
    return fate;
  }

  // Faces that no face meets, connected by edges of exactly two faces, have the same winding
  // numbers on their sides: one point decides for all of them.
  void judgePatches() {
    const std::size_t count = welded_.faces.size();
    DisjointSets patches(count);
    for (const auto& neighbours : contacts_.neighbours)
      forEachIndex(neighbours.size(), [&](std::size_t i) {
        const auto& [a, b] = neighbours[i];
        if (areContinued(welded_.faces[a], welded_.faces[b]))
          patches.join(a, b);
      });
    // A thin face may have no point that decides; the first of the patch's largest faces is used.
    std::vector<std::uint32_t> patchOf(count);
    std::vector<std::atomic<double>> area(count);
    std::vector<std::atomic<std::uint32_t>> largest(count);
    forEachIndex(count, [&](std::size_t i) {
      patchOf[i] = patches.find(static_cast<std::uint32_t>(i));
      raiseTo(area[patchOf[i]], roughArea(i));
      largest[i] = std::numeric_limits<std::uint32_t>::max();
    });
    forEachIndex(count, [&](std::size_t i) {
      if (roughArea(i) == area[patchOf[i]])
        lowerTo(largest[patchOf[i]], static_cast<std::uint32_t>(i));
    });
    std::vector<std::uint32_t> first;
    for (std::uint32_t i = 0; i < count; ++i)
      if (patchOf[i] == i && !contacts_.isMet(i))
        first.push_back(i);
    // By patch: the fate of faces with positive weight.
    std::vector<PartFate> fates(count, PartFate::Stays);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first.size(), 16), [&](const auto& r) {
      progress_.check();
      for (std::size_t i = r.begin(); i != r.end() && !gaveUp_; ++i) {
        const std::uint32_t asked = largest[first[i]];
        const FacePlanes face(welded_.cornersOf(asked));
        fates[first[i]] =
            turned(fateOf(FacePieces(face), 0, face, asked), welded_.faces[asked].weight < 0);
      }
    });
    forEachIndex(count, [&](std::size_t i) {
      if (!contacts_.isMet(i))
        fates_[i] = turned(fates[patchOf[i]], welded_.faces[i].weight < 0);
    });
  }

  static PartFate turned(PartFate fate, bool turn) {
    if (!turn || fate == PartFate::Goes || fate == PartFate::Undecided)
      return fate;
    return fate == PartFate::Stays ? PartFate::StaysInverse : PartFate::Stays;
  }

  // Whether the front continues across the shared edge with the same weight.
  static bool areContinued(const WeldedFace& a, const WeldedFace& b) {
    const auto runs = [](const WeldedFace& face, std::uint32_t from, std::uint32_t to) {
      const auto& c = face.corners;
      const auto at = std::find(c.begin(), c.end(), from) - c.begin();
      return c[static_cast<std::size_t>((at + 1) % 3)] == to ? 1 : -1;
    };
    std::array<std::uint32_t, 2> shared{};
    std::size_t found = 0;
    for (const std::uint32_t corner : a.corners)
      if (std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end())
        shared[found++] = corner;
    const int turn = -runs(a, shared[0], shared[1]) * runs(b, shared[0], shared[1]);
    return a.weight == turn * b.weight;
  }

  double roughArea(std::size_t face) const {
    const std::array<Vec3d, 3> c = welded_.cornersOf(face);
    const Vec3d n = cross(minus(c[1], c[0]), minus(c[2], c[0]));
    return dot(n, n);
  }

  void cutFaces(std::map<std::uint32_t, std::vector<FacePart>>& parts) {
    std::vector<std::uint32_t> met;
    for (std::uint32_t i = 0; i < welded_.faces.size(); ++i)
      if (contacts_.isMet(i))
        met.push_back(i);
    std::vector<std::uint32_t> place(welded_.faces.size());
    for (std::uint32_t i = 0; i < met.size(); ++i)
      place[met[i]] = i;
    std::vector<std::unique_ptr<FacePlanes>> planes(met.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, met.size(), 256), [&](const auto& r) {
      for (std::size_t i = r.begin(); i != r.end(); ++i)
        planes[i] = std::make_unique<FacePlanes>(welded_.cornersOf(met[i]));
    });
    std::vector<std::vector<FacePart>> left(met.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, met.size(), 1), [&](const auto& range) {
      progress_.check();
      for (std::size_t i = range.begin(); i != range.end() && !gaveUp_; ++i) {
        std::vector<const FacePlanes*> others;
        for (std::size_t k = contacts_.starts[met[i]]; k != contacts_.starts[met[i] + 1]; ++k)
          others.push_back(planes[place[contacts_.others[k]]].get());
        cutFace(met[i], *planes[i], std::move(others), left[i]);
      }
    });
    for (std::size_t i = 0; i < met.size(); ++i)
      if (!left[i].empty()) {
        fates_[met[i]] = PartFate::Cut;
        parts.emplace_hint(parts.end(), met[i], std::move(left[i]));
      }
  }

  void cutFace(std::uint32_t number, const FacePlanes& face, std::vector<const FacePlanes*> others,
               std::vector<FacePart>& left) {
    std::sort(others.begin(), others.end(),
              [](const FacePlanes* a, const FacePlanes* b) { return a->corners < b->corners; });
    // In random order, the number of pieces is small (Paterson and Yao 1990).
    std::uint64_t random = others.size();
    for (std::size_t i = others.size(); i > 1; --i) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      std::swap(others[i - 1], others[(random >> 33) % i]);
    }
    FacePieces pieces(face);
    for (const FacePlanes* other : others) {
      const std::size_t before = pieces.size(), looked = pieces.cut(*other);
      if ((cuts_ += looked) > kMaxCuts || (pieces_ += pieces.size() - before) > kMaxPieces)
        gaveUp_ = true;
      if (gaveUp_)
        return;
    }
    std::vector<PartFate> fates(pieces.size(), PartFate::Undecided);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces.size(), 16), [&](const auto& r) {
      progress_.check();
      for (std::size_t i = r.begin(); i != r.end() && !gaveUp_; ++i)
        if (pieces.isLeaf(i))
          fates[i] = fateOf(pieces, i, face, number);
    });
    // Halves follow the pieces that they divide.
    std::vector<std::uint8_t> mixed(pieces.size(), 0);
    for (std::size_t i = pieces.size(); i-- > 0;) {
      if (pieces.isLeaf(i))
        continue;
      const std::size_t a = pieces.halves(i), b = a + 1;
      mixed[i] = mixed[a] != 0 || mixed[b] != 0 ||
                 (fates[a] != fates[b] && fates[a] != PartFate::Undecided &&
                  fates[b] != PartFate::Undecided);
      fates[i] = fates[a] == PartFate::Undecided ? fates[b] : fates[a];
    }
    fates_[number] = fates[0];
    if (mixed[0] == 0)
      return;
    std::vector<std::size_t> open{0};
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      if (mixed[at] != 0) {
        open.push_back(pieces.halves(at));
        open.push_back(pieces.halves(at) + 1);
      } else if (fates[at] == PartFate::Stays || fates[at] == PartFate::StaysInverse) {
        left.push_back({pieces.outline(at), fates[at] == PartFate::StaysInverse});
      }
    }
  }

  const WeldedFaces& welded_;
  bool (*const isInside_)(std::int64_t);
  Progress& progress_;
  const BoxBlocks boxes_;
  const FaceColumns columns_;
  const FaceContacts contacts_;
  std::vector<PartFate> fates_;
  std::atomic<std::size_t> pieces_{0}, cuts_{0}, looks_{0};
  std::atomic<bool> gaveUp_{false};
};

} // namespace

TrimmedChain trimChain(const WeldedFaces& welded, bool (*isInside)(std::int64_t),
                       Progress& progress) {
  TrimmedChain trimmed;
  if (welded.extent > kMaxPlaneExtent) {
    trimmed.complete = false;
    return trimmed;
  }
  Trimmer trimmer(welded, isInside, progress);
  const FaceContacts& contacts = trimmer.contacts();
  trimmed.hasEqualFaces = contacts.equal;
  trimmed.complete = contacts.complete && !contacts.equal;
  if (!trimmed.complete)
    return trimmed;
  trimmed.isMet.resize(welded.faces.size());
  forEachIndex(welded.faces.size(), [&](std::size_t i) { trimmed.isMet[i] = contacts.isMet(i); });
  trimmed.complete = trimmer.run(trimmed);
  return trimmed;
}

} // namespace tetvdb
