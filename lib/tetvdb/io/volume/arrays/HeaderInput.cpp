// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/arrays/HeaderInput.h"

#include "tetvdb/io/source/PathWithin.h"
#include "tetvdb/io/text/GunzipBytes.h"
#include "tetvdb/io/text/NumberParser.h"

#include <array>
#include <vector>

namespace tetvdb {
namespace {

std::array<std::uint64_t, 4> lengthsOf(const StoredArray& array) {
  return {array.size[0], array.size[1], array.size[2], array.components};
}

} // namespace

const std::string* HeaderInput::find(std::initializer_list<const char*> names) const {
  for (const char* name : names)
    if (const auto found = fields_.find(name); found != fields_.end())
      return &found->second;
  return nullptr;
}

const std::string& HeaderInput::needed(const char* name) const {
  if (const std::string* value = find({name}))
    return *value;
  fail("the header has no '" + std::string(name) + "'");
}

void HeaderInput::useFile(const std::string& name) {
  beside_.emplace(pathWithin(source_.path, name));
  data_ = beside_->bytes();
}

void HeaderInput::pass(Encoding encoding, std::int64_t skip, const ArraySink& sink,
                       Progress& progress) {
  std::string own;
  if (encoding == Encoding::Raw) {
    const std::uint64_t size =
        requireBytes(source_.path, data_.size(), bytesOf(array_.element), lengthsOf(array_));
    const std::uint64_t room = data_.size() - size;
    const auto begin = skip < 0 ? room : static_cast<std::uint64_t>(skip);
    if (begin > room)
      fail("ends before its last voxel", kCut);
    array_.bytes = data_.substr(static_cast<std::size_t>(begin));
  } else if (encoding == Encoding::Packed) {
    own = unpacked(skip);
    array_.bytes = own;
  } else {
    own = parsed();
    array_.bytes = own;
    array_.element = ElementType::Float64;
    array_.swap = false;
  }
  progress.check();
  sink.array(array_);
}

std::string HeaderInput::unpacked(std::int64_t skip) const {
  const std::uint64_t most = data_.size() * kBestDeflate;
  const std::uint64_t size =
      requireBytes(source_.path, most, bytesOf(array_.element), lengthsOf(array_));
  if (skip > 0 && static_cast<std::uint64_t>(skip) > most)
    fail("ends before its last voxel", kCut);
  const std::uint64_t end = skip < 0 ? most : size + static_cast<std::uint64_t>(skip);
  std::string bytes = data_.substr(0, 2) == "\x1f\x8b"
                          ? gunzip(data_, static_cast<std::size_t>(end), source_.path)
                          : inflateZlib(data_, static_cast<std::size_t>(end), source_.path);
  if (bytes.size() < (skip < 0 ? size : end))
    fail("ends before its last voxel", kCut);
  bytes.erase(0, skip < 0 ? bytes.size() - static_cast<std::size_t>(size)
                          : static_cast<std::size_t>(skip));
  return bytes;
}

// The text's numbers as bytes of doubles.
std::string HeaderInput::parsed() const {
  const std::uint64_t count = requireBytes(source_.path, data_.size(), 1, lengthsOf(array_));
  std::vector<double> values(static_cast<std::size_t>(count));
  NumberParser in(data_, source_.path);
  for (double& value : values)
    value = in.value();
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)};
}

} // namespace tetvdb
