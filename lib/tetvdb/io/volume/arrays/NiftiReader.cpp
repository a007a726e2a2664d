// SPDX-License-Identifier: Apache-2.0
//
// Format: nifti1.h and nifti2.h of the NIfTI Data Format Working Group: a header, then numbers with
// x fastest, the whole file through gzip in .nii.gz.
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/GunzipBytes.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::int32_t kHeader1 = 348, kHeader2 = 540; // bytes

struct NiftiHeader {
  std::array<std::int64_t, 8> size{}; ///< [0]: number of axes
  std::array<double, 8> spacing{};    ///< [0]: whether the quaternion's z axis is mirrored, -1
  std::int64_t type = 0;
  double offset = 0, slope = 0, intercept = 0;
  std::int64_t quaternionCode = 0, matrixCode = 0;
  std::array<double, 3> quaternion{}, first{};
  std::array<double, 12> matrix{};
  bool swap = false;
};

template <typename Number, typename Out, std::size_t n>
void take(ByteReader& in, std::size_t at, std::array<Out, n>& out) {
  in.seek(at);
  for (Out& number : out)
    number = static_cast<Out>(in.get<Number>());
}
template <typename Number, typename Out>
void take(ByteReader& in, std::size_t at, Out& out) {
  in.seek(at);
  out = static_cast<Out>(in.get<Number>());
}

NiftiHeader parseHeader(std::string_view bytes, const std::string& path) {
  ByteReader in(bytes, path);
  NiftiHeader header;
  auto length = in.get<std::int32_t>();
  header.swap = byteSwapped(length) == kHeader1 || byteSwapped(length) == kHeader2;
  in.setSwap(header.swap);
  length = header.swap ? byteSwapped(length) : length;
  if (length == kHeader1) {
    take<std::int16_t>(in, 40, header.size);
    take<std::int16_t>(in, 70, header.type);
    take<float>(in, 76, header.spacing);
    take<float>(in, 108, header.offset);
    take<float>(in, 112, header.slope);
    take<float>(in, 116, header.intercept);
    take<std::int16_t>(in, 252, header.quaternionCode);
    take<std::int16_t>(in, 254, header.matrixCode);
    take<float>(in, 256, header.quaternion);
    take<float>(in, 268, header.first);
    take<float>(in, 280, header.matrix);
  } else if (length == kHeader2) {
    take<std::int16_t>(in, 12, header.type);
    take<std::int64_t>(in, 16, header.size);
    take<double>(in, 104, header.spacing);
    take<std::int64_t>(in, 168, header.offset);
    take<double>(in, 176, header.slope);
    take<double>(in, 184, header.intercept);
    take<std::int32_t>(in, 344, header.quaternionCode);
    take<std::int32_t>(in, 348, header.matrixCode);
    take<double>(in, 352, header.quaternion);
    take<double>(in, 376, header.first);
    take<double>(in, 400, header.matrix);
  } else {
    throw Error(Status::Invalid, path, "is no NIfTI file", kExport);
  }
  return header;
}

struct NiftiType {
  std::int64_t code;
  ElementType element;
  std::uint64_t components = 1;
};
constexpr NiftiType kNiftiTypes[] = {
    {2, ElementType::UInt8},    {4, ElementType::Int16},     {8, ElementType::Int32},
    {16, ElementType::Float32}, {64, ElementType::Float64},  {128, ElementType::UInt8, 3},
    {256, ElementType::Int8},   {512, ElementType::UInt16},  {768, ElementType::UInt32},
    {1024, ElementType::Int64}, {1280, ElementType::UInt64}, {2304, ElementType::UInt8, 4}};

