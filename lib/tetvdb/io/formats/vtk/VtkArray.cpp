// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkArray.h"

#include "tetvdb/core/AtomicBounds.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <type_traits>
#include <utility>

namespace tetvdb::vtk {
namespace {

constexpr std::size_t kGrain = 1 << 16;

/// Calls `f` with a number of the C++ type of `type`.
template <class F>
auto withNumber(Number type, F&& f) {
  switch (type) {
  case Number::Int8:
    return f(std::int8_t{});
  case Number::Bit: // callers handle bits
  case Number::UInt8:
    return f(std::uint8_t{});
  case Number::Int16:
    return f(std::int16_t{});
  case Number::UInt16:
    return f(std::uint16_t{});
  case Number::Int32:
    return f(std::int32_t{});
  case Number::UInt32:
    return f(std::uint32_t{});
  case Number::Int64:
    return f(std::int64_t{});
  case Number::UInt64:
    return f(std::uint64_t{});
  case Number::Float32:
    return f(float{});
  case Number::Float64:
    break;
  }
  return f(double{});
}

/// out[i] = convert(number i), in parallel.
template <class From, class To, class Convert>
void convertAll(const Array& array, To* out, Convert convert) {
  const auto loop = [&](std::size_t begin, std::size_t end, auto swap) {
    const char* from = array.data + begin * sizeof(From);
    for (std::size_t i = begin; i < end; ++i, from += sizeof(From))
      out[i] = convert(loadNumber<From>(from, swap));
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, array.count, kGrain),
                    [&](const auto& range) {
                      if (array.swap)
                        loop(range.begin(), range.end(), std::true_type());
                      else
                        loop(range.begin(), range.end(), std::false_type());
                    });
}

void refuseBits(const Array& array) {
  if (array.type == Number::Bit)
    throw Error(Status::Invalid, array.where, "holds bits where numbers are expected",
                "export the file again");
}

/// Integers to `To`; those outside 0 to `last` become `last + 1`.
template <class To>
std::vector<To> toBounded(const Array& array, std::uint64_t last) {
  refuseBits(array);
  std::vector<To> out(array.count);
  withNumber(array.type, [&](auto tag) {
    using From = decltype(tag);
    if constexpr (std::is_floating_point_v<From>)
      throw Error(Status::Invalid, array.where,
                  "holds floating-point numbers, but indices are whole", "export the file again");
    else
      convertAll<From>(array, out.data(), [last](From v) {
        // A negative number is a large unsigned one.
        const auto u = static_cast<std::uint64_t>(static_cast<std::int64_t>(v));
        return static_cast<To>(u <= last ? u : last + 1);
      });
  });
  return out;
}

template <class T>
T parseOne(NumberParser& in) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(in.value());
  } else {
    const std::int64_t v = in.realInteger();
    if constexpr (sizeof(T) < sizeof v)
      if (v < std::numeric_limits<T>::min() || v > std::numeric_limits<T>::max())
        in.fail("the number " + std::to_string(v) + " does not fit the array's type");
    return static_cast<T>(v);
  }
}

// Unsigned 64-bit numbers beyond int64, which NumberParser does not support.
template <>
std::uint64_t parseOne<std::uint64_t>(NumberParser& in) {
  std::int64_t v = 0;
  if (in.tryInteger(v))
    return static_cast<std::uint64_t>(v);
  const double number = in.real();
  if (number < 0 || number != std::floor(number) || number >= 18446744073709551616.0)
    in.failNumber("a whole number");
  return static_cast<std::uint64_t>(number);
}

} // namespace

std::optional<Number> xmlNumber(std::string_view name) {
  static constexpr std::pair<std::string_view, Number> kNames[] = {
      {"Float32", Number::Float32}, {"Float64", Number::Float64}, {"Int8", Number::Int8},
      {"UInt8", Number::UInt8},     {"Int16", Number::Int16},     {"UInt16", Number::UInt16},
      {"Int32", Number::Int32},     {"UInt32", Number::UInt32},   {"Int64", Number::Int64},
      {"UInt64", Number::UInt64},   {"Bit", Number::Bit}};
  for (const auto& [known, type] : kNames)
    if (known == name)
      return type;
  return {};
}

std::optional<Number> legacyNumber(std::string_view name) {
  static constexpr std::pair<std::string_view, Number> kNames[] = {
      {"bit", Number::Bit},
      {"char", Number::Int8},
      {"signed_char", Number::Int8},
      {"unsigned_char", Number::UInt8},
      {"short", Number::Int16},
      {"unsigned_short", Number::UInt16},
      {"int", Number::Int32},
      {"vtkidtype", Number::Int32},
      {"unsigned_int", Number::UInt32},
      {"long", Number::Int64},
      {"unsigned_long", Number::UInt64},
      {"long_long", Number::Int64},
      {"unsigned_long_long", Number::UInt64},
      {"vtktypeint64", Number::Int64},
      {"vtktypeuint64", Number::UInt64},
      {"vtktypeint32", Number::Int32},
      {"vtktypeuint32", Number::UInt32},
      {"__int64", Number::Int64},
      {"unsigned___int64", Number::UInt64},
      {"float", Number::Float32},
      {"double", Number::Float64}};
  const std::string lower = lowerCase(name.substr(0, 32));
  for (const auto& [known, type] : kNames)
    if (known == lower)
      return type;
  return {};
}

