// SPDX-License-Identifier: Apache-2.0
//
// Arrays of any number type and layout into the vectors of meshes.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <cstdint>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb::python {

namespace nb = nanobind;

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

/// The array that an object is: NumPy's, or through the buffer protocol or __dlpack__. Throws
/// Error(Usage) that names `what` for one that is none, is on a device, or has another number of
/// dimensions or another last extent (0: any).
AnyArray arrayOf(nb::handle object, const std::string& what, std::size_t dimensions,
                 std::size_t last = 0);

/// Of an array (N, 3) of floats or integers. Parallel. Without the GIL.
std::vector<Vec3d> pointsOf(const AnyArray& array);

/// Of integers, row by row. Throws Error(Invalid), with the place, for one below 0 or from
/// 2^32 - 1 on; `what` is the array's name. Without the GIL.
std::vector<std::uint32_t> indicesOf(const AnyArray& array, const std::string& what);
std::vector<std::uint64_t> offsetsOf(const AnyArray& array, const std::string& what);
std::vector<std::uint8_t> bytesOf(const AnyArray& array, const std::string& what);

/// An array (N) or (N, ...) of numbers, its rows the elements. Narrow integers widen as
/// tetvdb::Attribute says. Without the GIL.
Attribute attributeOf(const std::string& name, Attribute::On on, const AnyArray& array);

/// A NumPy array that owns the numbers, in C order.
template <typename Number>
nb::object arrayObject(std::vector<Number> numbers, const std::vector<std::size_t>& shape,
                       nb::dlpack::dtype type) {
  auto* kept = new std::vector<Number>(std::move(numbers));
  const nb::capsule owner(kept,
                          [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
  return nb::cast(
      nb::ndarray<nb::numpy>(kept->data(), shape.size(), shape.data(), owner, nullptr, type));
}

} // namespace tetvdb::python
