// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/ply/PlyWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace tetvdb {
namespace {} // namespace

void writePly(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  const std::size_t points = mesh.points.size(), faces = mesh.triangleCount();
  if (points > UINT32_MAX || faces > UINT32_MAX)
    throw Error(Status::Limit, path, "more points or faces than other programs read from .ply",
                "write several files");
  AtomicFile file(path);
  // More programs support int than uint.
  const char* index = points <= std::size_t(INT32_MAX) ? "int" : "uint";
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment TetVDB\n"
                             "element vertex " +
                             std::to_string(points) +
                             "\nproperty double x\nproperty double y\nproperty double z\n"
                             "element face " +
                             std::to_string(faces) + "\nproperty list uchar " + index +
                             " vertex_indices\nend_header\n";
  file.write(header.data(), header.size());
  for (std::size_t done = 0; done < points; done += kItemsPerUpdate) {
    const std::size_t n = std::min(kItemsPerUpdate, points - done);
    file.write(mesh.points.data() + done, n * sizeof(Vec3d));
    progress.update(static_cast<double>(done) / static_cast<double>(points + faces));
  }
  for (std::size_t t = 0; t < faces; ++t) {
    char row[13] = {3};
    std::memcpy(row + 1, mesh.triangles.data() + 3 * t, 12);
    file.write(row, sizeof row);
    if (t % kItemsPerUpdate == 0)
      progress.update(static_cast<double>(points + t) / static_cast<double>(points + faces));
  }
  file.commit();
}

} // namespace tetvdb
