// SPDX-License-Identifier: Apache-2.0
//
// Without libpng, which writes the program's pictures but requires whole rows of pixels.
#include "tetvdb/print/LayerPng.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/print/RunDeflate.h"

#include <string_view>
#include <zlib.h>

namespace tetvdb {
namespace {

std::string bigEndian(std::uint64_t number) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8)
    text += static_cast<char>(number >> shift & 0xff);
  return text;
}

void addChunk(std::string_view kind, std::string_view data, std::string& file) {
  file += bigEndian(data.size());
  const std::size_t begin = file.size();
  (file += kind) += data;
  const auto* bytes = reinterpret_cast<const Bytef*>(file.data()) + begin;
  file += bigEndian(crc32(0, bytes, static_cast<uInt>(file.size() - begin)));
}

} // namespace

std::string encodeLayerPng(const Layer& layer, std::int32_t width, std::int32_t height,
                           const std::vector<PngColor>& palette) {
  constexpr std::uint8_t kUnfiltered = 0;
  RunDeflate pixels;
  const std::uint64_t rowBytes = static_cast<std::uint64_t>(width) + 1;
  std::int32_t next = 0; // row
  for (std::size_t i = 0; i < layer.rows.size(); ++i) {
    const std::int32_t y = layer.rows[i].y;
    pixels.add(0, rowBytes * static_cast<std::uint64_t>(y - next));
    pixels.add(kUnfiltered, 1);
    std::int32_t x = 0;
    const auto [begin, end] = layer.runsOf(i);
    for (const PixelRun* run = begin; run != end; ++run) {
      pixels.add(0, static_cast<std::uint64_t>(run->begin - x));
      pixels.add(run->value, static_cast<std::uint64_t>(run->end - run->begin));
      x = run->end;
    }
    pixels.add(0, static_cast<std::uint64_t>(width - x));
    next = y + 1;
  }
  pixels.add(0, rowBytes * static_cast<std::uint64_t>(height - next));
  const std::string packed = pixels.finish();
  if (packed.size() >= 0x7fffffff)
    throw Error(Status::Limit, "", "a layer packed as PNG takes 2 GiB or more");

  std::string file = "\x89PNG\r\n\x1a\n";
  file.reserve(packed.size() + 128 + 3 * palette.size());
  std::string head =
      bigEndian(static_cast<std::uint64_t>(width)) + bigEndian(static_cast<std::uint64_t>(height));
  const bool indexed = !palette.empty();
  for (const int byte : {8, indexed ? 3 : 0, 0, 0, 0}) // depth, colour, deflate, filter, interlace
    head += static_cast<char>(byte);
  addChunk("IHDR", head, file);
  if (indexed) {
    std::string colors;
    for (const PngColor& color : palette)
      for (const std::uint8_t channel : color)
        colors += static_cast<char>(channel);
    addChunk("PLTE", colors, file);
  }
  addChunk("IDAT", packed, file);
  addChunk("IEND", {}, file);
  return file;
}

} // namespace tetvdb
