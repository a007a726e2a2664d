// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/arrays/ArrayGrid.h"

#include "tetvdb/core/Multiversion.h"
#include "tetvdb/geometry/LeafDistance.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/io/volume/arrays/ArrayRows.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/TreeAssembly.h"
#include "tetvdb/volume/VoxelBox.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <type_traits>

namespace tetvdb {
namespace {

using openvdb::Index;

constexpr std::size_t kRowPart = 4096; // numbers that are looked at together

template <typename Number>
struct Range {
  Number min = std::numeric_limits<Number>::max(), max = std::numeric_limits<Number>::lowest();
  bool negativeAtSides = false; ///< of the array's box

  static Range joined(const Range& a, const Range& b) {
    return {std::min(a.min, b.min), std::max(a.max, b.max), a.negativeAtSides || b.negativeAtSides};
  }
};

// Calls visit(state, numbers, count, isSide) for parts of the array's rows. isSide: all of them lie
// at sides of the box; the first and the last of a row always do.
template <typename Number, typename State, typename Visit, typename Join>
State reduceRows(const StoredArray& array, const Visit& visit, const Join& join,
                 Progress& progress) {
  const ArrayRows<Number> rows(array);
  const std::uint64_t length = array.size[rows.along()], across = array.size[rows.b()];
  const auto count = static_cast<std::size_t>(array.size[rows.a()] * across);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, 64), State(),
      [&](const auto& part, State state) {
        progress.check();
        Number numbers[kRowPart];
        for (std::size_t row = part.begin(); row != part.end(); ++row) {
          std::array<std::uint64_t, 3> at{};
          at[rows.a()] = row / across;
          at[rows.b()] = row % across;
          const auto isEnd = [&](std::size_t k) {
            return at[k] == 0 || at[k] + 1 == array.size[k];
          };
          const bool isSide = isEnd(rows.a()) || isEnd(rows.b());
          for (std::uint64_t i = 0; i < length; i += kRowPart) {
            at[rows.along()] = i;
            const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(kRowPart, length - i));
            rows.read(at, 0, n, numbers);
            visit(state, numbers, n, isSide, i == 0, i + n == length);
          }
        }
        return state;
      },
      join);
}

// NaN is neither.
template <typename Number>
TETVDB_MULTIVERSION void addRange(const Number* numbers, std::size_t count, Number& min,
                                  Number& max) {
  constexpr std::size_t kLanes = 16;
  Number low[kLanes], high[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    low[k] = min;
    high[k] = max;
  }
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      low[k] = numbers[i + k] < low[k] ? numbers[i + k] : low[k];
      high[k] = numbers[i + k] > high[k] ? numbers[i + k] : high[k];
    }
  for (; i < count; ++i) {
    low[0] = numbers[i] < low[0] ? numbers[i] : low[0];
    high[0] = numbers[i] > high[0] ? numbers[i] : high[0];
  }
  for (std::size_t k = 0; k < kLanes; ++k) {
    min = std::min(min, low[k]);
    max = std::max(max, high[k]);
  }
}

template <typename Number>
Range<Number> rangeOf(const StoredArray& array, Progress& progress) {
  return reduceRows<Number, Range<Number>>(
      array,
      [](Range<Number>& range, const Number* numbers, std::size_t count, bool isSide, bool isFirst,
         bool isLast) {
        Range<Number> own;
        addRange(numbers, count, own.min, own.max);
        range = Range<Number>::joined(range, own);
        range.negativeAtSides = range.negativeAtSides || (isSide && own.min < 0) ||
                                (isFirst && numbers[0] < 0) || (isLast && numbers[count - 1] < 0);
      },
      Range<Number>::joined, progress);
}

// Whether these are signed distances that are cut off: the largest distance is frequent, at least
// in arrays that are not named as level sets are, and negative ones are inside alone.
bool isCutOff(const StoredArray& array, const Range<float>& range, Progress& progress) {
  constexpr std::uint64_t kShare = 10;
  if (!(range.min < 0 && range.max > 0 && -range.min <= range.max) || range.negativeAtSides)
    return false;
  if (array.name == infoOf(GridKind::Surface).name)
    return true;
  const auto farthest = reduceRows<float, std::uint64_t>(
      array,
      [&](std::uint64_t& sum, const float* numbers, std::size_t count, bool, bool, bool) {
        sum += static_cast<std::uint64_t>(std::count_if(
            numbers, numbers + count, [&](float value) { return std::abs(value) == range.max; }));
      },
      std::plus<>(), progress);
  return farthest >= array.size[0] * array.size[1] * array.size[2] / kShare;
}

