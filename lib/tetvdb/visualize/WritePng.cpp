// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/WritePng.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"

#include <cstdint>
#include <png.h>
#include <vector>

namespace tetvdb {
namespace {

constexpr int kMaxSide = 1000000; // libpng's own limit unless it is raised

} // namespace

// libpng's simplified interface: its errors are values, those of the full one leave by longjmp over
// destructors.
std::string encodePng(const Image& image) {
  if (image.width < 1 || image.height < 1 || image.width > kMaxSide || image.height > kMaxSide)
    throw Error(Status::Limit, "",
                "a picture of " + std::to_string(image.width) + " x " +
                    std::to_string(image.height) + " pixels cannot become a PNG file");
  const bool withAlpha = !image.isOpaque();
  const std::vector<std::uint8_t> bytes = srgbBytes(image, withAlpha);

  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = withAlpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string file(size, '\0');
  if (png_image_write_to_memory(&png, file.data(), &size, 0, bytes.data(), 0, nullptr) == 0)
    throw Error(Status::Limit, "",
                std::string("the picture cannot become a PNG file: ") + png.message);
  file.resize(size);
  return file;
}

void writePng(const std::string& path, const Image& image) {
  const std::string bytes = encodePng(image);
  AtomicFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

} // namespace tetvdb
