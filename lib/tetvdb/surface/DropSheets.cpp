// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/DropSheets.h"

#include "tetvdb/core/DisjointSets.h"
#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/CompactMesh.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/WindingField.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxSamples = 64, kMinSamples = 8; // faces of a component
constexpr double kMaxWork = 2e8, kMaxCountWork = 2e7;    // solid angles of boundary edges
constexpr std::size_t kMaxCounted = 64;                  // components
constexpr double kInside = 0.6;                          // winding number that is clearly inside
constexpr double kOffset = 1e-5;                         // from a face, relative to the diagonal

struct Part {
  std::vector<std::uint32_t> faces;
  bool open = false;
};

std::vector<Part> openParts(const TriangleMesh& mesh) {
  const EdgeTable edges(mesh);
  DisjointSets sets(mesh.triangleCount());
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    const EdgeTable::Sides sides = edges.sides(edge);
    for (std::size_t i = 1; i < sides.size(); ++i)
      sets.join(EdgeTable::faceOf(sides[0]), EdgeTable::faceOf(sides[i]));
  }
  std::vector<std::uint32_t> number(mesh.triangleCount(), EdgeTable::kNone);
  std::vector<Part> parts;
  for (std::uint32_t face = 0; face < number.size(); ++face) {
    const std::uint32_t first = sets.find(face);
    if (first == face) {
      number[face] = static_cast<std::uint32_t>(parts.size());
      parts.emplace_back();
    }
    number[face] = number[first];
    parts[number[face]].faces.push_back(face);
  }
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (edges.imbalance(edge) != 0)
      parts[number[EdgeTable::faceOf(edges.sides(edge)[0])]].open = true;
  parts.erase(
      std::remove_if(parts.begin(), parts.end(), [](const Part& part) { return !part.open; }),
      parts.end());
  return parts;
}

class SheetSearch {
public:
  explicit SheetSearch(const TriangleMesh& mesh) : mesh_(mesh), field_(mesh) {
    const Box box = boxOf(mesh.points, mesh.triangles);
    offset_ = kOffset * length(minus(box.high, box.low));
  }

  std::size_t anglesPerPoint() const { return field_.anglesPerPoint(); }

  double areaOf(const Part& part) const {
    double area = 0;
    for (const std::uint32_t face : part.faces)
      area += length(normal(face)) / 2;
    return area;
  }

  enum class Finding { Bounds, Sheet, Within };

  Finding look(const Part& part, std::size_t samples) const {
    std::vector<double> sums{0};
    for (const std::uint32_t face : part.faces)
      sums.push_back(sums.back() + length(normal(face)));
    std::size_t bounding = 0, looked = 0, last = part.faces.size();
    for (std::size_t i = 0; i < samples; ++i) {
      const double wanted = sums.back() * (double(i) + 0.5) / double(samples);
      const auto above = std::upper_bound(sums.begin() + 1, sums.end(), wanted);
      const auto at =
          std::min(static_cast<std::size_t>(above - sums.begin()) - 1, part.faces.size() - 1);
      if (samples > part.faces.size() && at == last)
        continue;
      last = at;
      const double inner = innerWinding(part.faces[at]);
      if (inner >= 2 - kInside)
        continue;
      ++looked;
      bounding += inner > kInside;
    }
    if (looked == 0)
      return Finding::Within;
    return 2 * bounding < looked ? Finding::Sheet : Finding::Bounds;
  }

private:
  Vec3d normal(std::uint32_t face) const {
    const std::uint32_t* c = &mesh_.triangles[3 * std::size_t(face)];
    return cross(minus(mesh_.points[c[1]], mesh_.points[c[0]]),
                 minus(mesh_.points[c[2]], mesh_.points[c[0]]));
  }

  double innerWinding(std::uint32_t face) const {
    const std::uint32_t* c = &mesh_.triangles[3 * std::size_t(face)];
    const Vec3d midpoint =
        times(plus(plus(mesh_.points[c[0]], mesh_.points[c[1]]), mesh_.points[c[2]]), 1.0 / 3);
    const Vec3d n = normal(face);
    const double size = length(n);
    return size > 0 ? field_.at(minus(midpoint, times(n, offset_ / size))) : 0;
  }

  const TriangleMesh& mesh_;
  WindingField field_;
  double offset_ = 0;
};

} // namespace

OpenComponents countSheets(const TriangleMesh& mesh, Progress& progress) {
  OpenComponents found;
  std::vector<Part> parts = openParts(mesh);
  found.count = parts.size();
  if (parts.empty() || parts[0].faces.size() == mesh.triangleCount())
    return found;
  const SheetSearch search(mesh);
  const double each = double(kMinSamples) * double(search.anglesPerPoint());
  const auto counted = static_cast<std::size_t>(
      std::min({double(parts.size()), double(kMaxCounted), kMaxCountWork / each}));
  found.exact = counted == parts.size();
  if (counted < std::min(parts.size(), kMinSamples))
    return found;
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < parts.size(); ++i)
    order.emplace_back(search.areaOf(parts[i]), i);
  std::sort(order.begin(), order.end());
  std::atomic<std::size_t> sheets{0};
  tbb::parallel_for(std::size_t(0), counted, [&](std::size_t i) {
    progress.check();
    const std::size_t at = (2 * i + 1) * parts.size() / (2 * counted);
    sheets += search.look(parts[order[at].second], kMinSamples) == SheetSearch::Finding::Sheet;
  });
  found.sheets = sheets * parts.size() / counted;
  return found;
}

SheetCounts dropSheets(TriangleMesh& mesh, Progress& progress) {
  SheetCounts counts;
  const std::vector<Part> parts = openParts(mesh);
  if (parts.empty())
    return counts;
  const SheetSearch search(mesh);
  const double each = double(parts.size()) * double(search.anglesPerPoint());
  if (each * kMinSamples > kMaxWork) {
    counts.complete = false;
    return counts;
  }
  const std::size_t samples = static_cast<std::size_t>(
      std::clamp(kMaxWork / each, double(kMinSamples), double(kMaxSamples)));
  std::vector<char> isSheet(parts.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, parts.size(), 1), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      progress.check();
      isSheet[i] = search.look(parts[i], samples) != SheetSearch::Finding::Bounds;
    }
  });
  std::vector<char> drops(mesh.triangleCount(), 0);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (isSheet[i] == 0)
      continue;
    ++counts.parts;
    for (const std::uint32_t face : parts[i].faces)
      drops[face] = 1;
  }
  if (counts.parts > 0) {
    counts.faces = dropFaces(mesh, drops);
    dropUnusedPoints(mesh);
  }
  return counts;
}

} // namespace tetvdb
