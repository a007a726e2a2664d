// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/TrimFaces.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/fields/FaceColumns.h"
#include "tetvdb/fields/FaceContacts.h"
#include "tetvdb/fields/FacePieces.h"
#include "tetvdb/fields/WeldedFaces.h"
#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// Of all faces together, beyond which trimming is given up: pieces of memory and of time.
constexpr std::size_t kMostPieces = std::size_t(1) << 22;
constexpr std::size_t kMostCuts = std::size_t(1) << 26;  // looks at pieces
constexpr std::size_t kMostLooks = std::size_t(1) << 29; // at faces of columns
constexpr unsigned kMostAttempts = 32;                   // to find a point that decides

enum class Fate : std::uint8_t {
  Stays,
  Goes,
  Either ///< too thin to matter: as its neighbours
};

bool isInside(std::int64_t winding, FillRule rule) {
  switch (rule) {
  case FillRule::Positive:
    return winding > 0;
  case FillRule::NonZero:
    return winding != 0;
  default:
    return winding % 2 != 0;
  }
}

std::vector<Box> boxesOf(const WeldedFaces& welded) {
  std::vector<Box> boxes(welded.faces.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i)
      for (const Vec3d& corner : welded.cornersOf(i))
        boxes[i].add(corner);
  });
  return boxes;
}

using Outline = std::vector<Vec3d>;

// What is left of a face.
struct Rest {
  Fate fate = Fate::Stays; // of all of it, if there are no parts
  std::vector<Outline> parts;
};

class Trimmer {
public:
  Trimmer(const WeldedFaces& welded, FillRule rule, Progress& progress)
      : welded_(welded), rule_(rule), progress_(progress), boxes_(boxesOf(welded)),
        columns_(welded, boxes_), contacts_(findContacts(welded, boxes_, progress)) {}

  // False where it is given up.
  bool run() {
    if (!contacts_.complete)
      return false;
    rests_.resize(welded_.faces.size());
    judgePatches();
    if (!gaveUp_)
      cutFaces();
    return !gaveUp_;
  }

  const FaceContacts& contacts() const { return contacts_; }
  const std::vector<Rest>& rests() const { return rests_; }

private:
  Fate fateOf(const FacePieces& pieces, std::size_t piece, const FacePlanes& face) {
    std::size_t looked = 0;
    Fate fate = Fate::Either;
    for (unsigned attempt = 0; attempt < kMostAttempts; ++attempt) {
      std::int64_t u, v;
      if (!pieces.innerPoint(piece, attempt, u, v))
        continue;
      const auto sides = columns_.at(face, LiftedPoint(face.plane, face.axis, u, v), looked);
      if (!sides)
        continue;
      fate =
          isInside(sides->front, rule_) != isInside(sides->back, rule_) ? Fate::Stays : Fate::Goes;
      break;
    }
    if ((looks_ += looked) > kMostLooks)
      gaveUp_ = true;
    return fate;
  }

  // Faces that hang together by edges that belong to no others, and that no face meets, have the
  // same on their either side: one point tells of all of them.
  void judgePatches() {
    DisjointSets patches(welded_.faces.size());
    for (const auto& [a, b] : contacts_.neighbours)
      if (areContinued(welded_.faces[a], welded_.faces[b]))
        patches.join(a, b);
    std::vector<std::uint32_t> first, patchOf(welded_.faces.size());
    for (std::uint32_t i = 0; i < patchOf.size(); ++i) {
      patchOf[i] = patches.find(i);
      if (patchOf[i] == i && !contacts_.isMet(i))
        first.push_back(i);
    }
    // A thin face may hide its answer, the largest of the patch does not.
    std::vector<std::uint32_t> largest = patchOf;
    std::vector<double> area(patchOf.size(), -1);
    for (std::uint32_t i = 0; i < patchOf.size(); ++i)
      if (const double own = roughArea(i); own > area[patchOf[i]]) {
        area[patchOf[i]] = own;
        largest[patchOf[i]] = i;
      }
    std::vector<Fate> fates(patchOf.size(), Fate::Stays);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, first.size(), 16), [&](const auto& r) {
      progress_.check();
      for (std::size_t i = r.begin(); i != r.end() && !gaveUp_; ++i) {
        const FacePlanes face(welded_.cornersOf(largest[first[i]]));
        fates[first[i]] = fateOf(FacePieces(face), 0, face);
      }
    });
    for (std::uint32_t i = 0; i < patchOf.size(); ++i)
      if (!contacts_.isMet(i))
        rests_[i].fate = fates[patchOf[i]];
  }

  // Across the edge they share the front goes on as the front, and weighs the same.
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

  double roughArea(std::uint32_t face) const {
    const std::array<Vec3d, 3> c = welded_.cornersOf(face);
    const Vec3d n = cross(minus(c[1], c[0]), minus(c[2], c[0]));
    return dot(n, n);
  }

  void cutFaces() {
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
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, met.size(), 1), [&](const auto& range) {
      progress_.check();
      for (std::size_t i = range.begin(); i != range.end() && !gaveUp_; ++i) {
        std::vector<const FacePlanes*> others;
        for (std::size_t k = contacts_.starts[met[i]]; k != contacts_.starts[met[i] + 1]; ++k)
          others.push_back(planes[place[contacts_.others[k]]].get());
        cutFace(*planes[i], std::move(others), rests_[met[i]]);
      }
    });
  }

  void cutFace(const FacePlanes& face, std::vector<const FacePlanes*> others, Rest& rest) {
    std::sort(others.begin(), others.end(),
              [](const FacePlanes* a, const FacePlanes* b) { return a->corners < b->corners; });
    // In an order that looks random, pieces stay few (Paterson and Yao 1990).
    std::uint64_t random = others.size();
    for (std::size_t i = others.size(); i > 1; --i) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      std::swap(others[i - 1], others[(random >> 33) % i]);
    }
    FacePieces pieces(face);
    for (const FacePlanes* other : others) {
      const std::size_t before = pieces.size(), looked = pieces.cut(*other);
      if ((cuts_ += looked) > kMostCuts || (pieces_ += pieces.size() - before) > kMostPieces)
        gaveUp_ = true;
      if (gaveUp_)
        return;
    }
    std::vector<Fate> fates(pieces.size(), Fate::Either);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pieces.size(), 16), [&](const auto& r) {
      progress_.check();
      for (std::size_t i = r.begin(); i != r.end() && !gaveUp_; ++i)
        if (pieces.isLeaf(i))
          fates[i] = fateOf(pieces, i, face);
    });
    // Halves come after what they are halves of.
    std::vector<std::uint8_t> mixed(pieces.size(), 0);
    for (std::size_t i = pieces.size(); i-- > 0;) {
      if (pieces.isLeaf(i))
        continue;
      const std::size_t a = pieces.halves(i), b = a + 1;
      mixed[i] = mixed[a] != 0 || mixed[b] != 0 ||
                 (fates[a] != fates[b] && fates[a] != Fate::Either && fates[b] != Fate::Either);
      fates[i] = fates[a] == Fate::Either ? fates[b] : fates[a];
    }
    rest.fate = fates[0];
    if (mixed[0] == 0)
      return;
    std::vector<std::size_t> open{0};
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      if (mixed[at] != 0) {
        open.push_back(pieces.halves(at));
        open.push_back(pieces.halves(at) + 1);
      } else if (fates[at] == Fate::Stays) {
        rest.parts.push_back(pieces.outline(at));
      }
    }
  }

  const WeldedFaces& welded_;
  const FillRule rule_;
  Progress& progress_;
  const BoxBlocks boxes_;
  const FaceColumns columns_;
  const FaceContacts contacts_;
  std::vector<Rest> rests_;
  std::atomic<std::size_t> pieces_{0}, cuts_{0}, looks_{0};
  std::atomic<bool> gaveUp_{false};
};

} // namespace

