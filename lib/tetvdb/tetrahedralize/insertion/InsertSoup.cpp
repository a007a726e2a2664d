// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/insertion/InsertSoup.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/tetrahedralize/TooManyTets.h"
#include "tetvdb/tetrahedralize/complex/TetParts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = TetComplex::kNone;

// Triangles lower than this many tolerances are almost collinear: the path of their longest edge
// goes through their apex, and no face is needed.
constexpr double kFlat = 3;

// Faces that are inserted together: fewer are as quick one by one, of more every point would be
// compared with all.
constexpr std::size_t kMinInFlat = 12;
constexpr std::size_t kMaxInFlat = 2000;

// A part may grow in a round to so many times its tets, and so many more.
constexpr std::size_t kGrowth = 3, kFreeGrowth = 50000;
// The tets that coarsening may leave of a mesh that has grown too much, and more for each face.
constexpr std::size_t kMaxTets = 1500000, kMaxTetsOfFace = 40;
// Rounds continue as long as one of so many missing faces goes in.
constexpr std::size_t kMinShare = 8;
// Tets visited for a triangle: fewer where there is another round.
constexpr std::size_t kMaxEffort = 1000000, kFirstEffort = 200000;

// The tolerance within which a point is on a triangle: a share of the reach, and at least so many
// lattice units, far above the rounding of points.
constexpr double kReach = 1e4, kMinTolerance = 16;

} // namespace

// What a part has to do, and has done.
struct SoupInsertion::PartWork {
  const TetParts::Part* part = nullptr;
  const Progress* progress = nullptr;
  std::vector<std::uint32_t> faces; // of the soup, ascending
  bool last = false;                // there is no other part, now or later
  std::size_t maxTets = 0;
  bool isCutShort = false;                // at these
  std::set<std::uint32_t> here, inserted; // of faces
  /// Flats that were tried, and whether their faces go in one by one.
  std::unordered_map<std::uint32_t, bool> areAlone;
  std::vector<std::uint32_t> pointOfWhole; // as Part's
  std::size_t newPoints = 0;
  InsertedPaths paths; // of points of the part
};

SoupInsertion::SoupInsertion(const LatticeSoup& soup, std::size_t inputCount,
                             std::uint32_t firstPoint, double reach,
                             std::function<void(TetComplex&)> coarsen)
    : soup_(soup), inputCount_(inputCount), firstPoint_(firstPoint),
      tolerance_(std::max(kMinTolerance, reach / kReach)),
      reach_(std::max(reach, 2 * kMinTolerance)), in_(soup.faces.size(), false),
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

SoupInsertion::EdgeFaces SoupInsertion::facesAtEdges() const {
  EdgeFaces facesAtEdge;
  for (std::size_t f = 0; f < soup_.faces.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      auto& edge = facesAtEdge[edgeKey(soup_.faces[f][i], soup_.faces[f][(i + 1) % 3])];
      if (edge.count < 2)
        edge.faces[edge.count] = static_cast<std::uint32_t>(f);
      ++edge.count;
    }
  return facesAtEdge;
}

void SoupInsertion::findFlats() {
  const EdgeFaces facesAtEdge = facesAtEdges();
  // Faces that may go in together. One next to an almost collinear face goes in alone: the path of
  // that face may lead around it.
  std::vector<bool> isFree(soup_.faces.size());
  for (std::size_t f = 0; f < soup_.faces.size(); ++f)
    isFree[f] = through_[f] == 3;
  for (const auto& [key, edge] : facesAtEdge)
    if (edge.count >= 2 && (through_[edge.faces[0]] < 3 || through_[edge.faces[1]] < 3))
      isFree[edge.faces[0]] = isFree[edge.faces[1]] = false;
  flatOf_.assign(soup_.faces.size(), kNone);
  for (std::uint32_t seed = 0; seed < soup_.faces.size(); ++seed) {
    if (!isFree[seed])
      continue;
    std::vector<std::uint32_t> grown = growFlat(seed, facesAtEdge, isFree);
    const bool isFlat = grown.size() >= kMinInFlat;
    for (const std::uint32_t face : grown) {
      isFree[face] = !isFlat;
      flatOf_[face] = isFlat ? static_cast<std::uint32_t>(flats_.size()) : kNone;
    }
    if (!isFlat)
      continue;
    std::sort(grown.begin(), grown.end());
    flats_.push_back(std::move(grown));
  }
}

// The faces in the plane of a face that are connected to it, itself first. Not free any more.
std::vector<std::uint32_t> SoupInsertion::growFlat(std::uint32_t seed, const EdgeFaces& facesAtEdge,
                                                   std::vector<bool>& isFree) const {
  const Vec3d& origin = soup_.points[soup_.faces[seed][0]];
  const Vec3d area = areaOf(seed);
  const Vec3d normal = times(area, 1 / length(area));
  std::vector<std::uint32_t> grown{seed};
  isFree[seed] = false;
  for (std::size_t next = 0; next < grown.size() && grown.size() < kMaxInFlat; ++next)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& corners = soup_.faces[grown[next]];
      const std::uint32_t a = corners[i], b = corners[(i + 1) % 3];
      const EdgeFace& edge = facesAtEdge.at(edgeKey(a, b));
      if (edge.count != 2)
        continue;
      const std::uint32_t other = edge.faces[edge.faces[0] == grown[next] ? 1 : 0];
      if (!isFree[other] || chainOf(other) != chainOf(seed) || !(dot(areaOf(other), normal) > 0))
        continue;
      const auto& there = soup_.faces[other];
      const bool inPlane = std::all_of(there.begin(), there.end(), [&](std::uint32_t p) {
        return std::abs(dot(normal, minus(soup_.points[p], origin))) <= reach_ / 4;
      });
      // Oriented faces have their edge in opposite directions.
      const auto at = std::find(there.begin(), there.end(), b) - there.begin();
      if (!inPlane || there[static_cast<std::size_t>(at + 1) % 3] != a)
        continue;
      isFree[other] = false;
      grown.push_back(other);
    }
  return grown;
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

