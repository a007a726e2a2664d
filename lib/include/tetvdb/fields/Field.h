// SPDX-License-Identifier: Apache-2.0
//
// Requests looked up in a mesh: what is read at each of its points or cells, and what is made of
// it.
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

/// Min and max of the numbers that are finite; low > high where there are none.
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

/// A grid to be made. Refers to arrays of the mesh it was resolved in.
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
  /// What is read: 1 number, 2 or more of a tuple whose length is asked for, 3 of a vector, 9 of
  /// a tensor, rows first.
  std::vector<Source> sources;

  bool turned = false; ///< a vector's (x, y, z) is stored as (x, z, -y)
  ValueRange clamp;    ///< empty: none
  double scale = 1, offset = 0;
  double background = 0;
  ValueRange original; ///< of the input's values, of lengths for vectors; before clamp and scale
  std::size_t notFinite = 0; ///< points or cells whose value is not a finite number

  /// Numbers that a voxel gets.
  int width() const { return kind == FieldKind::Vector ? 3 : 1; }
  /// How its values are made of the numbers read.
  FieldRule rule() const;
};

/// Looks up `options` in `mesh`, in the order of the requests. Arrays "u_x", "u_y", "u_z" (or with
/// ".x", "x", "X", "1", ... at the end) serve as the vector "u" where there is no array of that
/// name, and likewise the components of a tensor: Exodus stores them so. `ranges`, unless null,
/// holds for each field, in the order of the result, the range to use in place of the arrays' own:
/// that of all frames of a sequence.
///
/// `report` receives a warning for a name that both points and cells have, for arrays that `all`
/// leaves out (more than nine components, integers beyond 32 bits) and for values that are not
/// finite.
/// Throws Error(Usage) for an array that the mesh does not have (it lists those it has), for a part
/// that its tuples do not have, for names of grids that come twice and for ranges that name no
/// grid; Error(Invalid) for an array whose length is not the mesh's, or that has integers beyond 32
/// bits. Parallel, linear in the arrays' sizes.
std::vector<Field> resolveFields(const TetMesh& mesh, const FieldOptions& options, Report& report,
                                 const std::vector<ValueRange>* ranges = nullptr);

/// The arrays of a mesh for messages, those that were not read too: "'T' (points), 'stress' (cells,
/// 6 components)".
std::string describeArrays(const TetMesh& mesh);
/// The names of the arrays of a mesh, those that were not read too.
std::vector<std::string> arrayNames(const TetMesh& mesh);

} // namespace tetvdb
