// SPDX-License-Identifier: Apache-2.0
//
// Arrays at points that cutting a cell adds between its nodes.
#pragma once

#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <type_traits>
#include <variant>

namespace tetvdb {

/// Appends the values of `added` points to an array over `count` points; one of another size stays
/// as it is (told where the array is used). nodesOf(i) points to the nodes of added point i.
/// Integers are those of its first node; others mean(i, base, difference), where `base` is the
/// value of the first node and difference(k) what node k has beyond it: a constant stays itself.
template <class NodesOf, class Mean>
void appendAddedValues(Attribute& array, std::size_t count, std::size_t added,
                       const NodesOf& nodesOf, const Mean& mean) {
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        const std::size_t width = array.components;
        if (values.size() != count * width)
          return;
        values.reserve((count + added) * width);
        for (std::size_t i = 0; i < added; ++i) {
          const auto* nodes = nodesOf(i);
          for (std::size_t c = 0; c < width; ++c) {
            const auto number = [&](std::size_t k) { return values[nodes[k] * width + c]; };
            if constexpr (std::is_integral_v<T>) {
              values.push_back(T(number(0)));
            } else {
              const auto base = static_cast<double>(number(0));
              values.push_back(static_cast<T>(mean(
                  i, base, [&](std::size_t k) { return static_cast<double>(number(k)) - base; })));
            }
          }
        }
      },
      array.values);
}

} // namespace tetvdb