// nifti1.h, "3D image (volume) orientation and location in space": methods 3, 2 and 1.
ArrayTransform transformOf(const NiftiHeader& header) {
  ArrayTransform m = kIdentity;
  if (header.matrixCode > 0) {
    std::copy(header.matrix.begin(), header.matrix.end(), m.begin());
    return m;
  }
  const auto spacing = [&](std::size_t k) {
    return header.spacing[k + 1] > 0 ? header.spacing[k + 1] : 1.0;
  };
  if (header.quaternionCode <= 0) {
    for (std::size_t k = 0; k < 3; ++k)
      m[5 * k] = spacing(k);
    return m;
  }
  const double b = header.quaternion[0], c = header.quaternion[1], d = header.quaternion[2];
  const double a = std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d));
  const double rotation[9] = {
      a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
      2 * (b * c + a * d),           a * a + c * c - b * b - d * d, 2 * (c * d - a * b),
      2 * (b * d - a * c),           2 * (c * d + a * b),           a * a + d * d - c * c - b * b};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t k = 0; k < 3; ++k)
      m[4 * row + k] =
          rotation[3 * row + k] * spacing(k) * (k == 2 && header.spacing[0] < 0 ? -1 : 1);
    m[4 * row + 3] = header.first[row];
  }
  return m;
}

} // namespace

void readNifti(const Source& source, const ArraySink& sink, Progress& progress) {
  const bool isPacked = source.bytes.substr(0, 2) == "\x1f\x8b";
  std::string unpacked;
  if (isPacked)
    unpacked = gunzip(source.bytes, kHeader2, source.path);
  const NiftiHeader header = parseHeader(isPacked ? unpacked : source.bytes, source.path);
  const std::uint64_t available = source.bytes.size() * (isPacked ? kBestDeflate : 1);
  StoredArray array;
  const auto* type = std::find_if(std::begin(kNiftiTypes), std::end(kNiftiTypes),
                                  [&](const NiftiType& t) { return t.code == header.type; });
  if (type == std::end(kNiftiTypes))
    throw Error(Status::Invalid, source.path,
                "its type of numbers, " + std::to_string(header.type) + ", is not read",
                "convert it to float32");
  if (header.size[0] < 1 || header.size[0] > 7)
    throw Error(Status::Invalid, source.path, "has no number of axes from 1 to 7", kCut);
  std::uint64_t frames = 1;
  array.size = {1, 1, 1};
  for (std::size_t k = 1; k <= static_cast<std::size_t>(header.size[0]); ++k) {
    const auto size = static_cast<std::uint64_t>(std::max<std::int64_t>(header.size[k], 1));
    if (k <= 3)
      array.size[k - 1] = size;
    else if (size > available / frames)
      throw Error(Status::Invalid, source.path, "more voxels are declared than the file holds",
                  kCut);
    else
      frames *= size;
  }
  if (!(header.offset >= 0 && header.offset <= static_cast<double>(available)))
    throw Error(Status::Invalid, source.path, "its numbers begin beyond its end", kCut);
  if (frames > 1 && type->components > 1)
    throw Error(Status::Invalid, source.path,
                "holds " + std::to_string(frames) + " volumes of colours", "save one of them");
  array.element = type->element;
  array.swap = header.swap;
  array.components = type->components;
  array.setSteps(kXFastest);
  const std::uint64_t sizes[] = {array.size[0], array.size[1], array.size[2], type->components,
                                 frames};
  const auto offset = static_cast<std::uint64_t>(header.offset);
  const std::uint64_t needed = requireBytes(source.path, available - std::min(offset, available),
                                            bytesOf(array.element), sizes);
  if (isPacked) {
    unpacked = gunzip(source.bytes, static_cast<std::size_t>(offset + needed), source.path);
    progress.check();
  }
  const std::string_view bytes = isPacked ? unpacked : source.bytes;
  if (bytes.size() < offset + needed)
    throw Error(Status::Invalid, source.path, "ends before its last voxel", kCut);
  array.bytes = bytes.substr(static_cast<std::size_t>(offset));
  if (frames > 1) {
    array.components = frames;
    array.componentStep = array.size[0] * array.size[1] * array.size[2];
    array.separate = header.size[0] < 5 || header.size[4] > 1; // [5]: components of vectors
  }
  if (header.slope != 0 && std::isfinite(header.slope) && std::isfinite(header.intercept)) {
    array.slope = header.slope;
    array.intercept = header.intercept;
  }
  array.transform = transformOf(header);
  array.placed = true;
  sink.array(array);
}

} // namespace tetvdb