// Corners as points of the part, and the paths of edges that are known. False where some of these
// are in another part.
bool SoupInsertion::bring(std::uint32_t face, PartWork& mine,
                          std::array<std::uint32_t, 3>& corners) const {
  const TetParts::Part& part = *mine.part;
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
}

// Whether all faces of a flat are the part's and went in together.
bool SoupInsertion::insertFlat(std::uint32_t flat, PartWork& mine,
                               TriangleInserter& inserter) const {
  const auto& faces = flats_[flat];
  std::vector<std::array<std::uint32_t, 3>> corners(faces.size());
  for (std::size_t i = 0; i < faces.size(); ++i)
    if (mine.here.count(faces[i]) == 0 || mine.inserted.count(faces[i]) != 0 ||
        !bring(faces[i], mine, corners[i]))
      return mine.areAlone[flat] = false;
  if (inserter.insertFlat(corners, chainOf(faces[0])) != TriangleInserter::Result::In) {
    mine.areAlone[flat] = true;
    return false;
  }
  mine.inserted.insert(faces.begin(), faces.end());
  return true;
}

void SoupInsertion::insert(PartWork& mine, TetComplex& complex) const {
  mine.pointOfWhole = mine.part->pointOfWhole;
  // Almost collinear ones first: they decide the paths of their longest edges.
  std::sort(mine.faces.begin(), mine.faces.end(), [&](std::uint32_t a, std::uint32_t b) {
    const bool flatA = through_[a] < 3, flatB = through_[b] < 3;
    return flatA != flatB ? flatA : a < b;
  });
  mine.here.insert(mine.faces.begin(), mine.faces.end());
  TriangleInserter inserter(complex, mine.paths, tolerance_, reach_,
                            mine.last ? kMaxEffort : kFirstEffort);
  for (const std::uint32_t face : mine.faces) {
    mine.progress->check();
    if (mine.inserted.count(face) > 0)
      continue;
    if (const std::uint32_t flat = flatOf_[face]; flat != kNone) {
      if (mine.areAlone.count(flat) == 0 && insertFlat(flat, mine, inserter))
        continue;
      if (!mine.areAlone[flat] && !mine.last)
        continue; // perhaps in another round
    }
    std::array<std::uint32_t, 3> corners;
    if (bring(face, mine, corners) &&
        inserter.insert(corners, chainOf(face), through_[face]) == TriangleInserter::Result::In)
      mine.inserted.insert(face);
    mine.isCutShort = complex.tetCount() > mine.maxTets;
    if (mine.isCutShort)
      break;
  }
  mine.newPoints = complex.points.size() - mine.part->pointOfWhole.size();
}

// Inserts the named faces; all faces where none are named.
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
        mine.maxTets = kGrowth * part.complex.tetCount() + kFreeGrowth;
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
    for (const auto& [edge, midpoint] : mine.paths.midpoints)
      paths_.midpoints.emplace(edgeKey(whole(static_cast<std::uint32_t>(edge >> 32)),
                                       whole(static_cast<std::uint32_t>(edge))),
                               whole(midpoint));
    for (const auto& [edge, path] : mine.paths.paths) {
      std::vector<std::uint32_t> joined;
      for (const std::uint32_t point : path)
        joined.push_back(whole(point));
      if (joined.front() > joined.back())
        std::reverse(joined.begin(), joined.end());
      paths_.paths.emplace(edgeKey(joined.front(), joined.back()), std::move(joined));
    }
    for (const std::uint32_t face : mine.inserted)
      in_[face] = true;
    base += mine.newPoints;
  }
  for (auto& [edge, path] : paths_.paths)
    path = paths_.path(path.front(), path.back());
  paths_.midpoints.clear();
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
  const auto isWorthwhile = [&] { return now > 0 && kMinShare * (last - now) >= last; };
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
  markBoundary(complex);
}

// Coarsens the mesh. Points of missing faces and of their paths stay.
void SoupInsertion::thin(TetComplex& complex) {
  markBoundary(complex);
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
  if (complex.tetCount() > kMaxTets + kMaxTetsOfFace * soup_.faces.size())
    throw TooManyTets(Status::Limit, "",
                      "the triangles cut one another into more tets than can be meshed",
                      "a larger epsilon may help; voxelize with `mesher=winding` needs no tets");
}

std::vector<std::uint32_t> SoupInsertion::missing() const {
  std::vector<std::uint32_t> faces;
  for (std::size_t f = 0; f < in_.size(); ++f)
    if (!in_[f])
      faces.push_back(static_cast<std::uint32_t>(f));
  return faces;
}

void SoupInsertion::markBoundary(TetComplex& complex) const {
  for (const auto& [a, b] : openEdges(soup_))
    for (const std::uint32_t point : paths_.path(a + firstPoint_, b + firstPoint_))
      complex.points[point].onBoundary = true;
}

} // namespace tetvdb