TrimmedFaces trimFaces(const SnappedMesh& mesh, const Boundary& boundary, FillRule rule,
                       Progress& progress) {
  TrimmedFaces trimmed;
  WeldedFaces welded = weldFaces(mesh, boundary, progress);
  if (welded.extent > kMaxPlaneExtent) {
    trimmed.complete = false;
    return trimmed;
  }
  auto trimmer = std::make_unique<Trimmer>(welded, rule, progress);
  if (trimmer->contacts().equal) {
    mergeEqualFaces(welded);
    trimmer = std::make_unique<Trimmer>(welded, rule, progress);
  }
  trimmed.complete = trimmer->run();
  TrimCounts& counts = trimmed.counts;
  for (std::size_t i = 0; i < welded.faces.size(); ++i)
    counts.met += trimmer->contacts().complete && trimmer->contacts().isMet(i);
  if (!trimmed.complete)
    return trimmed;
  counts.removed = welded.cancelled;
  for (const Rest& rest : trimmer->rests()) {
    if (!rest.parts.empty()) {
      ++counts.cut;
      counts.pieces += rest.parts.size();
    } else if (rest.fate == Fate::Goes) {
      ++counts.removed;
    }
  }
  trimmed.changed = counts.cut + counts.removed > 0;
  if (!trimmed.changed)
    return trimmed;

  SnappedMesh& out = trimmed.mesh;
  const auto add = [&](const Vec3d& p) {
    out.points.push_back({welded.first.x + std::round(p[0]), welded.first.y + std::round(p[1]),
                          welded.first.z + std::round(p[2])});
  };
  for (const Vec3d& p : welded.points)
    add(p);
  for (std::size_t i = 0; i < welded.faces.size(); ++i) {
    const Rest& rest = trimmer->rests()[i];
    for (const Outline& part : rest.parts) {
      const auto first = static_cast<std::uint32_t>(out.points.size());
      for (const Vec3d& p : part)
        add(p);
      for (std::uint32_t k = 2; k < part.size(); ++k)
        trimmed.faces.faces.push_back({first, first + k - 1, first + k, 1});
    }
    const std::array<std::uint32_t, 3>& c = welded.faces[i].corners;
    if (rest.parts.empty() && rest.fate == Fate::Stays)
      trimmed.faces.faces.push_back({c[0], c[1], c[2], 1});
  }
  out.pointCount = out.points.size();
  out.points.push_back({0, 0, 0});
  out.boxMin = mesh.boxMin;
  out.boxMax = mesh.boxMax;
  return trimmed;
}

std::size_t countMetFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress) {
  WeldedFaces welded = weldFaces(mesh, boundary, progress);
  FaceContacts contacts = findContacts(welded, BoxBlocks(boxesOf(welded)), progress);
  if (contacts.equal) {
    mergeEqualFaces(welded);
    contacts = findContacts(welded, BoxBlocks(boxesOf(welded)), progress);
  }
  if (!contacts.complete)
    return welded.faces.size();
  std::size_t met = 0;
  for (std::size_t i = 0; i < welded.faces.size(); ++i)
    met += contacts.isMet(i);
  return met;
}

} // namespace tetvdb
