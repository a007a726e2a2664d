// SPDX-License-Identifier: Apache-2.0
//
// Datasets [x][y][z] of an HDF5 file, with the attributes of docs/formats.md.
#include "tetvdb/core/Report.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/Hdf5Volume.h"
#include "tetvdb/io/volume/arrays/NpyArray.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <variant>
#include <vector>

namespace tetvdb {
namespace {

// What the child process says, which is not believed.
class Description {
public:
  Description(const Attribute::Values& values, std::string path) : path_(std::move(path)) {
    if (const auto* numbers = std::get_if<std::vector<std::int64_t>>(&values))
      numbers_ = *numbers;
    else
      fail();
  }
  bool atEnd() const { return at_ == numbers_.size(); }
  std::uint64_t take(std::uint64_t most) {
    if (atEnd() || numbers_[at_] < 0 || static_cast<std::uint64_t>(numbers_[at_]) > most)
      fail();
    return static_cast<std::uint64_t>(numbers_[at_++]);
  }
  [[noreturn]] void fail() const {
    throw Error(Status::Invalid, path_, "its datasets cannot be read", kCut);
  }

private:
  std::string path_;
  std::vector<std::int64_t> numbers_;
  std::size_t at_ = 0;
};

// Numbers that were narrower in the file, which is what decides about the grid.
template <typename Narrow>
std::string narrowed(const std::vector<std::int32_t>& wide) {
  std::string bytes(wide.size() * sizeof(Narrow), '\0');
  for (std::size_t i = 0; i < wide.size(); ++i) {
    const auto number = static_cast<Narrow>(wide[i]);
    std::memcpy(bytes.data() + i * sizeof(Narrow), &number, sizeof(Narrow));
  }
  return bytes;
}

// `own` receives the bytes where they are not those of the values.
void setNumbers(const Attribute::Values& values, std::uint64_t bytes, std::string& own,
                NpyArray& array) {
  const auto view = [&](ElementType element, const auto& numbers) {
    array.element = element;
    array.bytes = {reinterpret_cast<const char*>(numbers.data()),
                   numbers.size() * sizeof numbers[0]};
  };
  if (const auto* floats = std::get_if<std::vector<float>>(&values))
    return view(ElementType::Float32, *floats);
  if (const auto* doubles = std::get_if<std::vector<double>>(&values))
    return view(ElementType::Float64, *doubles);
  if (const auto* wide = std::get_if<std::vector<std::int64_t>>(&values))
    return view(ElementType::Int64, *wide);
  const auto& numbers = std::get<std::vector<std::int32_t>>(values);
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  if (bytes > 2 || numbers.empty())
    return view(ElementType::Int32, numbers);
  const bool isUnsigned = *least >= 0;
  array.element = bytes == 1 ? (isUnsigned ? ElementType::UInt8 : ElementType::Int8)
                             : (isUnsigned ? ElementType::UInt16 : ElementType::Int16);
  own = bytes == 1 ? narrowed<std::uint8_t>(numbers) : narrowed<std::uint16_t>(numbers);
  array.bytes = own;
}

} // namespace

void readHdf5Arrays(const Source& source, const ArraySink& sink, Progress& progress) {
  constexpr std::uint64_t kLongest = 100000, kLargest = std::uint64_t(1) << 40;
  Report report;
  const NumberArrays all = readHdf5Volume(source, report, progress);
  if (all.size() < 2)
    throw Error(Status::Invalid, source.path, "its datasets cannot be read", kCut);
  Description description(all[0], source.path);
  StoredArray place;
  if (const auto* numbers = std::get_if<std::vector<double>>(&all[1]);
      numbers != nullptr && numbers->size() == 19) {
    place.placed = true;
    std::copy_n(numbers->begin(), 16, place.transform.begin());
    for (std::size_t k = 0; k < 3; ++k)
      place.low[k] = static_cast<std::int32_t>(
          std::clamp((*numbers)[16 + k], INT32_MIN / 2.0, INT32_MAX / 2.0));
  }
  std::size_t next = 2;
  while (!description.atEnd()) {
    NpyArray found;
    const std::uint64_t bytes = description.take(8);
    for (std::uint64_t n = description.take(32); n > 0; --n)
      found.shape.push_back(description.take(kLargest));
    std::string name(description.take(kLongest), '\0');
    for (char& c : name)
      c = static_cast<char>(description.take(255));
    std::string own;
    StoredArray array = place;
    array.name = name;
    if (bytes > 0) {
      if (next == all.size())
        description.fail();
      setNumbers(all[next++], bytes, own, found);
      if (requireBytes(source.path, found.bytes.size(), bytesOf(found.element), found.shape) !=
          found.bytes.size())
        description.fail();
    }
    if (bytes > 0 && setVoxels(found, array))
      sink.array(array);
    else
      sink.leftOut(name, "no array of voxels");
  }
}

} // namespace tetvdb