// What the numbers of a grid's values are loaded as.
template <typename Value>
struct NumberIn {
  using Type = Value;
  static constexpr std::size_t kComponents = 1;
};
template <>
struct NumberIn<bool> {
  using Type = std::uint8_t;
  static constexpr std::size_t kComponents = 1;
};
template <>
struct NumberIn<openvdb::Vec3s> {
  using Type = float;
  static constexpr std::size_t kComponents = 3;
};

template <typename Value>
bool isNumber(const Value& value) {
  if constexpr (std::is_same_v<Value, openvdb::Vec3s>)
    return !(std::isnan(value[0]) || std::isnan(value[1]) || std::isnan(value[2]));
  else if constexpr (std::is_floating_point_v<Value>)
    return !std::isnan(value);
  else
    return true;
}

// Copies an array into a tree.
template <typename TreeType>
class ArrayCopy {
  using Assembly = TreeAssembly<TreeType>;
  using Lower = typename Assembly::Lower;
  using Leaf = typename TreeType::LeafNodeType;
  using Value = typename TreeType::ValueType;
  using Number = typename NumberIn<Value>::Type;
  static constexpr std::size_t kComponents = NumberIn<Value>::kComponents;

public:
  ArrayCopy(const StoredArray& array, const Value& background, bool isLevelSet)
      : array_(array), rows_(array), background_(background), isLevelSet_(isLevelSet) {
    for (std::size_t k = 0; k < 3; ++k) {
      box_.low[k] = array.low[k];
      box_.high[k] =
          static_cast<std::int32_t>(array.low[k] + static_cast<std::int64_t>(array.size[k]) - 1);
    }
  }

  typename openvdb::Grid<TreeType>::Ptr run(const std::string& name, openvdb::GridClass gridClass,
                                            Progress& progress) {
    Assembly assembly(background_);
    NodeIndex low, size;
    std::size_t nodes = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = nodeOf(box_.low[k]);
      size[k] = nodeOf(box_.high[k]) - low[k] + 1;
      nodes *= static_cast<std::size_t>(size[k]);
    }
    std::atomic<std::size_t> done{0};
    tbb::parallel_for(std::size_t(0), nodes, [&](std::size_t i) {
      progress.check();
      const auto n = static_cast<std::int64_t>(i);
      const NodeIndex node{static_cast<std::int32_t>(low[0] + n / size[2] / size[1]),
                           static_cast<std::int32_t>(low[1] + n / size[2] % size[1]),
                           static_cast<std::int32_t>(low[2] + n % size[2])};
      auto lower = assembly.begin(node);
      for (Index entry = 0; entry < Lower::NUM_VALUES; ++entry)
        addLeaf(*lower, entry);
      assembly.end(std::move(lower), node);
      progress.update(static_cast<double>(++done) / static_cast<double>(nodes));
    });
    return assembly.finish(name, gridClass, {});
  }

  std::uint64_t notNumbers() const { return notNumbers_; }

