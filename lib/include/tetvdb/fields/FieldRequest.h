// SPDX-License-Identifier: Apache-2.0
//
// Which arrays of a mesh become grids, and how their values are stored.
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

/// One array, or one number made of it.
struct FieldRequest {
  std::string grid; ///< name of the grid; empty: the array's
  /// Name in the input; "points:NAME" and "cells:NAME" where both have it. With FieldPart::Whole
  /// and where there is no array of that name also "ARRAY.PART" and "ARRAY:PART", such as
  /// "stress.xx" and "stress:mises", of which the grid's name, unless given, is "ARRAY.PART".
  std::string array;
  FieldPart part = FieldPart::Whole;
  /// FieldPart::Component: "x", "y", "z", "xx", "xy", ... or a number from 0.
  std::string component;
};

/// For the grid of that name; for every grid of single numbers where the name is empty.
struct NamedRange {
  std::string grid;
  double low = 0, high = 1;
};
struct NamedNumber {
  std::string grid;
  double value = 0;
};

/// Reads "magnitude", "mises", "trace", "determinant", "principal1" to "principal3" or a component
/// ("x", "xy", "2") into `request`; false, and nothing changed, for any other text.
bool readPart(std::string_view text, FieldRequest& request);

struct FieldOptions {
  std::vector<FieldRequest> requests;
  bool all = false; ///< every array of the input, after `requests`
  /// Values below low become low, those above high become high. Vectors (by name only) are
  /// shortened to a length of high.
  std::vector<NamedRange> clamp;
  /// The range of the array (that of `clamp` where given) is mapped to low .. high, low to low.
  /// Vectors (by name only) are scaled so that the longest has the length high.
  std::vector<NamedRange> remap;
  std::vector<NamedNumber> background; ///< of inactive voxels, as stored; 0 where nothing is given
  /// The points were turned from z up to y up, (x, y, z) to (x, z, -y): turn vectors likewise, but
  /// not colours ("Cd", "color", "rgb").
  bool turnVectors = false;

  bool empty() const { return requests.empty() && !all; }
};

} // namespace tetvdb
