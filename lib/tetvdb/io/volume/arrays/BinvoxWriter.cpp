// SPDX-License-Identifier: Apache-2.0
//
// Format: "BINVOX voxel file format specification" (P. Min): x slowest, then z, y fastest; runs of
// at most 255 equal bytes. Readers assume that the three dimensions are equal.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tetvdb {
namespace {

// Runs of equal bytes.
class RunWriter {
public:
  explicit RunWriter(AtomicFile& file) : file_(file) {}

  void write(const char* bytes, std::size_t size) {
    for (std::size_t i = 0; i < size;) {
      const char* end =
          std::find_if(bytes + i, bytes + size, [&](char byte) { return byte != bytes[i]; });
      const auto length = static_cast<std::uint64_t>(end - (bytes + i));
      add(bytes[i], length);
      i += static_cast<std::size_t>(length);
    }
  }
  void add(char value, std::uint64_t length) {
    if (value != value_) {
      finish();
      value_ = value;
    }
    length_ += length;
  }
  void finish() {
    constexpr std::uint64_t kLongest = 255;
    for (; length_ > 0; length_ -= std::min(length_, kLongest)) {
      const char run[2] = {value_, static_cast<char>(std::min(length_, kLongest))};
      file_.write(run, sizeof run);
    }
  }

private:
  AtomicFile& file_;
  char value_ = 0;
  std::uint64_t length_ = 0;
};

} // namespace

void writeBinvox(const ArrayContent& content, Progress& progress) {
  content.requireOneGrid("a .binvox file");
  content.requireAxisAligned("a .binvox file");
  const DenseGrid& grid = *content.grids.front();
  if (!grid.isBits())
    throw Error(Status::Usage, content.path,
                fmt::format("a .binvox file holds a mask, and '{}' is none", content.names.front()),
                "choose a mask with `grid`, or write .npz, .vti, .nrrd or .raw");
  const Vec3d h = content.voxelSize();
  if (h[0] != h[1] || h[1] != h[2])
    throw Error(Status::Usage, content.path, "a .binvox file has cubic voxels",
                "make the volume with one `voxel_size`, or write .npz, .vti or .nrrd");
  const VoxelBox& box = content.box;
  const std::uint64_t side = std::max({box.size(0), box.size(1), box.size(2)});

  AtomicFile file(content.path);
  const Vec3d corner = content.worldOf({box.low[0] - 0.5, box.low[1] - 0.5, box.low[2] - 0.5});
  const std::string header =
      fmt::format("#binvox 1\ndim {0} {0} {0}\ntranslate {1} {2} {3}\nscale {4}\ndata\n", side,
                  corner[0], corner[1], corner[2], h[0] * static_cast<double>(side));
  file.write(header.data(), header.size());

  // The box is filled up to a cube beyond its high sides.
  RunWriter runs(file);
  const std::uint64_t rows = box.size(2), row = box.size(1);
  std::uint64_t done = 0; // rows
  ArrayStream(content, progress).send(grid, kYFastest, [&](const char* bytes, std::size_t size) {
    for (std::size_t at = 0; at < size; at += static_cast<std::size_t>(row)) {
      runs.write(bytes + at, static_cast<std::size_t>(row));
      runs.add(0, side - row);
      if (++done % rows == 0)
        runs.add(0, (side - rows) * side);
    }
  });
  runs.add(0, (side - box.size(0)) * side * side);
  runs.finish();
  file.commit();
}

} // namespace tetvdb
