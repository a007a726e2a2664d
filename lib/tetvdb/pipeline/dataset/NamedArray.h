// SPDX-License-Identifier: Apache-2.0
//
// Arrays in memory, and as .npz and .npy files.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb {

namespace nano {
class DeviceArray; // nanovdb_kernels/DeviceArray.h
}

struct NamedArray {
  std::string name;
  std::string type; ///< as NumPy names it: "<f4", "|b1", ...
  std::vector<std::uint64_t> shape;
  std::vector<char> bytes; ///< C order
  /// The bytes are eight booleans each, as PackedBits has them; type and shape are those of the
  /// booleans.
  bool packed = false;
  /// In place of `bytes`, for makeItemArrays() with a GPU: in its memory, booleans a byte each.
  std::shared_ptr<nano::DeviceArray> device{};
  /// Of voxels: 4 x 4, row by row, from an element's numbers to the coordinates of points.
  std::vector<double> transform{};

  template <typename T>
  static NamedArray of(std::string name, std::string type, std::vector<std::uint64_t> shape,
                       const std::vector<T>& values) {
    const char* first = reinterpret_cast<const char*>(values.data());
    return {std::move(name), std::move(type), std::move(shape),
            std::vector<char>(first, first + values.size() * sizeof(T))};
  }
};

/// Booleans, packed.
NamedArray flagArray(std::string name, std::vector<std::uint64_t> shape,
                     const std::vector<std::uint8_t>& flags);
/// As numpy.packbits() returns it where it is packed, else as it is.
NamedArray asBytes(NamedArray array);
/// A byte a boolean where it is packed, else as it is.
NamedArray unpacked(NamedArray array);

/// Writes a deflated .npz file; no array may be packed. The bytes depend only on the arrays. The
/// file is whole or absent. Throws Error(Write).
void writeNpzArrays(const std::string& path, const std::vector<NamedArray>& arrays);
/// One array, not packed.
void writeNpyArray(const std::string& path, const NamedArray& array);

/// Numbers as IEEE 754 half-precision, rounded to nearest, ties to even.
std::vector<std::uint16_t> toHalf(const std::vector<float>& values);

} // namespace tetvdb
