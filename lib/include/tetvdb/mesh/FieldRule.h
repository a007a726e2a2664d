// SPDX-License-Identifier: Apache-2.0
//
// From the numbers read at a place to the value that a grid stores; the same source, and the same
// bits, on the CPU and on a GPU.
#pragma once

#include "tetvdb/core/HostDevice.h"
#include "tetvdb/mesh/TensorParts.h"

#include <cmath>
#include <cstdint>

namespace tetvdb {

/// What of an array's tuple is stored.
enum class FieldPart : std::uint8_t {
  Whole,       ///< one number or a vector of three; other tuples become one grid a component
  Component,   ///< one number of the tuple
  Magnitude,   ///< Euclidean length of a tuple; Frobenius norm of a tensor
  Mises,       ///< von Mises' equivalent of a symmetric tensor: sqrt(3/2 s:s), s its deviator
  Trace,       ///< of a tensor
  Determinant, ///< of a tensor
  Principal1,  ///< largest eigenvalue of a tensor's symmetric part
  Principal2,
  Principal3 ///< smallest
};

enum class FieldKind : std::uint8_t { Float, Vector, Integer };

struct FieldRule {
  static constexpr int kMaxNumbers = 9; ///< that are read, of a tensor

  FieldKind kind = FieldKind::Float;
  FieldPart part = FieldPart::Whole;
  std::uint8_t numbers = 1; ///< that are read
  bool turned = false;      ///< a vector's (x, y, z) is stored as (x, z, -y)
  bool clamped = false;
  double low = 0, high = 0; ///< to which values are clamped; of a vector's length `high` alone
  double scale = 1, offset = 0;

  /// Numbers that a voxel gets.
  TETVDB_HD int width() const { return kind == FieldKind::Vector ? 3 : 1; }

  /// From the numbers read to the value before clamp and scale; `out` has width() places.
  TETVDB_HD void derive(const double* read, double* out) const {
    switch (part) {
    case FieldPart::Whole:
    case FieldPart::Component:
      for (int i = 0; i < width(); ++i)
        out[i] = read[i];
      if (turned) {
        out[1] = read[2];
        out[2] = -read[1];
      }
      return;
    case FieldPart::Magnitude: {
      double sum = 0;
      for (int i = 0; i < numbers; ++i)
        sum += read[i] * read[i];
      out[0] = std::sqrt(sum);
      return;
    }
    default:
      out[0] = invariant(read);
    }
  }

  /// Clamp and scale, in place.
  TETVDB_HD void store(double* value) const {
    if (kind != FieldKind::Vector) {
      double x = value[0];
      if (clamped) // what is not a number stays that
        x = x < low ? low : x > high ? high : x;
      value[0] = scale == 1 && offset == 0 ? x : x * scale + offset;
      return;
    }
    double factor = scale;
    if (clamped) {
      const double length =
          std::sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2]);
      if (length > high)
        factor *= high / length;
    }
    for (int i = 0; i < 3; ++i)
      value[i] *= factor;
  }

  /// Both; returns the value, of width() numbers: `read` itself or `made`.
  TETVDB_HD const double* finish(const double* read, double (&made)[3]) const {
    const bool plain = (part == FieldPart::Whole || part == FieldPart::Component) && !turned;
    const bool asIs = !clamped && scale == 1 && offset == 0;
    if (plain && asIs)
      return read;
    derive(read, made);
    if (!asIs)
      store(made);
    return made;
  }

private:
  TETVDB_HD double invariant(const double* read) const {
    Tensor t;
    for (std::size_t i = 0; i < 9; ++i)
      t[i] = read[i];
    switch (part) {
    case FieldPart::Mises:
      return misesOf(t);
    case FieldPart::Trace:
      return traceOf(t);
    case FieldPart::Determinant:
      return determinantOf(t);
    default:
      return principalsOf(
          t)[static_cast<std::size_t>(part) - static_cast<std::size_t>(FieldPart::Principal1)];
    }
  }
};

} // namespace tetvdb
