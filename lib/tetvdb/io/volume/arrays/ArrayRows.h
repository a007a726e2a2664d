// SPDX-License-Identifier: Apache-2.0
//
// Rows of the numbers of an array, as values of a grid. Internal.
#pragma once

#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/volume/arrays/StoredArray.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <openvdb/Types.h>
#include <type_traits>

namespace tetvdb {

/// Numbers `step` elements apart become Outs `outStep` apart.
template <typename Out>
struct RowLoad {
  const char* from;
  std::ptrdiff_t step;
  std::size_t count;
  bool swap;
  double slope, intercept;
  Out* out;
  std::ptrdiff_t outStep;
};

template <typename Element, typename Out>
void loadRow(const RowLoad<Out>& row) {
  if constexpr (std::is_same_v<Element, Out>)
    if (row.step == 1 && row.outStep == 1 && !row.swap && row.slope == 1 && row.intercept == 0) {
      std::memcpy(row.out, row.from, row.count * sizeof(Out));
      return;
    }
  const auto element = [&](std::size_t i) {
    const char* at = row.from + static_cast<std::ptrdiff_t>(i) * row.step *
                                    static_cast<std::ptrdiff_t>(sizeof(Element));
    if constexpr (std::is_same_v<Element, openvdb::math::half>) {
      openvdb::math::half number;
      number.setBits(loadNumber<std::uint16_t>(at, row.swap));
      return static_cast<float>(number);
    } else {
      return loadNumber<Element>(at, row.swap);
    }
  };
  if (row.slope != 1 || row.intercept != 0) {
    for (std::size_t i = 0; i < row.count; ++i)
      row.out[static_cast<std::ptrdiff_t>(i) * row.outStep] =
          static_cast<Out>(row.slope * static_cast<double>(element(i)) + row.intercept);
    return;
  }
  for (std::size_t i = 0; i < row.count; ++i)
    row.out[static_cast<std::ptrdiff_t>(i) * row.outStep] = static_cast<Out>(element(i));
}

template <typename Out>
using RowLoader = void (*)(const RowLoad<Out>&);

/// Floats have no loader as integers.
template <typename Out>
RowLoader<Out> rowLoader(ElementType element) {
  switch (element) {
  case ElementType::Int8:
    return loadRow<std::int8_t, Out>;
  case ElementType::UInt8:
    return loadRow<std::uint8_t, Out>;
  case ElementType::Int16:
    return loadRow<std::int16_t, Out>;
  case ElementType::UInt16:
    return loadRow<std::uint16_t, Out>;
  case ElementType::Int32:
    return loadRow<std::int32_t, Out>;
  case ElementType::UInt32:
    return loadRow<std::uint32_t, Out>;
  case ElementType::Int64:
    return loadRow<std::int64_t, Out>;
  case ElementType::UInt64:
    return loadRow<std::uint64_t, Out>;
  default:
    break;
  }
  if constexpr (std::is_floating_point_v<Out>)
    return element == ElementType::Float16   ? loadRow<openvdb::math::half, Out>
           : element == ElementType::Float32 ? loadRow<float, Out>
                                             : loadRow<double, Out>;
  return nullptr;
}

/// Rows along the axis of the smallest step, of those with more than one voxel.
template <typename Out>
class ArrayRows {
public:
  explicit ArrayRows(const StoredArray& array)
      : array_(array), load_(rowLoader<Out>(array.element)) {
    for (std::size_t k = 1; k < 3; ++k)
      if (array.size[k] > 1 && (array.size[along_] == 1 || array.step[k] < array.step[along_]))
        along_ = k;
    b_ = (along_ + 1) % 3;
    a_ = (along_ + 2) % 3;
  }

  std::size_t along() const { return along_; }
  std::size_t a() const { return a_; } ///< the other axes
  std::size_t b() const { return b_; }

  /// `count` numbers of component `k` from voxel `at` on, which is relative to the array's first.
  void read(const std::array<std::uint64_t, 3>& at, std::uint64_t k, std::size_t count, Out* out,
            std::ptrdiff_t outStep = 1) const {
    const std::uint64_t first = at[0] * array_.step[0] + at[1] * array_.step[1] +
                                at[2] * array_.step[2] + k * array_.componentStep;
    load_({array_.bytes.data() + first * bytesOf(array_.element),
           static_cast<std::ptrdiff_t>(array_.step[along_]), count, array_.swap, array_.slope,
           array_.intercept, out, outStep});
  }

private:
  const StoredArray& array_;
  RowLoader<Out> load_;
  std::size_t along_ = 0, a_ = 0, b_ = 0;
};

} // namespace tetvdb
