// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/InsertSoup.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/TetParts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;

// Triangles that are lower than this many tolerances have no side of their own: the path of their
// longest edge goes through their apex, and nothing is left to cover.
constexpr double kFlat = 3;

// Faces that go in together: fewer do as well one by one, of more all would be looked through for
// every point.
constexpr std::size_t kLeastInFlat = 12;
constexpr std::size_t kMostInFlat = 2000;

// How many times its tets, and how many besides, a part may get in a round.
constexpr std::size_t kGrowth = 3, kFreeGrowth = 50000;
// Tets that coarsening may leave of a mesh that has grown too much, and of these for each face.
constexpr std::size_t kMostTets = 1500000, kMostTetsOfFace = 40;
// Rounds go on as long as so many of the missing faces go in: one of eight.
constexpr std::size_t kLeastShare = 8;
// Tets looked at for a triangle: less where there is another round.
constexpr std::size_t kMostEffort = 1000000, kFirstEffort = 200000;

// What counts as on a triangle: far above the rounding of points, far below what matters.
constexpr double kReach = 1e4, kLeastTolerance = 16;

} // namespace

// What a part has to do, and has done.
struct SoupInsertion::PartWork {
  const TetParts::Part* part = nullptr;
  const Progress* progress = nullptr;
  std::vector<std::uint32_t> faces; // of the soup, ascending
  bool last = false;                // there is no other part, now or later
  std::size_t mostTets = 0;
  bool isCutShort = false; // at these
  std::vector<std::uint32_t> done;
  std::vector<std::uint32_t> pointOfWhole; // as Part's
  std::size_t newPoints = 0;
  InsertedPaths paths; // of points of the part
};

SoupInsertion::SoupInsertion(const LatticeSoup& soup, std::size_t inputCount,
                             std::uint32_t firstPoint, double reach,
                             std::function<void(TetComplex&)> coarsen)
    : soup_(soup), inputCount_(inputCount), firstPoint_(firstPoint),
      tolerance_(std::max(kLeastTolerance, reach / kReach)),
      reach_(std::max(reach, 2 * kLeastTolerance)), in_(soup.faces.size(), false),
      through_(soup.faces.size(), 3), facesBegin_(soup.points.size() + 1, 0),
      facesOfPoint_(3 * soup.faces.size()), coarsen_(std::move(coarsen)) {
  for (const auto& face : soup.faces)
    for (const std::uint32_t point : face)
      ++facesBegin_[point + 1];
  for (std::size_t i = 0; i < soup.points.size(); ++i)
    facesBegin_[i + 1] += facesBegin_[i];
  std::vector<std::uint32_t> next(facesBegin_.begin(), facesBegin_.end() - 1);
  for (std::size_t f = 0; f < soup.faces.size(); ++f)
    for (const std::uint32_t point : soup.faces[f])
      facesOfPoint_[next[point]++] = static_cast<std::uint32_t>(f);
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    std::array<Vec3d, 3> at;
    for (std::size_t i = 0; i < 3; ++i)
      at[i] = soup.points[soup.faces[f][i]];
    unsigned apex = 0;
    double longest = 0;
    for (unsigned i = 0; i < 3; ++i) {
      const double side = length(minus(at[(i + 2) % 3], at[(i + 1) % 3]));
      if (side > longest) {
        longest = side;
        apex = i;
      }
    }
    const double area = length(cross(minus(at[1], at[0]), minus(at[2], at[0])));
    if (area <= kFlat * tolerance_ * longest)
      through_[f] = static_cast<std::uint8_t>(apex);
  }
  findFlats();
}

