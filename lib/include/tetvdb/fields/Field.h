// SPDX-License-Identifier: Apache-2.0
//
// Requests resolved in a mesh: the numbers read at its points or cells, and the grids made from
// them.
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/fields/FieldRequest.h"
#include "tetvdb/mesh/TetMesh.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace tetvdb {

/// Min and max of the finite numbers; low > high if there are none.
struct ValueRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(low <= high); }
  void add(double value) {
    low = value < low ? value : low;
    high = value > high ? value : high;
  }
  void add(const ValueRange& other) {
    low = other.low < low ? other.low : low;
    high = other.high > high ? other.high : high;
  }
};

/// A grid to be made. Refers to arrays of the mesh in which it was resolved.
struct Field {
  /// One number of a tuple: component `component` of `array`.
  struct Source {
    const Attribute* array = nullptr;
    std::uint32_t component = 0;
  };

  std::string name;  ///< of the grid, unique
  std::string array; ///< in the input
  Attribute::On on = Attribute::On::Points;
  FieldKind kind = FieldKind::Float;
  FieldPart part = FieldPart::Whole;
  /// The numbers read: 1, 2 or more for a tuple whose length is requested, 3 for a vector, 9 for a
  /// tensor, by rows.
  std::vector<Source> sources;

  bool turned = false; ///< a vector's (x, y, z) is stored as (x, z, -y)
  ValueRange clamp;    ///< empty: none
  double scale = 1, offset = 0;
  double background = 0;
  ValueRange original;       ///< of the input (lengths of vectors), before clamp and scale
  std::size_t notFinite = 0; ///< number of points or cells with a value that is not finite

  /// Numbers per voxel.
  int width() const { return kind == FieldKind::Vector ? 3 : 1; }
  /// The rule that computes its values from the numbers read.
  FieldRule rule() const;
};

/// Resolves `options` in `mesh`, in the order of the requests. Arrays "u_x", "u_y", "u_z" (or with
/// the suffix ".x", "x", "X", "1", ...) are used as the vector "u" if there is no array of that
/// name, and likewise the components of a tensor, as Exodus stores them. `ranges`, unless null,
/// contains for each field, in the order of the result, the range that replaces that of the
/// arrays: the range of all frames of a sequence.
///
/// `report` receives a warning for a name that both points and cells have, for arrays that `all`
/// omits (more than nine components, integers beyond 32 bits) and for values that are not finite.
/// Throws Error(Usage) for an array that the mesh does not have (the message lists the existing
/// ones), for a part that its tuples do not have, for repeated names of grids and for ranges that
/// name no grid; Error(Invalid) for an array of a wrong length, or with integers beyond 32 bits.
///
/// Parallel, linear in the arrays' sizes.
std::vector<Field> resolveFields(const TetMesh& mesh, const FieldOptions& options, Report& report,
                                 const std::vector<ValueRange>* ranges = nullptr);

/// The arrays of a mesh for messages, including those not read: "'T' (points), 'stress' (cells, 6
/// components)".
std::string describeArrays(const TetMesh& mesh);
/// The names of the arrays of a mesh, including those not read.
std::vector<std::string> arrayNames(const TetMesh& mesh);

} // namespace tetvdb
