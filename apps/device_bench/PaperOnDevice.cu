// SPDX-License-Identifier: Apache-2.0
#include "apps/device_bench/PaperOnDevice.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cuda_runtime.h>
#include <stdexcept>

namespace tetvdb::bench {
namespace {

void check(cudaError_t status) {
  if (status != cudaSuccess)
    throw std::runtime_error(cudaGetErrorString(status));
}

struct Vector {
  double x, y, z;
};

__device__ Vector minus(const double* a, const Vector& b) {
  return {a[0] - b.x, a[1] - b.y, a[2] - b.z};
}

__device__ double determinant(const Vector& a, const Vector& b, const Vector& c) {
  return a.x * b.y * c.z + b.x * c.y * a.z + c.x * a.y * b.z - a.x * c.y * b.z - b.x * a.y * c.z -
         c.x * b.y * a.z;
}

__global__ void paperKernel(const double* points, const std::uint32_t* tets, std::uint64_t count,
                            Vector origin, double voxel, int n, unsigned* bits) {
  const std::uint64_t t = std::uint64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (t >= count)
    return;
  const double* v[4];
  for (int k = 0; k < 4; ++k)
    v[k] = points + 3 * std::uint64_t(tets[4 * t + k]);
  int low[3], high[3];
  const double o[3] = {origin.x, origin.y, origin.z};
  for (int k = 0; k < 3; ++k) {
    double least = v[0][k], most = v[0][k];
    for (int i = 1; i < 4; ++i) {
      least = fmin(least, v[i][k]);
      most = fmax(most, v[i][k]);
    }
    low[k] = max(0, static_cast<int>(floor((least - o[k]) / voxel)));
    high[k] = min(n - 1, static_cast<int>(ceil((most - o[k]) / voxel)));
  }
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int z = low[2]; z <= high[2]; ++z) {
        const Vector p{o[0] + x * voxel, o[1] + y * voxel, o[2] + z * voxel};
        const Vector a = minus(v[0], p), b = minus(v[1], p), c = minus(v[2], p), d = minus(v[3], p);
        const double da = determinant(b, c, d), db = determinant(a, c, d),
                     dc = determinant(a, b, d), dd = determinant(a, b, c);
        if ((da > 0 && db < 0 && dc > 0 && dd < 0) || (da < 0 && db > 0 && dc < 0 && dd > 0)) {
          const std::uint64_t i = (std::uint64_t(x) * n + y) * n + z;
          atomicOr(bits + (i >> 5), 1u << (i & 31));
        }
      }
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

PaperTimes paperOnDevice(const nano::MeshView& mesh, const double (&origin)[3], double voxelSize,
                         int n) {
  PaperTimes times;
  const std::uint64_t words = (std::uint64_t(n) * n * n + 31) / 32;
  std::vector<unsigned> host(words);
  const double start = now();
  double* points = nullptr;
  std::uint32_t* tets = nullptr;
  unsigned* bits = nullptr;
  check(cudaMalloc(&points, mesh.pointCount * 24));
  check(cudaMalloc(&tets, mesh.tetCount * 16));
  check(cudaMalloc(&bits, words * 4));
  const double allocated = now();
  check(cudaMemcpy(points, mesh.points, mesh.pointCount * 24, cudaMemcpyHostToDevice));
  check(cudaMemcpy(tets, mesh.tets, mesh.tetCount * 16, cudaMemcpyHostToDevice));
  check(cudaMemset(bits, 0, words * 4));
  check(cudaDeviceSynchronize());
  const double up = now();
  paperKernel<<<static_cast<unsigned>((mesh.tetCount + 127) / 128), 128>>>(
      points, tets, mesh.tetCount, {origin[0], origin[1], origin[2]}, voxelSize, n, bits);
  check(cudaGetLastError());
  check(cudaDeviceSynchronize());
  const double done = now();
  check(cudaMemcpy(host.data(), bits, words * 4, cudaMemcpyDeviceToHost));
  const double down = now();
  check(cudaFree(points));
  check(cudaFree(tets));
  check(cudaFree(bits));
  const double end = now();
  times = {(allocated - start) + (end - down), (up - allocated) + (down - done), done - up,
           end - start, 0};
  for (unsigned w : host)
    times.voxels += static_cast<std::uint64_t>(__builtin_popcount(w));
  return times;
}

} // namespace tetvdb::bench
