// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/SoupBoundary.h"

#include "tetvdb/surface/EdgeTable.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace tetvdb {

SoupBoundary soupBoundary(const TriangleMesh& mesh, Progress& progress) {
  const EdgeTable table(mesh);
  progress.check();
  return tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, table.edgeCount(), 16384), SoupBoundary(),
      [&](const auto& range, SoupBoundary sum) {
        for (std::uint32_t edge = range.begin(); edge != range.end(); ++edge) {
          const std::uint32_t low = table.lowPoint(edge), high = table.highPoint(edge);
          const int weight = table.imbalance(edge);
          if (weight > 0)
            sum.edges.push_back({low, high, weight});
          else if (weight < 0)
            sum.edges.push_back({high, low, -weight});
          sum.oddEdges += table.sides(edge).size() % 2;
        }
        return sum;
      },
      [](SoupBoundary sum, const SoupBoundary& next) {
        sum.edges.insert(sum.edges.end(), next.edges.begin(), next.edges.end());
        sum.oddEdges += next.oddEdges;
        return sum;
      });
}

} // namespace tetvdb
