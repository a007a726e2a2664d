// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WindingShares.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/TriangleScene.h"

#include <algorithm>
#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

constexpr double kPi = 3.14159265358979323846;
// Solid angles in all.
constexpr std::size_t kMaxWork = 40000000;
constexpr std::size_t kLeastSamples = 64;
// Of a winding number: on a sheet it is one half.
constexpr double kRounding = 1e-6;

// Of length 1, along nothing that meshes are usually built along.
const Vec3d kUp = [] {
  const Vec3d way{0.2612, 0.4135, 0.8722};
  return times(way, 1 / length(way));
}();

// An edge that faces run along `weight` times oftener from a to b than from b to a.
struct RimEdge {
  Vec3d a, b;
  double weight;
};

std::vector<RimEdge> findRim(const TriangleMesh& mesh, const EdgeTable& edges) {
  std::vector<RimEdge> rim;
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge) {
    int weight = 0;
    for (const std::uint32_t side : edges.sides(edge))
      weight += edges.ascends(side) ? 1 : -1;
    if (weight != 0)
      rim.push_back(
          {mesh.points[edges.lowPoint(edge)], mesh.points[edges.highPoint(edge)], double(weight)});
  }
  return rim;
}

// The solid angle at p of the triangle from a to b to infinity along kUp, over 4 pi (van Oosterom
// and Strackee 1983, divided by the third corner's distance).
double curtain(const RimEdge& edge, const Vec3d& p) {
  const Vec3d a = minus(edge.a, p), b = minus(edge.b, p);
  const double la = length(a), lb = length(b);
  const double above = dot(cross(a, b), kUp);
  const double below = la * lb + dot(a, b) + dot(b, kUp) * la + dot(a, kUp) * lb;
  return edge.weight * std::atan2(above, below) / (2 * kPi);
}

// Mesh and curtain, which stands on the rim and goes up to infinity, are closed together: their
// winding number is what a ray downwards crosses, of the mesh alone since it runs along the
// curtain.
double windingNumber(const TriangleScene& scene, const std::vector<RimEdge>& rim, double reach,
                     const Vec3d& p, std::vector<TriangleScene::Hit>& hits) {
  scene.crossings(p, times(kUp, -1), reach, hits);
  double winding = 0;
  for (const TriangleScene::Hit& hit : hits)
    winding += hit.leaving ? 1 : -1;
  for (const RimEdge& edge : rim)
    winding += curtain(edge, p);
  return winding;
}

// Fractions of the i-th multiple of powers of 1 / g, g^4 = g + 1: evenly spread in three dimensions
// (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
Vec3d samplePoint(const Box& box, std::size_t i) {
  constexpr double kStep[3] = {0.8191725133961644, 0.6710436067037892, 0.5497004779019702};
  Vec3d p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along = 0.5 + kStep[axis] * double(i + 1);
    p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * (along - std::floor(along));
  }
  return p;
}

} // namespace

std::array<double, 4> windingShares(const TriangleMesh& mesh,
                                    const std::vector<std::uint32_t>& corners,
                                    const EdgeTable& edges, std::size_t samples,
                                    Progress& progress) {
  Box box;
  for (const std::uint32_t corner : corners)
    box.add(mesh.points[corner]);
  const std::vector<RimEdge> rim = findRim(mesh, edges);
  samples =
      std::min(samples, std::max(kLeastSamples, kMaxWork / std::max<std::size_t>(rim.size(), 1)));
  if (samples == 0 || corners.empty())
    return {0, 0, 0, 0};
  const TriangleScene scene(mesh);
  const double reach = 2 * length(minus(box.high, box.low));

  std::vector<std::uint8_t> bin(samples);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      progress.check();
                      std::vector<TriangleScene::Hit> hits;
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const double winding =
                            windingNumber(scene, rim, reach, samplePoint(box, i), hits);
                        bin[i] = winding < -0.5 - kRounding   ? 0
                                 : winding <= 0.5 + kRounding ? 1
                                 : winding <= 1.5 + kRounding ? 2
                                                              : 3;
                      }
                    });
  std::array<double, 4> shares{0, 0, 0, 0};
  for (const std::uint8_t b : bin)
    shares[b] += 1.0;
  for (double& share : shares)
    share /= double(samples);
  return shares;
}

} // namespace tetvdb
