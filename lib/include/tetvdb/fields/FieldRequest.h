// SPDX-License-Identifier: Apache-2.0
//
// Requests for arrays of a mesh that become grids, and the storage of their values.
//
//   tetvdb::FieldOptions options;
//   options.requests = {{"", "temperature", tetvdb::FieldPart::Whole, ""},
//                       {"vonMises", "stress", tetvdb::FieldPart::Mises, ""}};
//   options.remap = {{"vonMises", 0, 1}};
#pragma once

#include "tetvdb/mesh/FieldRule.h"

#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// One array, or one number computed from it.
struct FieldRequest {
  std::string grid; ///< name of the grid; empty: that of the array
  /// Name in the input; "points:NAME" and "cells:NAME" if both have it. With FieldPart::Whole and
  /// if there is no array of that name, also "ARRAY.PART" and "ARRAY:PART", such as "stress.xx" and
  /// "stress:mises"; the grid's name is then "ARRAY.PART" unless given.
  std::string array;
  FieldPart part = FieldPart::Whole;
  /// FieldPart::Component: "x", "y", "z", "xx", "xy", ... or a number from 0.
  std::string component;
};

/// For the grid of that name; for every scalar grid if the name is empty.
struct NamedRange {
  std::string grid;
  double low = 0, high = 1;
};
struct NamedNumber {
  std::string grid;
  double value = 0;
};

/// Parses "magnitude", "mises", "trace", "determinant", "principal1" to "principal3" or a component
/// ("x", "xy", "2") into `request`; returns false, and changes nothing, for any other text.
bool readPart(std::string_view text, FieldRequest& request);

struct FieldOptions {
  std::vector<FieldRequest> requests;
  bool all = false; ///< every array of the input, after `requests`
  /// Values below low become low, those above high become high. Vectors (by name only) are
  /// shortened to length high.
  std::vector<NamedRange> clamp;
  /// Maps the range of the array (that of `clamp` if given) to low .. high, its minimum to low.
  /// Vectors (by name only) are scaled so that the longest has the length high.
  std::vector<NamedRange> remap;
  std::vector<NamedNumber> background; ///< of inactive voxels, as stored; 0 by default
  /// The points were rotated from z up to y up, (x, y, z) to (x, z, -y): rotates vectors likewise,
  /// but not colours ("Cd", "color", "rgb").
  bool turnVectors = false;

  bool empty() const { return requests.empty() && !all; }
};

} // namespace tetvdb