std::uint64_t bytesFor(Number type, std::uint64_t count) {
  if (type == Number::Bit)
    return (count + 7) / 8;
  const std::uint64_t each = withNumber(type, [](auto tag) { return sizeof tag; });
  return count > std::numeric_limits<std::uint64_t>::max() / each
             ? std::numeric_limits<std::uint64_t>::max()
             : count * each;
}

bool isInteger(Number type) {
  return type != Number::Float32 && type != Number::Float64;
}

Array parseText(NumberParser& in, Number type, std::size_t count, Progress& progress) {
  Array array;
  array.type = type == Number::Bit ? Number::UInt8 : type;
  array.count = count;
  in.checkCount(static_cast<std::int64_t>(std::min<std::size_t>(count, SIZE_MAX / 2)), "numbers");
  array.owned.reset(new char[bytesFor(array.type, count)]);
  array.data = array.owned.get();
  withNumber(array.type, [&](auto tag) {
    using T = decltype(tag);
    char* out = array.owned.get();
    for (std::size_t done = 0; done < count;) {
      const std::size_t end = std::min(count, done + kGrain);
      for (; done < end; ++done, out += sizeof(T)) {
        const T value = parseOne<T>(in);
        std::memcpy(out, &value, sizeof value);
      }
      progress.check();
    }
  });
  return array;
}

std::vector<Vec3d> toPoints(const Array& array) {
  refuseBits(array);
  std::vector<Vec3d> points(array.count / 3);
  std::atomic<std::size_t> bad{std::numeric_limits<std::size_t>::max()};
  withNumber(array.type, [&](auto tag) {
    using From = decltype(tag);
    const auto loop = [&](std::size_t begin, std::size_t end, auto swap) {
      const char* from = array.data + begin * 3 * sizeof(From);
      double sum = 0; // 0 * x is nan if x is not finite
      for (std::size_t i = begin; i < end; ++i)
        for (double& x : points[i]) {
          x = static_cast<double>(loadNumber<From>(from, swap));
          sum += 0.0 * x;
          from += sizeof(From);
        }
      if (sum == 0)
        return;
      for (std::size_t i = begin; i < end; ++i)
        if (!std::isfinite(points[i][0] + points[i][1] + points[i][2]) &&
            (!std::isfinite(points[i][0]) || !std::isfinite(points[i][1]) ||
             !std::isfinite(points[i][2]))) {
          lowerTo(bad, i);
          break;
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), kGrain),
                      [&](const auto& range) {
                        if (array.swap)
                          loop(range.begin(), range.end(), std::true_type());
                        else
                          loop(range.begin(), range.end(), std::false_type());
                      });
  });
  if (bad.load() < points.size())
    throw Error(Status::Invalid, array.where,
                "point " + std::to_string(bad.load()) + " has a coordinate that is not finite",
                kExport);
  return points;
}

std::vector<std::uint32_t> toIndices(const Array& array) {
  return toBounded<std::uint32_t>(array, 0xfffffffeu);
}

std::vector<std::uint64_t> toOffsets(const Array& array) {
  return toBounded<std::uint64_t>(array, static_cast<std::uint64_t>(INT64_MAX));
}

std::vector<std::uint8_t> toTypes(const Array& array) {
  return toBounded<std::uint8_t>(array, 254);
}

Attribute toAttribute(std::string name, Attribute::On on, std::uint32_t components,
                      const Array& array) {
  Attribute attribute;
  attribute.name = std::move(name);
  attribute.on = on;
  attribute.components = components;
  if (array.type == Number::Bit) {
    std::vector<std::int32_t> bits(array.count);
    for (std::size_t i = 0; i < array.count; ++i)
      bits[i] = (static_cast<unsigned char>(array.data[i / 8]) >> (7 - i % 8)) & 1;
    attribute.values = std::move(bits);
    return attribute;
  }
  withNumber(array.type, [&](auto tag) {
    using From = decltype(tag);
    using To = std::conditional_t<
        std::is_floating_point_v<From>, From,
        std::conditional_t<(sizeof(From) < 4 || std::is_same_v<From, std::int32_t>), std::int32_t,
                           std::int64_t>>;
    std::vector<To> values(array.count);
    convertAll<From>(array, values.data(), [](From v) { return static_cast<To>(v); });
    attribute.values = std::move(values);
  });
  return attribute;
}

std::vector<double> toDoubles(const Array& array) {
  const Attribute values = toAttribute({}, Attribute::On::Points, 1, array);
  std::vector<double> numbers(values.size());
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = values.number(i);
  return numbers;
}

} // namespace tetvdb::vtk
