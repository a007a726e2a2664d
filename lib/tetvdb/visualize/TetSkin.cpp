// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/TetSkin.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/MixBits.h"
#include "tetvdb/geometry/SortedTetFaces.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/complex/TetEnergy.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr std::size_t kTetsPerTask = 1 << 14;

enum class Place : std::uint8_t { Kept, Met, Gone };

class Skin {
public:
  Skin(const TetMesh& mesh, const std::optional<CutPlane>& cut, double shrink, Progress& progress)
      : mesh_(mesh), shrink_(shrink), progress_(progress) {
    if (cut)
      sortTets(*cut);
  }

  TetSkin run() {
    addOutside(outerFaces());
    progress_.check();
    addCutTets();
    skin_.mesh.faceCount = skin_.mesh.triangleCount();
    return std::move(skin_);
  }

private:
  template <typename Visit>
  void eachTask(const Visit& visit) const {
    const std::size_t tasks = (mesh_.tetCount() + kTetsPerTask - 1) / kTetsPerTask;
    tbb::parallel_for(std::size_t(0), tasks, [&](std::size_t task) {
      progress_.check();
      visit(task * kTetsPerTask, std::min(mesh_.tetCount(), (task + 1) * kTetsPerTask));
    });
  }

  void sortTets(const CutPlane& cut) {
    places_.resize(mesh_.tetCount());
    eachTask([&](std::size_t begin, std::size_t end) {
      for (std::size_t tet = begin; tet < end; ++tet) {
        bool before = false, beyond = false;
        for (std::size_t k = 0; k < 4; ++k) {
          const double side = dot(cut.normal, mesh_.points[mesh_.tets[4 * tet + k]]) - cut.offset;
          before = before || side < 0;
          beyond = beyond || side > 0;
        }
        places_[tet] = !beyond ? Place::Kept : before ? Place::Met : Place::Gone;
      }
    });
  }

  bool isKept(std::size_t tet) const { return places_.empty() || places_[tet] == Place::Kept; }

  // Around a point within the tets every face comes twice, so that the exclusive or of the faces'
  // hashes is zero; by chance also around one on the outside, once in 2^64. Only faces whose three
  // points are on the outside are matched.
  std::vector<TetFace> outerFaces() const {
    std::vector<std::atomic<std::uint64_t>> sums(mesh_.points.size());
    eachTask([&](std::size_t begin, std::size_t end) {
      for (std::size_t tet = begin; tet < end; ++tet) {
        if (!isKept(tet))
          continue;
        for (const auto& face : kFaceCorners) {
          std::array<std::uint32_t, 3> v{};
          for (std::size_t k = 0; k < 3; ++k)
            v[k] = mesh_.tets[4 * tet + face[k]];
          std::sort(v.begin(), v.end());
          const std::uint64_t hash = mixBits(mixBits(hashOfIndex(v[0]) + v[1]) + v[2]);
          for (const std::uint32_t point : v)
            sums[point].fetch_xor(hash, std::memory_order_relaxed);
        }
      }
    });
    const auto faces = sortedTetFaces(
        mesh_.tets.data(), mesh_.tetCount(),
        [&](const TetFace& face) {
          const auto& v = face.corners;
          return isKept(face.tet) && sums[v[0]] != 0 && sums[v[1]] != 0 && sums[v[2]] != 0;
        },
        progress_);
    std::vector<TetFace> outer;
    forEqualFaces(faces, [&](const TetFace* first, const TetFace* last) {
      if ((last - first) % 2 == 1)
        outer.push_back(*first);
    });
    return outer;
  }

  // A face as it is seen from outside its tet, whichever way the tet is turned.
  std::array<std::uint32_t, 3> outward(std::size_t tet, std::size_t opposite) const {
    const std::uint32_t* v = &mesh_.tets[4 * tet];
    const Vec3d& origin = mesh_.points[v[0]];
    const bool turned =
        dot(minus(mesh_.points[v[3]], origin),
            cross(minus(mesh_.points[v[1]], origin), minus(mesh_.points[v[2]], origin))) < 0;
    const auto& face = kFaceCorners[opposite];
    return {v[face[0]], v[face[turned ? 2 : 1]], v[face[turned ? 1 : 2]]};
  }