private:
  bool isActive(const Value& value) const {
    if constexpr (std::is_same_v<Value, float>)
      if (isLevelSet_)
        return std::abs(value) < background_;
    return value != background_;
  }

  // The array's voxels in a leaf, which becomes a node, a tile or nothing.
  void addLeaf(Lower& lower, Index entry) {
    const openvdb::Coord origin = lower.offsetToGlobalCoord(entry);
    Value values[kVoxelsInLeaf];
    if (!readLeaf(origin, values))
      return;
    const Value first = values[0];
    if (std::all_of(values, values + kVoxelsInLeaf,
                    [&](const Value& value) { return value == first; })) {
      const bool active = isActive(first);
      if (active || first != background_)
        lower.addTile(entry, first, active);
      return;
    }
    auto leaf = std::make_unique<Leaf>(origin, background_, false);
    typename Leaf::NodeMaskType active;
    for (Index word = 0; word < Leaf::NodeMaskType::WORD_COUNT; ++word) {
      openvdb::Index64 bits = 0;
      for (Index bit = 0; bit < 64; ++bit)
        bits |= openvdb::Index64(isActive(values[64 * word + bit])) << bit;
      active.template getWord<openvdb::Index64>(word) = bits;
    }
    for (Index voxel = 0; voxel < kVoxelsInLeaf; ++voxel)
      leaf->setValueOnly(voxel, values[voxel]);
    leaf->setValueMask(active);
    lower.addLeaf(leaf.release());
  }

  // False if none of the leaf's voxels is in the array; those that are not have the background.
  bool readLeaf(const openvdb::Coord& origin, Value* values) {
    std::array<std::uint64_t, 3> first{}, count{};
    Index start = 0;
    constexpr Index kSteps[3] = {kLeafSize * kLeafSize, kLeafSize, 1};
    bool isWhole = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t at = origin[k];
      const std::int32_t low = std::max(at, box_.low[k]);
      const std::int32_t high = std::min(at + kLeafSize - 1, box_.high[k]);
      if (high < low)
        return false;
      first[k] = static_cast<std::uint64_t>(static_cast<std::int64_t>(low) - box_.low[k]);
      count[k] = static_cast<std::uint64_t>(high - low) + 1;
      start += static_cast<Index>(low - at) * kSteps[k];
      isWhole = isWhole && count[k] == kLeafSize;
    }
    if (!isWhole)
      std::fill(values, values + kVoxelsInLeaf, background_);
    const std::size_t a = rows_.a(), b = rows_.b(), along = rows_.along();
    const auto length = static_cast<std::size_t>(count[along]);
    for (std::uint64_t i = 0; i < count[a]; ++i)
      for (std::uint64_t j = 0; j < count[b]; ++j) {
        std::array<std::uint64_t, 3> at = first;
        at[a] += i;
        at[b] += j;
        Value* out =
            values + start + static_cast<Index>(i) * kSteps[a] + static_cast<Index>(j) * kSteps[b];
        if constexpr (std::is_same_v<Value, Number>) {
          rows_.read(at, 0, length, out, static_cast<std::ptrdiff_t>(kSteps[along]));
        } else {
          Number numbers[kComponents][kLeafSize];
          for (std::size_t k = 0; k < kComponents; ++k)
            rows_.read(at, k, length, numbers[k]);
          for (std::size_t n = 0; n < length; ++n)
            out[n * kSteps[along]] = valueOf(numbers, n);
        }
      }
    if constexpr (!std::is_integral_v<Value>)
      replaceNaN(values);
    return true;
  }
  static Value valueOf(const Number (&numbers)[kComponents][kLeafSize], std::size_t n) {
    if constexpr (kComponents == 3)
      return {numbers[0][n], numbers[1][n], numbers[2][n]};
    else
      return static_cast<Value>(numbers[0][n]); // of bool: 0 or 1
  }

  void replaceNaN(Value* values) {
    std::uint64_t found = 0;
    for (int i = 0; i < kVoxelsInLeaf; ++i)
      if (!isNumber(values[i])) {
        values[i] = background_;
        ++found;
      }
    if (found > 0)
      notNumbers_ += found;
  }

  const StoredArray& array_;
  ArrayRows<Number> rows_;
  Value background_;
  bool isLevelSet_;
  VoxelBox box_;
  std::atomic<std::uint64_t> notNumbers_{0};
};

