// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/TriangleLines.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/io/text/TextLine.h"

namespace tetvdb {
namespace {} // namespace

void writeTriangleLines(const std::string& path, const TriangleMesh& mesh,
                        const TriangleLines& lines, Progress& progress) {
  AtomicFile file(path);
  file.write(lines.head.data(), lines.head.size());
  TextLine line(file);
  const std::size_t points = mesh.points.size(), faces = mesh.triangleCount();
  const auto begin = [&](std::string_view word, std::size_t done) {
    if (!word.empty())
      line.word(word);
    if (done % kItemsPerUpdate == 0)
      progress.update(static_cast<double>(done) / static_cast<double>(points + faces));
  };
  for (std::size_t i = 0; i < points; ++i) {
    begin(lines.ofPoint, i);
    const Vec3d& p = mesh.points[i];
    line.number(p[0]).number(p[1]).number(p[2]).end();
  }
  for (std::size_t t = 0; t < faces; ++t) {
    begin(lines.ofFace, points + t);
    for (std::size_t k = 0; k < 3; ++k)
      line.number(lines.firstPoint + mesh.triangles[3 * t + k]);
    line.end();
  }
  file.commit();
}

} // namespace tetvdb