// Grown from the lowest face on, as long as points are in its plane.
void SoupInsertion::findFlats() {
  std::unordered_map<std::uint64_t, std::array<std::uint32_t, 3>> facesAtEdge; // two and a count
  for (std::size_t f = 0; f < soup_.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      auto& edge = facesAtEdge[edgeKey(soup_.faces[f][i], soup_.faces[f][(i + 1) % 3])];
      if (edge[2] < 2)
        edge[edge[2]] = static_cast<std::uint32_t>(f);
      ++edge[2];
    }
  // Faces beside one that is all but collinear go alone: its own path may lead around it.
  std::vector<bool> apart(soup_.faces.size(), false);
  for (const auto& [key, edge] : facesAtEdge)
    if (edge[2] >= 2 && (through_[edge[0]] < 3 || through_[edge[1]] < 3))
      apart[edge[0]] = apart[edge[1]] = true;
  flatOf_.assign(soup_.faces.size(), kNone);
  for (std::uint32_t seed = 0; seed < soup_.faces.size(); ++seed) {
    if (flatOf_[seed] != kNone || through_[seed] < 3 || apart[seed])
      continue;
    const Vec3d& origin = soup_.points[soup_.faces[seed][0]];
    const Vec3d area = areaOf(seed);
    const Vec3d normal = times(area, 1 / length(area));
    const auto number = static_cast<std::uint32_t>(flats_.size());
    std::vector<std::uint32_t> grown{seed};
    flatOf_[seed] = number;
    for (std::size_t next = 0; next < grown.size() && grown.size() < kMostInFlat; ++next)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& corners = soup_.faces[grown[next]];
        const std::uint32_t a = corners[i], b = corners[(i + 1) % 3];
        const auto& edge = facesAtEdge[edgeKey(a, b)];
        if (edge[2] != 2)
          continue;
        const std::uint32_t other = edge[0] == grown[next] ? edge[1] : edge[0];
        if (flatOf_[other] != kNone || through_[other] < 3 || apart[other] ||
            chainOf(other) != chainOf(seed) || !(dot(areaOf(other), normal) > 0))
          continue;
        const auto& there = soup_.faces[other];
        const bool inPlane = std::all_of(there.begin(), there.end(), [&](std::uint32_t p) {
          return std::abs(dot(normal, minus(soup_.points[p], origin))) <= reach_ / 4;
        });
        const auto at = std::find(there.begin(), there.end(), b) - there.begin();
        if (!inPlane || there[static_cast<std::size_t>(at + 1) % 3] != a)
          continue; // that does not run along the edge the other way
        flatOf_[other] = number;
        grown.push_back(other);
      }
    if (grown.size() < kLeastInFlat) {
      for (const std::uint32_t face : grown)
        flatOf_[face] = kNone;
      continue;
    }
    std::sort(grown.begin(), grown.end());
    flats_.push_back(std::move(grown));
  }
}

Vec3d SoupInsertion::areaOf(std::uint32_t face) const {
  const Vec3d& origin = soup_.points[soup_.faces[face][0]];
  return cross(minus(soup_.points[soup_.faces[face][1]], origin),
               minus(soup_.points[soup_.faces[face][2]], origin));
}

std::array<std::uint32_t, 3> SoupInsertion::cornersOf(std::uint32_t face) const {
  const auto& corners = soup_.faces[face];
  return {corners[0] + firstPoint_, corners[1] + firstPoint_, corners[2] + firstPoint_};
}

Chain SoupInsertion::chainOf(std::uint32_t face) const {
  return unitChain(soup_.inputs.empty() ? 0 : soup_.inputs[face], inputCount_);
}

void SoupInsertion::findFaces(PartWork& mine, const TetComplex& complex) const {
  const TetParts::Part& part = *mine.part;
  const auto isFace = [&](std::uint32_t whole) {
    return whole >= firstPoint_ && whole - firstPoint_ < soup_.points.size();
  };
  // Faces of two corners and more that are the part's own, and the third in it.
  for (std::uint32_t p = 0; p < part.pointOfWhole.size(); ++p) {
    const std::uint32_t whole = part.pointOfWhole[p];
    if (!isFace(whole) || complex.points[p].fixed)
      continue;
    const std::uint32_t point = whole - firstPoint_;
    for (std::uint32_t i = facesBegin_[point]; i < facesBegin_[point + 1]; ++i) {
      const std::uint32_t face = facesOfPoint_[i];
      if (in_[face])
        continue;
      int free = 0;
      bool first = true, here = true;
      for (const std::uint32_t corner : cornersOf(face)) {
        const std::uint32_t local = part.local(corner);
        here = here && local != kNone;
        if (local == kNone || complex.points[local].fixed)
          continue;
        ++free;
        first = first && corner >= whole;
      }
      if (here && first && free >= 2)
        mine.faces.push_back(face);
    }
  }
}

