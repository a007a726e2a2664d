// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/CompareSolids.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/SampleBox.h"
#include "tetvdb/surface/WindingField.h"

#include <algorithm>
#include <cstdint>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kFirstSamples = 1 << 13, kMaxSamples = 1 << 17, kEnoughInside = 8000;
constexpr std::size_t kMaxWork = 100000000; // solid angles of boundary edges

enum Bits : std::uint8_t { kBefore = 1, kAfter = 2, kSureInside = 4, kSureOutside = 8 };

} // namespace

SolidComparison compareSolids(const TriangleMesh& before, const TriangleMesh& after,
                              Progress& progress) {
  SolidComparison result;
  if (before.triangles.empty() || after.triangles.empty())
    return result;
  const WindingField first(before), second(after);
  Box box = boxOf(before.points, before.triangles);
  box.add(boxOf(after.points, after.triangles));
  const std::size_t angles =
      std::max<std::size_t>(1, first.anglesPerPoint() + second.anglesPerPoint());
  const std::size_t max = std::clamp(kMaxWork / angles, kFirstSamples / 16, kMaxSamples);

  std::vector<std::uint8_t> bits;
  std::size_t lost = 0, gained = 0, doubtful = 0, insideFirst = 0, insideSecond = 0;
  for (std::size_t end = std::min(kFirstSamples, max);;) {
    const std::size_t begin = bits.size();
    bits.resize(end);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, 16), [&](const auto& range) {
      progress.check();
      for (std::size_t i = range.begin(); i != range.end(); ++i) {
        const Vec3d p = pointInBox(box, i);
        const double winding = first.at(p);
        bits[i] = static_cast<std::uint8_t>(
            (winding > 0.5 ? kBefore : 0) | (second.at(p) > 0.5 ? kAfter : 0) |
            (winding > 0.6 ? kSureInside : 0) | (winding < 0.4 ? kSureOutside : 0));
      }
    });
    for (std::size_t i = begin; i < end; ++i) {
      const unsigned b = bits[i];
      insideFirst += (b & kBefore) != 0;
      insideSecond += (b & kAfter) != 0;
      result.inside += (b & (kBefore | kAfter)) != 0;
      lost += (b & kSureInside) != 0 && (b & kAfter) == 0;
      gained += (b & kSureOutside) != 0 && (b & kAfter) != 0;
      doubtful += (b & (kSureInside | kSureOutside)) == 0;
    }
    if (result.inside >= kEnoughInside || 2 * end > max)
      break;
    end *= 2;
  }
  result.samples = bits.size();
  double each = 1 / double(result.samples);
  for (std::size_t axis = 0; axis < 3; ++axis)
    each *= box.high[axis] - box.low[axis];
  result.before = each * double(insideFirst);
  result.after = each * double(insideSecond);
  result.lost = each * double(lost);
  result.gained = each * double(gained);
  result.doubtful = each * double(doubtful);
  return result;
}

} // namespace tetvdb
