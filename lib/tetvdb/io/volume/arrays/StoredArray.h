// SPDX-License-Identifier: Apache-2.0
//
// An array of voxels as a file stores it, and what receives the arrays of a file. Internal, without
// OpenVDB.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/volume/arrays/ArrayLayout.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace tetvdb {

/// World from index, row by row; the last row is 0 0 0 1.
using ArrayTransform = std::array<double, 16>;
constexpr ArrayTransform kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// The longest axes that are taken for components where a file does not say so: that of the fastest
/// index, and that of the slowest.
constexpr std::uint64_t kMostFastComponents = 4, kMostSlowComponents = 16;

/// The arrays' axes are x, y and z of index space.
struct StoredArray {
  std::string name; ///< empty: the file has none
  std::string_view bytes;
  ElementType element = ElementType::Float32;
  bool swap = false;   ///< in the byte order opposite to this machine's
  bool isBits = false; ///< bytes are 0 or 1, a mask
  std::array<std::uint64_t, 3> size{};
  std::array<std::uint64_t, 3> step{}; ///< elements from a voxel to the next along an axis
  std::uint64_t components = 1;
  std::uint64_t componentStep = 1; ///< elements from a component to the next
  bool separate = false;           ///< components are grids of their own, not those of vectors
  double slope = 1, intercept = 0; ///< the value is slope * element + intercept
  Vec3i low{0, 0, 0};              ///< the first voxel, index space
  ArrayTransform transform = kIdentity;
  bool placed = false; ///< the file gives the transform
  /// Not empty: the array is a list of size[0] voxels, whose coordinates x, y, z these are (int32).
  std::string_view coordinates;
  double background = 0; ///< of such a list

  /// The steps of an array whose axes are in memory as `order` says, the slowest first.
  void setSteps(const AxisOrder& order) {
    std::uint64_t next = componentStep == 1 ? components : 1;
    for (std::size_t i = 3; i-- > 0; next *= size[order[i]])
      step[order[i]] = next;
  }
};

/// Receives the content of a file of arrays. `bytes` of an array are valid during the call.
struct ArraySink {
  std::function<void(const StoredArray&)> array;
  /// An array that is not read: its name, and what it is.
  std::function<void(const std::string&, const std::string&)> leftOut;
  std::function<void(const std::string&, const std::string&)> metadata;
};

/// a * b * ... as a number of bytes, of which `available` are there. Throws Error(Invalid) if those
/// are fewer. The product may be beyond 2^64.
template <typename Numbers>
std::uint64_t requireBytes(const std::string& where, std::uint64_t available, std::uint64_t each,
                           const Numbers& sizes) {
  std::uint64_t needed = each;
  for (const std::uint64_t size : sizes) {
    if (size != 0 && needed > available / size)
      throw Error(Status::Invalid, where, "more voxels are declared than the file holds", kCut);
    needed *= size;
  }
  return needed;
}

} // namespace tetvdb
