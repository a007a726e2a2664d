// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/obj/ObjWriter.h"

#include "tetvdb/io/text/TextLine.h"

#include <cstdint>

namespace tetvdb {
namespace {

constexpr std::size_t kPerUpdate = std::size_t(1) << 17;

} // namespace

void writeObj(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  AtomicFile file(path);
  TextLine line(file);
  const std::size_t points = mesh.points.size(), faces = mesh.triangleCount();
  const auto update = [&](std::size_t done) {
    if (done % kPerUpdate == 0)
      progress.update(static_cast<double>(done) / static_cast<double>(points + faces));
  };
  line.word("# TetVDB").end();
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3d& p = mesh.points[i];
    line.word("v").number(p[0]).number(p[1]).number(p[2]).end();
    update(i);
  }
  for (std::size_t t = 0; t < faces; ++t) {
    line.word("f");
    for (std::size_t k = 0; k < 3; ++k)
      line.number(std::uint64_t(mesh.triangles[3 * t + k]) + 1);
    line.end();
    update(points + t);
  }
  file.commit();
}

} // namespace tetvdb
