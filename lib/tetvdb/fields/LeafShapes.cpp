// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/LeafShapes.h"

#include "tetvdb/geometry/VectorMath.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

// Relative to the cell's size: the rounding error of the nodes.
constexpr double kAffineError = 1e-12;
constexpr double kNewtonError = 1e-13;
constexpr double kAcceptedError = 1e-9;
constexpr int kMaxSteps = 12;
// Distance beyond the reference cell: chords lie outside of arcs by at most this in regular cells.
constexpr double kMaxOutside = 0.3;

bool isWithin(CurvedShape shape, const Vec3d& at, double margin) {
  const double low = -margin, high = 1 + margin;
  switch (shape) {
  case CurvedShape::Tet10:
    return at[0] > low && at[1] > low && at[2] > low && at[0] + at[1] + at[2] < high;
  case CurvedShape::Hex20:
  case CurvedShape::Hex27:
  case CurvedShape::Hex8:
    return std::abs(at[0]) < high && std::abs(at[1]) < high && std::abs(at[2]) < high;
  case CurvedShape::Wedge15:
  case CurvedShape::Wedge18:
  case CurvedShape::Wedge6:
    return at[0] > low && at[1] > low && at[0] + at[1] < high && std::abs(at[2]) < high;
  case CurvedShape::Pyramid13:
  case CurvedShape::Pyramid14:
  case CurvedShape::Pyramid5:
    return at[2] > low && at[2] < high && std::abs(at[0]) + std::abs(at[1]) + at[2] < high;
  }
  return false;
}

// Indices of an origin and three neighbours that span the reference cell.
std::array<std::size_t, 4> spanOf(CurvedShape shape) {
  switch (shape) {
  case CurvedShape::Hex20:
  case CurvedShape::Hex27:
  case CurvedShape::Hex8:
    return {0, 1, 3, 4};
  case CurvedShape::Pyramid13:
  case CurvedShape::Pyramid14:
  case CurvedShape::Pyramid5:
    return {0, 1, 2, 4};
  default:
    return {0, 1, 2, 3};
  }
}

double largest(const Vec3d& a) {
  return std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
}

} // namespace

// Whether every node is at its position by the affine map of four of them.
bool LeafShapes::isAffine(const CurvedCells::Cell& cell) const {
  const std::uint32_t* nodes = mesh_->curved.nodes.data() + cell.first;
  const auto span = spanOf(cell.shape);
  const Vec3d origin = mesh_->points[nodes[span[0]]], place = placeOf(cell.shape, span[0]);
  Vec3d edges[3], axes[3];
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    edges[k] = minus(mesh_->points[nodes[span[k + 1]]], origin);
    axes[k] = minus(placeOf(cell.shape, span[k + 1]), place);
    size = std::max(size, largest(edges[k]));
  }
  const double determinant = dot(axes[0], cross(axes[1], axes[2]));
  for (std::size_t i = 0; i < nodeCount(cell.shape); ++i) {
    const Vec3d d = minus(placeOf(cell.shape, i), place);
    const double along[3] = {dot(d, cross(axes[1], axes[2])) / determinant,
                             dot(d, cross(axes[2], axes[0])) / determinant,
                             dot(d, cross(axes[0], axes[1])) / determinant};
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected =
          origin[k] + (along[0] * edges[0][k] + along[1] * edges[1][k] + along[2] * edges[2][k]);
      // The rounding error of positions is relative to their own size, not the cell's.
      const double error = kAffineError * (size + std::abs(origin[k]));
      if (!(std::abs(mesh_->points[nodes[i]][k] - expected) <= error))
        return false;
    }
  }
  return true;
}

LeafShapes::Slot LeafShapes::slotOf(const LeafSample& sample, std::size_t slot) const {
  Slot result;
  const std::size_t tet = sample.tet(slot);
  const std::uint32_t number = mesh_->curved.cellOfTet[tet];
  if (number == CurvedCells::kLinear)
    return result;
  const CurvedCells::Cell& cell = mesh_->curved.cells[number];
  result.curved = true;
  result.affine = isAffine(cell);
  if (!result.affine)
    result.size = sizeOf(cell);
  for (std::size_t i = 0; i < 4; ++i)
    result.places[i] = placeOf(cell.shape, mesh_->curved.corners[tet][sample.place(slot, i)]);
  return result;
}

