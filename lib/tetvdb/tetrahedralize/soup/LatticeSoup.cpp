// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/soup/LatticeSoup.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/WeldPoints.h"

#include <algorithm>
#include <tbb/parallel_sort.h>
#include <tuple>
#include <utility>

namespace tetvdb {
namespace {

using Face = std::array<std::uint32_t, 3>;

// Of faces of one input over the same three points the surplus of one side over the other decides:
// none where they balance, the first of the side that is left otherwise.
std::vector<std::uint8_t> keptFaces(const LatticeSoup& soup) {
  struct Entry {
    Face key;
    std::uint16_t input;
    std::uint32_t face;
    bool even;
  };
  std::vector<Entry> entries;
  std::vector<std::uint8_t> kept(soup.faces.size(), 0);
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    Face key = soup.faces[f];
    if (key[0] == key[1] || key[1] == key[2] || key[2] == key[0])
      continue;
    const auto smallest = std::min_element(key.begin(), key.end());
    std::rotate(key.begin(), smallest, key.end());
    const bool even = key[1] < key[2];
    if (!even)
      std::swap(key[1], key[2]);
    entries.push_back({key, soup.inputs.empty() ? std::uint16_t(0) : soup.inputs[f],
                       static_cast<std::uint32_t>(f), even});
  }
  const auto order = [](const Entry& e) { return std::tie(e.key, e.input, e.face); };
  tbb::parallel_sort(entries.begin(), entries.end(),
                     [&](const Entry& a, const Entry& b) { return order(a) < order(b); });
  for (std::size_t i = 0, end; i < entries.size(); i = end) {
    int surplus = 0;
    for (end = i; end < entries.size() && entries[end].key == entries[i].key &&
                  entries[end].input == entries[i].input;
         ++end)
      surplus += entries[end].even ? 1 : -1;
    for (std::size_t k = i; surplus != 0 && k < end; ++k)
      if (entries[k].even == (surplus > 0)) {
        kept[entries[k].face] = 1;
        break;
      }
  }
  return kept;
}

} // namespace

std::vector<std::array<std::uint32_t, 2>> openEdges(const LatticeSoup& soup) {
  if (soup.faces.empty())
    return {};
  const EdgeTable table(soup.faces.front().data(), soup.faces.size(), soup.points.size());
  std::vector<std::array<std::uint32_t, 2>> open;
  for (std::uint32_t side = 0; side < 3 * soup.faces.size(); ++side) {
    const Face& face = soup.faces[EdgeTable::faceOf(side)];
    if (table.sides(table.edgeOf(side)).size() == 1)
      open.push_back({face[side % 3], face[(side + 1) % 3]});
  }
  return open;
}

void tidySoup(LatticeSoup& soup, Progress& progress) {
  const std::vector<std::uint32_t> first = weldPoints(soup.points, 0, progress);
  for (Face& face : soup.faces)
    for (std::uint32_t& corner : face)
      corner = first[corner];
  const std::vector<std::uint8_t> kept = keptFaces(soup);
  std::vector<std::uint32_t> numbers(soup.points.size(), 0);
  std::size_t faces = 0;
  for (std::size_t f = 0; f < soup.faces.size(); ++f) {
    if (kept[f] == 0)
      continue;
    soup.faces[faces] = soup.faces[f];
    if (!soup.inputs.empty())
      soup.inputs[faces] = soup.inputs[f];
    for (const std::uint32_t corner : soup.faces[faces])
      numbers[corner] = 1;
    ++faces;
  }
  soup.faces.resize(faces);
  if (!soup.inputs.empty())
    soup.inputs.resize(faces);
  std::uint32_t next = 0;
  for (std::size_t p = 0; p < soup.points.size(); ++p)
    if (numbers[p] != 0) {
      soup.points[next] = soup.points[p];
      numbers[p] = next++;
    }
  soup.points.resize(next);
  for (Face& face : soup.faces)
    for (std::uint32_t& corner : face)
      corner = numbers[corner];
}

LatticeSoup latticeSoup(const std::vector<TriangleMesh>& inputs, const WorkingLattice& lattice,
                        double grain, Progress& progress) {
  LatticeSoup soup;
  soup.grain = grain;
  for (std::size_t input = 0; input < inputs.size(); ++input) {
    const auto base = static_cast<std::uint32_t>(soup.points.size());
    for (const Vec3d& p : inputs[input].points)
      soup.points.push_back(roundToGrain(lattice.toLattice(p), grain));
    const auto& corners = inputs[input].triangles;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      soup.faces.push_back({base + corners[i], base + corners[i + 1], base + corners[i + 2]});
    if (inputs.size() > 1)
      soup.inputs.resize(soup.faces.size(), static_cast<std::uint16_t>(input));
  }
  tidySoup(soup, progress);
  return soup;
}

} // namespace tetvdb
