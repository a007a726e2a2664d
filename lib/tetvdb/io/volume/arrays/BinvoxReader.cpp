// SPDX-License-Identifier: Apache-2.0
//
// Format: "BINVOX voxel file format specification" (P. Min): x slowest, then z, y fastest; runs of
// at most 255 equal bytes.
#include "tetvdb/io/text/NumberParser.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {

void readBinvox(const Source& source, const ArraySink& sink, Progress& progress) {
  constexpr std::uint64_t kLongestRun = 255, kRunBytes = 2;
  StoredArray array;
  array.name = "mask";
  array.element = ElementType::UInt8;
  array.isBits = true;
  Vec3d corner{0, 0, 0};
  double scale = 0;
  NumberParser in(source);
  in.line(); // "#binvox 1"
  for (;;) {
    const std::string_view word = in.word();
    if (word == "dim") {
      for (const std::size_t k : {0u, 2u, 1u}) // depth, height, width
        array.size[k] = static_cast<std::uint64_t>(std::max<std::int64_t>(in.integer(), 0));
    } else if (word == "translate") {
      corner = {in.real(), in.real(), in.real()};
    } else if (word == "scale") {
      scale = in.real();
    } else if (word == "data") {
      in.line();
      break;
    } else {
      in.fail("the header ends without 'data'", kCut);
    }
  }
  const std::string_view runs = source.bytes.substr(in.position());
  std::string bytes;
  const std::uint64_t voxels =
      requireBytes(source.path, runs.size() / kRunBytes * kLongestRun, 1, array.size);
  bytes.reserve(static_cast<std::size_t>(voxels));
  for (std::size_t i = 0; i + 1 < runs.size() && bytes.size() < voxels; i += kRunBytes)
    bytes.append(
        std::min<std::uint64_t>(static_cast<unsigned char>(runs[i + 1]), voxels - bytes.size()),
        runs[i] != 0 ? '\1' : '\0');
  if (bytes.size() < voxels)
    throw Error(Status::Invalid, source.path, "the runs of voxels end early", kCut);
  progress.check();
  array.bytes = bytes;
  array.setSteps(kYFastest);

  // Its grid has no origin: the nearest one at a multiple of the voxel's size.
  const auto side = static_cast<double>(*std::max_element(array.size.begin(), array.size.end()));
  if (scale > 0 && side > 0) {
    const double h = scale / side;
    array.placed = true;
    for (std::size_t k = 0; k < 3; ++k) {
      constexpr double kRounding = 1e-4; // voxels: programs write six digits
      const double first = corner[k] / h + 0.5, nearest = std::round(first);
      const bool isWhole = std::abs(first - nearest) < kRounding && std::abs(nearest) < 1 << 30;
      array.low[k] = isWhole ? static_cast<std::int32_t>(nearest) : 0;
      array.transform[5 * k] = h;
      array.transform[4 * k + 3] = isWhole ? 0 : corner[k] + h / 2;
    }
  }
  sink.array(array);
}

} // namespace tetvdb
