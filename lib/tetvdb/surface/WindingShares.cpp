// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/WindingShares.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/SampleBox.h"
#include "tetvdb/surface/WindingField.h"

#include <algorithm>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {
namespace {

// Limit of the number of solid angles.
constexpr std::size_t kMaxWork = 40000000;
constexpr std::size_t kMinSamples = 64;
// Of a winding number: on a sheet it is 0.5.
constexpr double kRounding = 1e-6;

} // namespace

std::array<double, 4> windingShares(const TriangleMesh& mesh,
                                    const std::vector<std::uint32_t>& corners,
                                    const EdgeTable& edges, std::size_t samples,
                                    Progress& progress) {
  const Box box = boxOf(mesh.points, corners);
  if (samples == 0 || corners.empty())
    return {0, 0, 0, 0};
  // Nothing is inside a box without volume, and all rays in it may meet all of its faces.
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!(box.low[axis] < box.high[axis]))
      return {0, 1, 0, 0};
  const WindingField field(mesh, edges);
  samples = std::min(
      samples, std::max(kMinSamples, kMaxWork / std::max<std::size_t>(field.anglesPerPoint(), 1)));

  std::vector<std::uint8_t> bin(samples);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples, 16),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      progress.check();
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const double winding = field.at(pointInBox(box, i));
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
