// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/stl/StlWriter.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace tetvdb {
namespace {

float toFloat(double x) {
  constexpr double largest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -largest, largest));
}

/// Of unit length; 0 where the face has no area.
Vec3d normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d u{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const Vec3d v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  Vec3d n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (!(length > 0) || !std::isfinite(length))
    return {0, 0, 0};
  for (double& x : n)
    x /= length;
  return n;
}

} // namespace

void writeStl(const std::string& path, const TriangleMesh& mesh, Progress& progress) {
  const std::size_t n = mesh.triangleCount();
  if (n > UINT32_MAX)
    throw Error(Status::Limit, path, "more faces than a .stl file can count",
                "write .ply or .obj, or several files");
  AtomicFile file(path);
  std::string header = std::string("TetVDB ") + version() + ", binary STL"; // never "solid"
  header.resize(80, ' ');
  file.write(header.data(), header.size());
  const auto count = static_cast<std::uint32_t>(n);
  file.write(&count, sizeof count);
  for (std::size_t t = 0; t < n; ++t) {
    const Vec3d* corners[3];
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = &mesh.points[mesh.triangles[3 * t + k]];
    const Vec3d up = normal(*corners[0], *corners[1], *corners[2]);
    std::array<float, 12> numbers;
    for (std::size_t k = 0; k < 3; ++k) {
      numbers[k] = static_cast<float>(up[k]);
      for (std::size_t i = 0; i < 3; ++i)
        numbers[3 + 3 * i + k] = toFloat((*corners[i])[k]);
    }
    std::array<char, 50> facet{}; // the last two bytes are attributes that nobody uses
    std::memcpy(facet.data(), numbers.data(), sizeof numbers);
    file.write(facet.data(), facet.size());
    if (t % kItemsPerUpdate == 0)
      progress.update(static_cast<double>(t) / static_cast<double>(n));
  }
  file.commit();
}

} // namespace tetvdb
