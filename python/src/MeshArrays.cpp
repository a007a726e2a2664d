// SPDX-License-Identifier: Apache-2.0
#include "MeshArrays.h"

#include "tetvdb/core/Error.h"

#include <atomic>
#include <limits>
#include <nanobind/stl/string.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>

namespace tetvdb::python {
namespace {

constexpr std::size_t kItemsPerTask = 1 << 15;

std::string shapeText(const AnyArray& array) {
  std::string text = "(";
  for (std::size_t i = 0; i < array.ndim(); ++i)
    text += (i > 0 ? ", " : "") + std::to_string(array.shape(i));
  return text + ")";
}

// Calls f(pointer to the array's first item, of its own type); throws for other types.
template <typename F>
void withItems(const AnyArray& array, const F& f) {
  const nb::dlpack::dtype type = array.dtype();
  const void* data = array.data();
  const auto code = static_cast<nb::dlpack::dtype_code>(type.code);
  if (type.lanes == 1 && code == nb::dlpack::dtype_code::Float && type.bits == 64)
    return f(static_cast<const double*>(data));
  if (type.lanes == 1 && code == nb::dlpack::dtype_code::Float && type.bits == 32)
    return f(static_cast<const float*>(data));
  if (type.lanes == 1 && code == nb::dlpack::dtype_code::Int)
    switch (type.bits) {
    case 8:
      return f(static_cast<const std::int8_t*>(data));
    case 16:
      return f(static_cast<const std::int16_t*>(data));
    case 32:
      return f(static_cast<const std::int32_t*>(data));
    case 64:
      return f(static_cast<const std::int64_t*>(data));
    default:
      break;
    }
  if (type.lanes == 1 &&
      (code == nb::dlpack::dtype_code::UInt || code == nb::dlpack::dtype_code::Bool))
    switch (type.bits) {
    case 8:
      return f(static_cast<const std::uint8_t*>(data));
    case 16:
      return f(static_cast<const std::uint16_t*>(data));
    case 32:
      return f(static_cast<const std::uint32_t*>(data));
    case 64:
      return f(static_cast<const std::uint64_t*>(data));
    default:
      break;
    }
  throw Error(Status::Usage, "", "an array has a number type that is not known here",
              "convert it to float64, float32, int64 or int32");
}

std::size_t rowsOf(const AnyArray& array) {
  return array.ndim() == 0 ? 1 : array.shape(0);
}

std::size_t itemsInRow(const AnyArray& array) {
  std::size_t items = 1;
  for (std::size_t i = 1; i < array.ndim(); ++i)
    items *= array.shape(i);
  return items;
}

// Calls take(row, column, item) for every item, rows in parallel; columns count the items of a row
// in C order.
template <typename Item, typename Take>
void forEachItem(const AnyArray& array, const Item* first, const Take& take) {
  const std::size_t rows = rowsOf(array), columns = itemsInRow(array);
  if (rows == 0 || columns == 0)
    return;
  std::vector<std::int64_t> offsets(columns, 0); // of a row's items
  for (std::size_t column = 0; column < columns; ++column) {
    std::size_t left = column;
    for (std::size_t axis = array.ndim(); axis-- > 1;) {
      offsets[column] += static_cast<std::int64_t>(left % array.shape(axis)) * array.stride(axis);
      left /= array.shape(axis);
    }
  }
  const std::int64_t stride = array.ndim() == 0 ? 0 : array.stride(0);
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, rows, std::max<std::size_t>(1, kItemsPerTask / columns)),
      [&](const auto& range) {
        for (std::size_t row = range.begin(); row != range.end(); ++row) {
          const Item* at = first + static_cast<std::int64_t>(row) * stride;
          for (std::size_t column = 0; column < columns; ++column)
            take(row, column, at[offsets[column]]);
        }
      });
}