// Voxels of a list, which are active.
template <typename TreeType>
ArrayGrid copyList(const StoredArray& array, const typename TreeType::ValueType& background,
                   Progress& progress) {
  using Value = typename TreeType::ValueType;
  using Number = typename NumberIn<Value>::Type;
  constexpr std::size_t kComponents = NumberIn<Value>::kComponents;
  constexpr std::uint64_t kCheck = 1 << 16;
  const ArrayRows<Number> rows(array);
  ArrayGrid made;
  auto grid = openvdb::Grid<TreeType>::create(background);
  auto accessor = grid->getAccessor();
  for (std::uint64_t i = 0; i < array.size[0]; ++i) {
    if (i % kCheck == 0)
      progress.check();
    Number numbers[kComponents];
    for (std::size_t k = 0; k < kComponents; ++k)
      rows.read({i, 0, 0}, k, 1, numbers + k);
    std::int32_t at[3];
    std::memcpy(at, array.coordinates.data() + i * sizeof at, sizeof at);
    Value value;
    if constexpr (kComponents == 3)
      value = Value(numbers);
    else
      value = static_cast<Value>(numbers[0]);
    if (isNumber(value))
      accessor.setValueOn(openvdb::Coord(at), value);
    else
      ++made.notNumbers;
  }
  openvdb::tools::prune(grid->tree());
  made.grid = grid;
  return made;
}

template <typename TreeType>
ArrayGrid copyInto(const StoredArray& array, const std::string& name,
                   const typename TreeType::ValueType& background, openvdb::GridClass gridClass,
                   Progress& progress) {
  ArrayGrid made;
  if (!array.coordinates.empty()) {
    made = copyList<TreeType>(array, background, progress);
    if constexpr (std::is_same_v<TreeType, openvdb::FloatTree>)
      if (gridClass == openvdb::GRID_LEVEL_SET)
        openvdb::tools::signedFloodFill(
            openvdb::gridPtrCast<openvdb::FloatGrid>(made.grid)->tree());
    made.grid->setName(name);
    made.grid->setGridClass(gridClass);
  } else {
    ArrayCopy<TreeType> copy(array, background, gridClass == openvdb::GRID_LEVEL_SET);
    made.grid = copy.run(name, gridClass, progress);
    made.notNumbers = copy.notNumbers();
  }
  made.grid->setSaveFloatAsHalf(array.element == ElementType::Float16);
  return made;
}

} // namespace

ArrayGrid gridOf(const StoredArray& array, const std::string& name,
                 const std::optional<double>& background, Progress& progress) {
  using openvdb::GRID_UNKNOWN;
  const bool isList = !array.coordinates.empty();
  const double given = background.value_or(isList ? array.background : 0);
  const auto number = static_cast<float>(given);
  if (array.components == 3)
    return copyInto<openvdb::Vec3STree>(array, name, openvdb::Vec3s(number), GRID_UNKNOWN,
                                        progress);
  const bool isScaled = array.slope != 1 || array.intercept != 0;
  if (array.isBits || (array.element == ElementType::UInt8 && !isScaled &&
                       rangeOf<std::uint8_t>(array, progress).max <= 1))
    return copyInto<openvdb::BoolTree>(array, name, given != 0, GRID_UNKNOWN, progress);
  if (!isFloat(array.element) && bytesOf(array.element) > 2 && !isScaled) {
    const bool isUnsigned =
        array.element == ElementType::UInt32 || array.element == ElementType::UInt64;
    const std::uint64_t max = isUnsigned ? rangeOf<std::uint64_t>(array, progress).max : 0;
    if (bytesOf(array.element) == sizeof(std::int32_t) && max <= INT32_MAX)
      return copyInto<openvdb::Int32Tree>(
          array, name, static_cast<std::int32_t>(std::clamp<double>(given, INT32_MIN, INT32_MAX)),
          GRID_UNKNOWN, progress);
    if (max > INT64_MAX)
      throw Error(Status::Limit, name, "has integers above 2^63 - 1", "convert them to float32");
    constexpr double kMost = 4611686018427387904.0; // 2^62
    return copyInto<openvdb::Int64Tree>(array, name,
                                        static_cast<std::int64_t>(std::clamp(given, -kMost, kMost)),
                                        GRID_UNKNOWN, progress);
  }
  if (isFloat(array.element) && (isList || !background)) {
    const Range<float> range = rangeOf<float>(array, progress);
    const bool isLevelSet = isList ? number > 0 && range.min < 0 && range.max < number
                                   : isCutOff(array, range, progress);
    if (isLevelSet)
      return copyInto<openvdb::FloatTree>(array, name, isList ? number : range.max,
                                          openvdb::GRID_LEVEL_SET, progress);
  }
  return copyInto<openvdb::FloatTree>(array, name, number, openvdb::GRID_FOG_VOLUME, progress);
}

} // namespace tetvdb
