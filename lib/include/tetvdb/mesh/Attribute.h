// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace tetvdb {

/// A named array over the points or the cells of a mesh, kept in the file's own number type as far
/// as that is one of four: 8- and 16-bit integers widen to int32, unsigned 32-bit ones to int64.
struct Attribute {
  enum class On : std::uint8_t { Points, Cells };
  using Values = std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>,
                              std::vector<std::int64_t>>;

  std::string name; ///< as in the file
  On on = On::Points;
  std::uint32_t components = 1;
  Values values; ///< element e, component c at [e * components + c]

  /// Number of elements (points or cells).
  std::size_t size() const {
    return std::visit([](const auto& v) { return v.size(); }, values) / components;
  }
  /// Component `c` of element `e` as a double.
  double number(std::size_t e, std::uint32_t c = 0) const {
    return std::visit([&](const auto& v) { return static_cast<double>(v[e * components + c]); },
                      values);
  }
  bool isInteger() const { return values.index() >= 2; }
};

/// An array that a file has and nobody asked for.
struct UnreadArray {
  std::string name;
  Attribute::On on = Attribute::On::Points;
  std::uint32_t components = 1;
};

} // namespace tetvdb
