// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/medit/MeditWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/io/text/TextLine.h"

#include <string_view>

namespace tetvdb {
namespace {} // namespace

void writeMedit(const std::string& path, const TetMesh& mesh, Progress& progress) {
  AtomicFile file(path);
  TextLine line(file);
  const std::size_t total = mesh.points.size() + mesh.tetCount();
  file.write("MeshVersionFormatted 2\nDimension 3\nVertices\n");
  line.number(mesh.points.size());
  line.end();
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    for (const double x : mesh.points[i])
      line.number(x);
    line.number(0);
    line.end();
    if (i % kItemsPerUpdate == 0)
      progress.update(static_cast<double>(i) / static_cast<double>(total));
  }
  file.write("Tetrahedra\n");
  line.number(mesh.tetCount());
  line.end();
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    for (std::size_t k = 0; k < 4; ++k)
      line.number(std::uint64_t(mesh.tets[4 * t + k]) + 1);
    line.number(mesh.regions.empty() ? 0 : mesh.regions[mesh.cell(t)]);
    line.end();
    if (t % kItemsPerUpdate == 0)
      progress.update(static_cast<double>(mesh.points.size() + t) / static_cast<double>(total));
  }
  file.write("End\n");
  file.commit();
}

} // namespace tetvdb
