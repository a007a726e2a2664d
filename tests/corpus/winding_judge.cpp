// SPDX-License-Identifier: Apache-2.0
//
// Generalised winding numbers by brute force, to judge voxels that came about by other means.
// Shares no code with the library.
//
//   winding_judge winding|distance IN OUT [THREADS]
//
// IN: int64 numbers of vertices, triangles and points, then the vertices (three doubles each), the
// triangles (three int32 each) and the points (three doubles each), all as the machine keeps them.
// OUT: a double a point: the winding number, or the distance to the nearest triangle.
#include "SolidAngles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace {

using solid_angles::kLanes;
using solid_angles::Lanes;
using solid_angles::Point;

struct Input {
  std::vector<std::array<Point, 3>> triangles;
  std::vector<Point> points;
};

// Of `in`, `count` records.
template <typename T>
std::vector<T> take(std::FILE* in, std::int64_t count) {
  std::vector<T> records(static_cast<std::size_t>(count));
  if (std::fread(records.data(), sizeof(T), records.size(), in) != records.size()) {
    std::fprintf(stderr, "winding_judge: the input ends early\n");
    std::exit(2);
  }
  return records;
}

Input read(const char* path) {
  std::FILE* in = std::fopen(path, "rb");
  if (in == nullptr) {
    std::perror(path);
    std::exit(2);
  }
  Input input;
  const auto sizes = take<std::int64_t>(in, 3);
  auto vertices = take<Point>(in, sizes[0]);
  const auto corners = take<std::array<std::int32_t, 3>>(in, sizes[1]);
  input.points = take<Point>(in, sizes[2]);
  std::fclose(in);
  input.triangles.reserve(corners.size());
  for (const auto& c : corners) {
    auto& triangle = input.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = vertices.at(static_cast<std::size_t>(c[k]));
  }
  return input;
}

// Brings vertices and points together to the size of 1, so that no product of lengths leaves the
// range of doubles: by a power of two, which is exact.
void scale(Input& input) {
  double largest = 0;
  for (const auto& triangle : input.triangles)
    for (const Point& p : triangle)
      for (const double x : p)
        largest = std::max(largest, std::abs(x));
  for (const Point& p : input.points)
    for (const double x : p)
      largest = std::max(largest, std::abs(x));
  if (largest == 0)
    return;
  const int shift = -std::ilogb(largest);
  for (auto& triangle : input.triangles)
    for (Point& p : triangle)
      for (double& x : p)
        x = std::ldexp(x, shift);
  for (Point& p : input.points)
    for (double& x : p)
      x = std::ldexp(x, shift);
}

double dot(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Point minus(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double squaredToSegment(const Point& p, const Point& a, const Point& b) {
  const Point ab = minus(b, a), ap = minus(p, a);
  const double length = dot(ab, ab);
  const double s = length > 0 ? std::clamp(dot(ap, ab) / length, 0.0, 1.0) : 0.0;
  const Point to = {ap[0] - s * ab[0], ap[1] - s * ab[1], ap[2] - s * ab[2]};
  return dot(to, to);
}

double squaredToTriangle(const Point& p, const std::array<Point, 3>& t) {
  double min = std::min({squaredToSegment(p, t[0], t[1]), squaredToSegment(p, t[1], t[2]),
                         squaredToSegment(p, t[2], t[0])});
  const Point u = minus(t[1], t[0]), v = minus(t[2], t[0]), w = minus(p, t[0]);
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
  const double area = uu * vv - uv * uv;
  const double r = wu * vv - wv * uv, s = wv * uu - wu * uv;
  if (area > 0 && r > 0 && s > 0 && r + s < area) { // above the triangle's inside
    const Point normal = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                          u[0] * v[1] - u[1] * v[0]};
    const double height = dot(w, normal);
    min = std::min(min, height * height / dot(normal, normal));
  }
  return min;
}

double distance(const Input& input, const Point& p) {
  double min = std::numeric_limits<double>::infinity();
  for (const auto& triangle : input.triangles)
    min = std::min(min, squaredToTriangle(p, triangle));
  return std::sqrt(min);
}

// Results of the points from `first` on, kLanes at most.
void answer(const Input& input, bool winding, std::size_t first, std::vector<double>& results) {
  const std::size_t count = std::min(kLanes, input.points.size() - first);
  if (!winding) {
    for (std::size_t i = first; i < first + count; ++i)
      results[i] = distance(input, input.points[i]);
    return;
  }
  Lanes x, y, z, w;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Point& p = input.points[first + std::min(i, count - 1)];
    x[i] = p[0];
    y[i] = p[1];
    z[i] = p[2];
  }
  solid_angles::windings(input.triangles, x, y, z, w);
  std::copy_n(w.begin(), count, results.begin() + static_cast<std::ptrdiff_t>(first));
}

bool write(const char* path, const std::vector<double>& results) {
  std::FILE* out = std::fopen(path, "wb");
  if (out == nullptr)
    return false;
  const bool whole =
      std::fwrite(results.data(), sizeof(double), results.size(), out) == results.size();
  return std::fclose(out) == 0 && whole;
}

} // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (argc < 4 || argc > 5 || (mode != "winding" && mode != "distance")) {
    std::fprintf(stderr, "usage: winding_judge winding|distance IN OUT [THREADS]\n");
    return 2;
  }
  Input input = read(argv[2]);
  const bool winding = mode == "winding";
  if (winding)
    scale(input);
  std::vector<double> results(input.points.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t at = next.fetch_add(kLanes); at < results.size(); at = next.fetch_add(kLanes))
      answer(input, winding, at, results);
  };
  const int threads = argc == 5
                          ? std::atoi(argv[4])
                          : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i)
    others.emplace_back(work);
  work();
  for (std::thread& other : others)
    other.join();
  if (!write(argv[3], results)) {
    std::perror(argv[3]);
    return 2;
  }
  return 0;
}
