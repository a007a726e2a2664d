// SPDX-License-Identifier: Apache-2.0
//
// The content of a .npy file. Internal.
#pragma once

#include "tetvdb/io/volume/arrays/StoredArray.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// An array of any number of axes.
struct NpyArray {
  ElementType element = ElementType::Float32;
  bool swap = false, isBits = false;
  std::string unknownType;          ///< not empty: the bytes are no numbers that are read
  std::vector<std::uint64_t> shape; ///< [0] is the slowest in C order, the fastest otherwise
  bool isFortran = false;
  std::string_view bytes;

  std::string describe() const; ///< "4 x 4 of float32"
  /// Number `i` of the bytes; `i` is within them.
  double number(std::size_t i) const;
};

/// Throws Error(Invalid) for bytes that are no .npy file; `where` is for messages.
NpyArray parseNpy(std::string_view bytes, const std::string& where);

/// Sets element type, sizes and steps for an array of voxels [x][y][z], with components on the last
/// axis (up to 4) or the first (up to 16); leading axes of length 1 are ignored. False for
/// other shapes and types.
bool setVoxels(const NpyArray& from, StoredArray& array);

} // namespace tetvdb
