// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/insertion/InsertSurface.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/tetrahedralize/complex/BackgroundMesh.h"
#include "tetvdb/tetrahedralize/insertion/InsertSoup.h"

#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kFirstSoupPoint = 8; // after the box's corners
// Attempts with one soup, as long as no more than kFew faces are missing.
constexpr int kTries = 3;
constexpr std::size_t kFew = 16;
// Variants that may need too many tets.
constexpr int kMaxTooMany = 2;

TetComplex startComplex(const std::vector<Vec3d>& points, const PlainTets& plain) {
  TetComplex complex;
  complex.points.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    complex.points[i].at = points[i];
  complex.tets.resize(plain.tets.size());
  for (std::size_t t = 0; t < plain.tets.size(); ++t) {
    TetComplex::Tet& tet = complex.tets[t];
    tet.corners = plain.tets[t];
    tet.neighbours = plain.neighbours[t];
    tet.chains = {0, 0, 0, 0};
    tet.tracked = {false, false, false, false};
    tet.energy = 0;
    tet.mark = 0;
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      complex.points[tet.corners[localFace]].tet = static_cast<std::uint32_t>(t);
      if (tet.neighbours[localFace] == TetComplex::kOutside)
        for (const unsigned corner : kFaceCorners[localFace])
          complex.points[tet.corners[corner]].fixed = true;
    }
  }
  return complex;
}

// Where few faces are missing, another attempt inserts these first.
void insertAll(InsertedSurface& surface, std::size_t inputCount,
               const InsertSurfaceOptions& options, const std::vector<Vec3d>& points,
               const PlainTets& background, Progress& progress) {
  std::vector<std::uint32_t> first;
  for (int number = 0; number < kTries; ++number) {
    TetComplex complex = startComplex(points, background);
    SoupInsertion insertion(surface.soup, inputCount, kFirstSoupPoint, options.reach,
                            options.coarsen);
    insertion.run(complex, first, progress);
    std::vector<std::uint32_t> missing = insertion.missing();
    if (number > 0 && missing.size() >= surface.missing.size())
      return;
    surface.complex = std::move(complex);
    surface.missing = std::move(missing);
    if (surface.missing.empty() || surface.missing.size() > kFew)
      return;
    first.insert(first.end(), surface.missing.begin(), surface.missing.end());
  }
}

} // namespace

InsertedSurface insertSurface(const std::function<LatticeSoup(int variant)>& soupOf, int variants,
                              std::size_t inputCount, const InsertSurfaceOptions& options,
                              StageTimer& timer, Progress& progress) {
  InsertedSurface best;
  bool found = false;
  int tooMany = 0;
  for (int variant = 0; variant < variants && !(found && best.missing.empty()); ++variant) {
    InsertedSurface next;
    next.soup = soupOf(variant);
    timer.part("background");
    progress.stage("background");
    const std::vector<Vec3d> points =
        backgroundPoints(next.soup, options.margin, options.spacing, options.clearance, progress);
    const PlainTets background = delaunayTets(points, next.soup.grain, progress);
    timer.part("insert");
    progress.stage("insert");
    try {
      insertAll(next, inputCount, options, points, background, progress);
    } catch (const Error& error) {
      // Another variant may need fewer tets, though seldom after two that did not.
      if (error.status() != Status::Limit || (++tooMany == kMaxTooMany && !found))
        throw;
      continue;
    }
    if (!found || next.missing.size() < best.missing.size())
      best = std::move(next);
    found = true;
  }
  return best;
}

} // namespace tetvdb