void SoupInsertion::insert(PartWork& mine, TetComplex& complex) const {
  const TetParts::Part& part = *mine.part;
  mine.pointOfWhole = part.pointOfWhole;
  // Flat ones first: they say which way their longest edges go.
  std::sort(mine.faces.begin(), mine.faces.end(), [&](std::uint32_t a, std::uint32_t b) {
    const bool flatA = through_[a] < 3, flatB = through_[b] < 3;
    return flatA != flatB ? flatA : a < b;
  });
  TriangleInserter inserter(complex, mine.paths, tolerance_, reach_,
                            mine.last ? kMostEffort : kFirstEffort);
  // Corners as points of the part, and the paths of edges that are known. False where some of it is
  // in another part.
  const auto bring = [&](std::uint32_t face, std::array<std::uint32_t, 3>& corners) {
    const auto whole = cornersOf(face);
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = part.local(whole[i]);
      if (corners[i] == kNone)
        return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto earlier = paths_.paths.find(edgeKey(whole[i], whole[(i + 1) % 3]));
      if (earlier == paths_.paths.end())
        continue;
      std::vector<std::uint32_t> local;
      for (const std::uint32_t point : earlier->second)
        local.push_back(part.local(point));
      if (std::find(local.begin(), local.end(), kNone) != local.end())
        return false;
      mine.paths.paths.emplace(edgeKey(corners[i], corners[(i + 1) % 3]), std::move(local));
    }
    return true;
  };
  const std::set<std::uint32_t> here(mine.faces.begin(), mine.faces.end());
  std::set<std::uint32_t> done;
  std::unordered_map<std::uint32_t, bool> alone; // flats, whether their faces go in one by one
  for (const std::uint32_t face : mine.faces) {
    mine.progress->check();
    if (done.count(face) > 0)
      continue;
    const std::uint32_t flat = flatOf_[face];
    if (flat != kNone) {
      const auto [known, isNew] = alone.emplace(flat, false);
      if (isNew) {
        const auto& faces = flats_[flat];
        std::vector<std::array<std::uint32_t, 3>> corners(faces.size());
        bool all = true;
        for (std::size_t i = 0; all && i < faces.size(); ++i)
          all =
              here.count(faces[i]) > 0 && done.count(faces[i]) == 0 && bring(faces[i], corners[i]);
        if (all && inserter.insertFlat(corners, chainOf(face)) == TriangleInserter::Result::In) {
          done.insert(faces.begin(), faces.end());
          continue;
        }
        known->second = all || mine.last;
      }
      if (!known->second)
        continue; // perhaps in another round
    }
    std::array<std::uint32_t, 3> corners;
    if (bring(face, corners) &&
        inserter.insert(corners, chainOf(face), through_[face]) == TriangleInserter::Result::In)
      done.insert(face);
    mine.isCutShort = complex.tetCount() > mine.mostTets;
    if (mine.isCutShort)
      break;
  }
  mine.done.assign(done.begin(), done.end());
  mine.newPoints = complex.points.size() - part.pointOfWhole.size();
}

// Of all faces where none are named.
void SoupInsertion::round(TetComplex& complex, int round, const std::vector<std::uint32_t>& named,
                          Progress& progress) {
  const std::size_t before = complex.points.size();
  TetParts parts(complex, round);
  std::vector<PartWork> works(parts.count());
  parts.run(
      [&](TetParts::Part& part) {
        PartWork& mine = works[part.index];
        mine.part = &part;
        mine.progress = &progress;
        mine.last = round < 0;
        mine.mostTets = kGrowth * part.complex.tetCount() + kFreeGrowth;
        mine.faces = named;
        if (named.empty())
          findFaces(mine, part.complex);
        insert(mine, part.complex);
      },
      progress);
  collect(works, before);
  isCutShort_ =
      std::any_of(works.begin(), works.end(), [](const PartWork& mine) { return mine.isCutShort; });
}