  void addOutside(const std::vector<TetFace>& faces) {
    constexpr std::uint32_t kNone = 0xFFFFFFFFU;
    std::vector<std::uint32_t> number(mesh_.points.size(), kNone);
    for (const TetFace& face : faces) {
      skin_.tetOfFace.push_back(face.tet);
      for (const std::uint32_t point : outward(face.tet, face.opposite)) {
        if (number[point] == kNone) {
          number[point] = static_cast<std::uint32_t>(skin_.mesh.points.size());
          skin_.mesh.points.push_back(mesh_.points[point]);
          skin_.pointOf.push_back(point);
        }
        skin_.mesh.triangles.push_back(number[point]);
      }
    }
  }

  void addCutTets() {
    for (std::size_t tet = 0; tet < places_.size(); ++tet) {
      if (places_[tet] != Place::Met)
        continue;
      ++skin_.cutTets;
      const std::size_t first = skin_.mesh.points.size();
      if (first > std::numeric_limits<std::uint32_t>::max() - 8)
        throw Error(Status::Limit, "", "the cut meets too many tets to draw");
      const std::uint32_t* v = &mesh_.tets[4 * tet];
      Vec3d centre{0, 0, 0};
      for (std::size_t k = 0; k < 4; ++k)
        centre = plus(centre, times(mesh_.points[v[k]], 0.25));
      for (std::size_t k = 0; k < 4; ++k) {
        skin_.mesh.points.push_back(
            plus(centre, times(minus(mesh_.points[v[k]], centre), shrink_)));
        skin_.pointOf.push_back(v[k]);
      }
      for (std::size_t opposite = 0; opposite < 4; ++opposite) {
        skin_.tetOfFace.push_back(static_cast<std::uint32_t>(tet));
        for (const std::uint32_t point : outward(tet, opposite))
          skin_.mesh.triangles.push_back(static_cast<std::uint32_t>(
              first + static_cast<std::size_t>(std::find(v, v + 4, point) - v)));
      }
    }
  }

  const TetMesh& mesh_;
  double shrink_;
  Progress& progress_;
  std::vector<Place> places_; ///< by tet; empty: all are kept
  TetSkin skin_;
};

} // namespace

SurfaceValues TetSkin::values(const SurfaceValues& ofTets) const {
  SurfaceValues result;
  result.on = ofTets.on;
  result.scale = ofTets.scale;
  const std::vector<std::uint32_t>& from =
      ofTets.on == SurfaceValues::On::Faces ? tetOfFace : pointOf;
  if (ofTets.on != SurfaceValues::On::Nothing) {
    result.values.reserve(from.size());
    for (const std::uint32_t i : from)
      result.values.push_back(ofTets.values[i]);
  }
  return result;
}

TetSkin tetSkin(const TetMesh& mesh, const std::optional<CutPlane>& cut, double shrink,
                Progress& progress) {
  return Skin(mesh, cut, shrink, progress).run();
}

std::vector<float> tetEnergies(const TetMesh& mesh) {
  std::vector<float> energies(mesh.tetCount());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.tetCount(), kTetsPerTask),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t tet = range.begin(); tet != range.end(); ++tet) {
                        const std::uint32_t* v = &mesh.tets[4 * tet];
                        const TetShape shape(mesh.points[v[0]], mesh.points[v[1]],
                                             mesh.points[v[2]], mesh.points[v[3]]);
                        const double energy = std::cbrt(shape.cube());
                        energies[tet] = std::isnan(energy) ? INFINITY : static_cast<float>(energy);
                      }
                    });
  return energies;
}

} // namespace tetvdb
