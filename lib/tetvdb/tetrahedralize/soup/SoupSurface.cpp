// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/SoupSurface.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {

SoupSurface::SoupSurface(LatticeSoup soup, double spacing)
    : points(std::move(soup.points)), grain(soup.grain), faces(std::move(soup.faces)),
      inputs(std::move(soup.inputs)), firstCorner(points.size(), kNone),
      nextCorner(3 * faces.size()), isFixed(points.size()), part(points.size(), 0),
      isDue(points.size(), 1), depth(faces.size(), 0), carried(points), isCarried(points.size(), 0),
      firstCarried(faces.size(), kNone), nextCarried(points.size(), kNone) {
  for (auto corner = static_cast<std::uint32_t>(nextCorner.size()); corner-- > 0;)
    link(faces[corner / 3][corner % 3], corner);
  for (std::uint32_t face = 0; face < faces.size(); ++face)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d &a = points[faces[face][k]], &b = points[faces[face][(k + 1) % 3]];
      const Vec3d edge = minus(b, a);
      if (faces[face][k] > faces[face][(k + 1) % 3] || dot(edge, edge) <= spacing * spacing)
        continue;
      carried.push_back(times(plus(a, b), 0.5));
      isCarried.push_back(1);
      nextCarried.push_back(kNone);
      carry(face, static_cast<std::uint32_t>(carried.size() - 1));
    }
  tbb::parallel_for(std::size_t(0), points.size(), [&](std::size_t point) {
    isFixed[point] = !isClosedFan(static_cast<std::uint32_t>(point));
  });
}

bool SoupSurface::isClosedFan(std::uint32_t point) const {
  // The edges opposite the point are to be one cycle.
  std::vector<std::array<std::uint32_t, 2>> edges;
  const std::uint32_t first = firstCorner[point];
  for (std::uint32_t c = first; c != kNone; c = nextCorner[c]) {
    if (inputOf(c / 3) != inputOf(first / 3))
      return false;
    edges.push_back({faces[c / 3][(c + 1 - c / 3 * 3) % 3], faces[c / 3][(c + 2 - c / 3 * 3) % 3]});
  }
  if (edges.size() < 3)
    return false;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends; // a neighbour and the edge it ends
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    for (const std::uint32_t neighbour : edges[e])
      ends.push_back({neighbour, e});
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0; i < ends.size(); i += 2)
    if (ends[i].first != ends[i + 1].first || (i > 0 && ends[i].first == ends[i - 1].first))
      return false;
  std::uint32_t edge = 0, at = edges[0][0];
  std::size_t steps = 0;
  do {
    at = edges[edge][0] == at ? edges[edge][1] : edges[edge][0];
    const auto end = std::lower_bound(ends.begin(), ends.end(), std::make_pair(at, 0u));
    edge = end->second == edge ? (end + 1)->second : end->second;
    ++steps;
  } while (edge != 0);
  return steps == edges.size();
}

void SoupSurface::findStar(std::uint32_t point, std::size_t max, std::vector<std::uint32_t>& star) {
  star.clear();
  std::uint32_t* link = &firstCorner[point];
  while (*link != kNone && star.size() <= max) {
    if (isGone(*link / 3)) {
      *link = nextCorner[*link];
      continue;
    }
    star.push_back(*link / 3);
    link = &nextCorner[*link];
  }
}

void SoupSurface::unlink(std::uint32_t point, std::uint32_t corner) {
  std::uint32_t* link = &firstCorner[point];
  while (*link != corner)
    link = &nextCorner[*link];
  *link = nextCorner[corner];
}

LatticeSoup SoupSurface::rest() const {
  LatticeSoup soup;
  soup.grain = grain;
  std::vector<std::uint32_t> number(points.size(), kNone);
  for (std::uint32_t face = 0; face < faces.size(); ++face)
    if (!isGone(face)) {
      for (const std::uint32_t v : faces[face])
        number[v] = 0;
      soup.faces.push_back(faces[face]);
      if (!inputs.empty())
        soup.inputs.push_back(inputs[face]);
    }
  for (std::size_t v = 0; v < points.size(); ++v)
    if (number[v] != kNone) {
      number[v] = static_cast<std::uint32_t>(soup.points.size());
      soup.points.push_back(points[v]);
    }
  for (auto& face : soup.faces)
    for (std::uint32_t& v : face)
      v = number[v];
  return soup;
}

} // namespace tetvdb
