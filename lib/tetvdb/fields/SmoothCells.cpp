// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/SmoothCells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// The tets of a cell follow one another.
template <typename T>
std::vector<T> meansAtPoints(const TetMesh& mesh, const std::vector<T>& ofCells,
                             std::size_t width) {
  std::vector<double> sums(mesh.points.size() * width, 0);
  std::vector<std::uint32_t> counts(mesh.points.size(), 0), last(mesh.points.size(), kNone);
  for (std::size_t t = 0; t < mesh.tetCount(); ++t) {
    const std::uint32_t cell = mesh.cell(t);
    const T* const value = ofCells.data() + cell * width;
    const bool finite =
        std::all_of(value, value + width, [](T number) { return std::isfinite(number); });
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t point = mesh.tets[4 * t + k];
      if (last[point] == cell)
        continue;
      last[point] = cell;
      if (!finite)
        continue;
      ++counts[point];
      for (std::size_t i = 0; i < width; ++i)
        sums[point * width + i] += static_cast<double>(value[i]);
    }
  }
  std::vector<T> means(sums.size());
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    for (std::size_t i = 0; i < width; ++i)
      means[p * width + i] = last[p] == kNone ? T(0)
                             : counts[p] == 0 ? std::numeric_limits<T>::quiet_NaN()
                                              : static_cast<T>(sums[p * width + i] / counts[p]);
  return means;
}

} // namespace

void smoothCells(TetMesh& mesh) {
  const auto isAtPoints = [&](const Attribute& array) {
    return std::any_of(mesh.attributes.begin(), mesh.attributes.end(), [&](const Attribute& other) {
      return other.on == Attribute::On::Points && other.name == array.name;
    });
  };
  std::vector<Attribute*> chosen;
  for (Attribute& array : mesh.attributes)
    if (array.on == Attribute::On::Cells && !array.isInteger() && !isAtPoints(array) &&
        array.size() == mesh.cellCount) // others are told where they are used
      chosen.push_back(&array);
  tbb::parallel_for(std::size_t(0), chosen.size(), [&](std::size_t i) {
    Attribute& array = *chosen[i];
    std::visit(
        [&](auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_floating_point_v<T>)
            values = meansAtPoints(mesh, values, array.components);
        },
        array.values);
  });
  for (Attribute* array : chosen)
    array->on = Attribute::On::Points;
}

} // namespace tetvdb