Vec3d LeafShapes::centre(const LeafSample& sample, std::size_t voxel) const {
  const std::uint32_t offset = sample.offset(voxel);
  const std::uint32_t local[3] = {offset >> 6, offset >> 3 & 7, offset & 7};
  Vec3d p{};
  for (std::size_t k = 0; k < 3; ++k)
    p[k] = transform_.origin[k] +
           transform_.voxelSize[k] *
               static_cast<double>(sample.origin()[k] + static_cast<std::int32_t>(local[k]));
  return p;
}

double LeafShapes::sizeOf(const CurvedCells::Cell& cell) const {
  const std::uint32_t* nodes = mesh_->curved.nodes.data() + cell.first;
  const Vec3d& base = mesh_->points[nodes[0]];
  double size = 0;
  for (std::size_t i = 1; i < nodeCount(cell.shape); ++i)
    size = std::max(size, largest(minus(mesh_->points[nodes[i]], base)));
  return size;
}

bool LeafShapes::solve(const CurvedCells::Cell& cell, double size, const Vec3d& target, Vec3d& at,
                       double* weights) const {
  const std::uint32_t* nodes = mesh_->curved.nodes.data() + cell.first;
  const std::size_t n = nodeCount(cell.shape);
  std::array<std::array<double, 3>, kMaxCurvedNodes> gradients;
  const Vec3d& base = mesh_->points[nodes[0]];
  const Vec3d wanted = minus(target, base);
  for (int step = 0; step < kMaxSteps; ++step) {
    shapeFunctions(cell.shape, at, weights, gradients.data());
    Vec3d rest = wanted, by[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (std::size_t i = 1; i < n; ++i) {
      const Vec3d d = minus(mesh_->points[nodes[i]], base);
      for (std::size_t k = 0; k < 3; ++k) {
        rest[k] -= weights[i] * d[k];
        for (std::size_t axis = 0; axis < 3; ++axis)
          by[axis][k] += gradients[i][axis] * d[k];
      }
    }
    const double error = largest(rest);
    if (error <= kNewtonError * size || (step == kMaxSteps - 1 && error <= kAcceptedError * size))
      return true;
    const double determinant = dot(by[0], cross(by[1], by[2]));
    at[0] += dot(rest, cross(by[1], by[2])) / determinant;
    at[1] += dot(rest, cross(by[2], by[0])) / determinant;
    at[2] += dot(rest, cross(by[0], by[1])) / determinant;
    if (!isWithin(cell.shape, at, kMaxOutside)) // true for NaN, too
      break;
  }
  return false;
}

void LeafShapes::find(const LeafSample& sample) {
  slots_.resize(sample.slots());
  for (std::size_t s = 0; s < sample.slots(); ++s)
    slots_[s] = slotOf(sample, s);
  counts_.resize(sample.count());
  beyond_.assign(sample.count(), 0);
  points_.resize(sample.count() * kMaxCurvedNodes);
  weights_.resize(sample.count() * kMaxCurvedNodes);
  for (std::size_t v = 0; v < sample.count(); ++v) {
    std::uint32_t* points = points_.data() + v * kMaxCurvedNodes;
    double* weights = weights_.data() + v * kMaxCurvedNodes;
    const std::size_t slot = sample.slot(v);
    const auto& w = sample.weights(v);
    const double corners[4] = {1 - (w[0] + w[1] + w[2]), w[0], w[1], w[2]};
    const auto takeTet = [&] {
      counts_[v] = 4;
      for (std::size_t i = 0; i < 4; ++i) {
        points[i] = sample.point(slot, i);
        weights[i] = corners[i];
      }
    };
    if (!slots_[slot].curved) {
      takeTet();
      continue;
    }
    const CurvedCells::Cell& cell = mesh_->curved.cells[mesh_->curved.cellOfTet[sample.tet(slot)]];
    Vec3d at{0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        at[k] += corners[i] * slots_[slot].places[i][k];
    counts_[v] = nodeCount(cell.shape);
    std::copy_n(mesh_->curved.nodes.data() + cell.first, counts_[v], points);
    if (slots_[slot].affine) {
      shapeFunctions(cell.shape, at, weights);
      continue;
    }
    Vec3d found = at;
    if (solve(cell, slots_[slot].size, centre(sample, v), found, weights)) {
      beyond_[v] = isLinear(cell.shape) && !isWithin(cell.shape, found, 0) ? 1 : 0;
    } else if (isLinear(cell.shape)) {
      takeTet();
      ++missed_;
    } else {
      shapeFunctions(cell.shape, at, weights);
    }
  }
}

} // namespace tetvdb