// Whole numbers from 0 to below `end`, row by row.
template <typename Number>
std::vector<Number> wholeNumbers(const AnyArray& array, const std::string& what,
                                 std::uint64_t end) {
  const std::size_t columns = itemsInRow(array), count = rowsOf(array) * columns;
  std::vector<Number> numbers(count);
  std::atomic<std::size_t> bad{count};
  withItems(array, [&](const auto* first) {
    using Item = std::decay_t<decltype(*first)>;
    if constexpr (std::is_floating_point_v<Item>) {
      throw Error(Status::Usage, what, "holds floating-point numbers", "give an array of integers");
    } else {
      forEachItem(array, first, [&](std::size_t row, std::size_t column, Item item) {
        const std::size_t i = row * columns + column;
        const bool isBelow = std::is_signed_v<Item> && item < Item(0);
        if (isBelow || static_cast<std::uint64_t>(item) >= end) {
          std::size_t known = bad;
          while (i < known && !bad.compare_exchange_weak(known, i)) {
          }
        } else {
          numbers[i] = static_cast<Number>(item);
        }
      });
    }
  });
  if (bad < count)
    throw Error(Status::Invalid, what,
                "number " + std::to_string(bad) + " is negative or too large for an index");
  return numbers;
}

} // namespace

AnyArray arrayOf(nb::handle object, const std::string& what, std::size_t dimensions,
                 std::size_t last) {
  AnyArray array;
  if (!nb::try_cast(object, array)) {
    PyErr_Clear();
    throw Error(Status::Usage, what, "is no array in the memory of the CPU",
                "give a NumPy array, or an object with __dlpack__; of a GPU's tensor its .cpu()");
  }
  if (array.ndim() != dimensions && dimensions != 0)
    throw Error(Status::Usage, what, "has the shape " + shapeText(array),
                "give an array of " + std::to_string(dimensions) + " dimensions");
  if (last != 0 && array.shape(array.ndim() - 1) != last)
    throw Error(Status::Usage, what, "has the shape " + shapeText(array),
                "its last extent has to be " + std::to_string(last));
  return array;
}

std::vector<Vec3d> pointsOf(const AnyArray& array) {
  std::vector<Vec3d> points(array.shape(0));
  withItems(array, [&](const auto* first) {
    forEachItem(array, first, [&](std::size_t row, std::size_t column, auto item) {
      points[row][column] = static_cast<double>(item);
    });
  });
  return points;
}

std::vector<std::uint32_t> indicesOf(const AnyArray& array, const std::string& what) {
  return wholeNumbers<std::uint32_t>(array, what, std::numeric_limits<std::uint32_t>::max());
}

std::vector<std::uint64_t> offsetsOf(const AnyArray& array, const std::string& what) {
  return wholeNumbers<std::uint64_t>(array, what, std::uint64_t(1) << 62);
}

std::vector<std::uint8_t> bytesOf(const AnyArray& array, const std::string& what) {
  return wholeNumbers<std::uint8_t>(array, what, 256);
}

Attribute attributeOf(const std::string& name, Attribute::On on, const AnyArray& array) {
  Attribute attribute;
  attribute.name = name;
  attribute.on = on;
  const std::size_t columns = itemsInRow(array);
  if (columns == 0 || columns > std::numeric_limits<std::uint32_t>::max())
    throw Error(Status::Usage, name, "has the shape " + shapeText(array),
                "give an array with a row for every point or cell");
  attribute.components = static_cast<std::uint32_t>(columns);
  withItems(array, [&](const auto* first) {
    using Item = std::decay_t<decltype(*first)>;
    const auto fill = [&](auto number) {
      using Number = decltype(number);
      std::vector<Number> values(rowsOf(array) * columns);
      forEachItem(array, first, [&](std::size_t row, std::size_t column, Item item) {
        values[row * columns + column] = static_cast<Number>(item);
      });
      attribute.values = std::move(values);
    };
    if constexpr (std::is_floating_point_v<Item>)
      fill(Item());
    else if constexpr (sizeof(Item) < 4 || std::is_same_v<Item, std::int32_t>)
      fill(std::int32_t());
    else
      fill(std::int64_t()); // of uint64 those beyond are no values of a field
  });
  return attribute;
}

} // namespace tetvdb::python
