// SPDX-License-Identifier: Apache-2.0
//
// What the tests of triangle readers and writers share.
#pragma once

#include "io/MeshSamples.h"
#include "tetvdb/io/TriangleReader.h"

#include <cstdio>
#include <functional>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>
#include <vector>

namespace tetvdb::test {

using ReadTriangles = TriangleMesh (*)(const Source&, Report&, Progress&);
using Indices = std::vector<std::uint32_t>;

/// A mesh, and what the report says of it.
struct Reading {
  TriangleMesh mesh;
  Report report;
  std::string error; ///< the message of the Error; then the mesh is empty
  Status status = Status::Ok;

  /// Codes of the warnings, in order, parted by spaces.
  std::string codes() const {
    std::string text;
    for (const Warning& warning : report.warnings)
      text += (text.empty() ? "" : " ") + warning.code;
    return text;
  }
};

inline Reading reading(const std::function<TriangleMesh(Report&, Progress&)>& read) {
  Reading result;
  Progress progress;
  try {
    result.mesh = read(result.report, progress);
    EXPECT_TRUE(result.mesh.triangleCount() > 0);
  } catch (const Error& error) {
    result.error = error.what();
    result.status = error.status();
    EXPECT_EQ(result.error.find('\n'), std::string::npos) << result.error;
  }
  for (const std::uint32_t corner : result.mesh.triangles)
    EXPECT_LT(corner, result.mesh.points.size());
  for (const Vec3d& p : result.mesh.points)
    EXPECT_TRUE(std::isfinite(p[0] + 0 * p[1] + 0 * p[2]));
  return result;
}

inline Reading reading(ReadTriangles read, const std::string& bytes) {
  return reading([&](Report& report, Progress& progress) {
    return read(Source{bytes, "file"}, report, progress);
  });
}

/// A file of the system's temporary folder, removed in the end.
class TemporaryPath {
public:
  explicit TemporaryPath(const std::string& name)
      : path_(testing::TempDir() + "tetvdb_" + std::to_string(::getpid()) + "_" + name) {}
  TemporaryPath(const std::string& name, const std::string& bytes) : TemporaryPath(name) {
    write(bytes);
  }
  ~TemporaryPath() { std::remove(path_.c_str()); }
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;
  const std::string& str() const { return path_; }
  /// Without its folder.
  std::string name() const { return path_.substr(path_.find_last_of('/') + 1); }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

private:
  std::string path_;
};

/// readTriangles() on a file of that name.
inline Reading readingFile(const std::string& name, const std::string& bytes,
                           FileFormat* format = nullptr) {
  const TemporaryPath file(name, bytes);
  return reading([&](Report& report, Progress& progress) {
    return readTriangles(file.str(), report, progress, format);
  });
}

/// The tetrahedron (0,0,0), (1,0,0), (0,1,0), (0,0,1).
inline TriangleMesh cornerTetrahedron() {
  TriangleMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  mesh.faceCount = 4;
  return mesh;
}

} // namespace tetvdb::test
