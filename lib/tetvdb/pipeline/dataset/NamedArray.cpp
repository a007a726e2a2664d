// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/NamedArray.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/io/text/ZipWriter.h"
#include "tetvdb/io/volume/arrays/NpyHeader.h"
#include "tetvdb/pipeline/dataset/PackedBits.h"

#include <functional>
#include <numeric>
#include <openvdb/math/Half.h>

namespace tetvdb {

NamedArray flagArray(std::string name, std::vector<std::uint64_t> shape,
                     const std::vector<std::uint8_t>& flags) {
  NamedArray array{std::move(name), "|b1", std::move(shape), PackedBits(flags).takeBytes()};
  array.packed = true;
  return array;
}

NamedArray asBytes(NamedArray array) {
  if (array.packed) {
    array.type = "|u1";
    array.shape = {array.bytes.size()};
    array.packed = false;
  }
  return array;
}

NamedArray unpacked(NamedArray array) {
  if (array.packed) {
    const std::uint64_t count = std::accumulate(array.shape.begin(), array.shape.end(),
                                                std::uint64_t(1), std::multiplies<>());
    array.bytes = PackedBits::unpacked(array.bytes, count);
    array.packed = false;
  }
  return array;
}

void writeNpzArrays(const std::string& path, const std::vector<NamedArray>& arrays) {
  AtomicFile file(path);
  ZipWriter zip(file);
  for (const NamedArray& array : arrays) {
    const std::string header = npyHeader(array.type, array.shape);
    zip.begin(array.name + ".npy", ZipMethod::Deflated, header.size() + array.bytes.size());
    zip.write(header);
    zip.write({array.bytes.data(), array.bytes.size()});
    zip.end();
  }
  zip.finish();
  file.commit();
}

void writeNpyArray(const std::string& path, const NamedArray& array) {
  AtomicFile file(path);
  const std::string header = npyHeader(array.type, array.shape);
  file.write(header.data(), header.size());
  file.write(array.bytes.data(), array.bytes.size());
  file.commit();
}

std::vector<std::uint16_t> toHalf(const std::vector<float>& values) {
  std::vector<std::uint16_t> halves;
  halves.reserve(values.size());
  for (const float value : values)
    halves.push_back(openvdb::math::half(value).bits());
  return halves;
}

} // namespace tetvdb