// The parts' paths become paths of the whole mesh, halved where a part halved their edges.
void SoupInsertion::collect(const std::vector<PartWork>& works, std::size_t pointsBefore) {
  std::size_t base = pointsBefore;
  for (const PartWork& mine : works) {
    const auto whole = [&](std::uint32_t point) {
      return point < mine.pointOfWhole.size()
                 ? mine.pointOfWhole[point]
                 : static_cast<std::uint32_t>(base + point - mine.pointOfWhole.size());
    };
    for (const auto& [edge, middle] : mine.paths.middles)
      paths_.middles.emplace(edgeKey(whole(static_cast<std::uint32_t>(edge >> 32)),
                                     whole(static_cast<std::uint32_t>(edge))),
                             whole(middle));
    for (const auto& [edge, path] : mine.paths.paths) {
      std::vector<std::uint32_t> joined;
      for (const std::uint32_t point : path)
        joined.push_back(whole(point));
      if (joined.front() > joined.back())
        std::reverse(joined.begin(), joined.end());
      paths_.paths.emplace(edgeKey(joined.front(), joined.back()), std::move(joined));
    }
    for (const std::uint32_t face : mine.done)
      in_[face] = true;
    base += mine.newPoints;
  }
  for (auto& [edge, path] : paths_.paths)
    path = paths_.path(path.front(), path.back());
  paths_.middles.clear();
}

void SoupInsertion::run(TetComplex& complex, const std::vector<std::uint32_t>& first,
                        Progress& progress) {
  if (!first.empty())
    round(complex, -1, first, progress);
  std::size_t now = in_.size(), last = now;
  const auto insertOnce = [&](int r) {
    round(complex, r, {}, progress);
    last = now;
    now = missing().size();
  };
  const auto isWorthwhile = [&] { return now > 0 && kLeastShare * (last - now) >= last; };
  for (int r = 0; r < TetParts::kRounds || (isCutShort_ && isWorthwhile()); ++r) {
    if (isCutShort_)
      thin(complex);
    insertOnce(r % TetParts::kRounds);
  }
  if (isCutShort_)
    thin(complex);
  // As one part, once more as long as a coarser mesh lets more of them in.
  now = in_.size();
  for (insertOnce(-1); isWorthwhile() || (isCutShort_ && now > 0 && now < last); insertOnce(-1))
    thin(complex);
  markRim(complex);
}

// Points that missing faces ask for stay.
void SoupInsertion::thin(TetComplex& complex) {
  markRim(complex);
  std::vector<std::uint32_t> held;
  const auto hold = [&](std::uint32_t point) {
    if (complex.points[point].fixed)
      return;
    complex.points[point].fixed = true;
    held.push_back(point);
  };
  std::unordered_set<std::uint64_t> open;
  for (const std::uint32_t face : missing()) {
    const auto corners = cornersOf(face);
    for (std::size_t i = 0; i < 3; ++i) {
      hold(corners[i]);
      open.insert(edgeKey(corners[i], corners[(i + 1) % 3]));
    }
  }
  for (auto path = paths_.paths.begin(); path != paths_.paths.end();) {
    if (open.count(path->first) == 0) {
      path = paths_.paths.erase(path);
      continue;
    }
    for (const std::uint32_t point : path->second)
      hold(point);
    ++path;
  }
  coarsen_(complex);
  for (const std::uint32_t point : held)
    complex.points[point].fixed = false;
  if (complex.tetCount() > kMostTets + kMostTetsOfFace * soup_.faces.size())
    throw Error(Status::Limit, "",
                "the triangles cut one another into more pieces than can be meshed",
                "a larger epsilon may help; voxelize with `mesher=winding` needs no tets");
}

std::vector<std::uint32_t> SoupInsertion::missing() const {
  std::vector<std::uint32_t> faces;
  for (std::size_t f = 0; f < in_.size(); ++f)
    if (!in_[f])
      faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

void SoupInsertion::markRim(TetComplex& complex) const {
  for (const auto& [a, b] : openEdges(soup_))
    for (const std::uint32_t point : paths_.path(a + firstPoint_, b + firstPoint_))
      complex.points[point].rim = true;
}

} // namespace tetvdb
