// SPDX-License-Identifier: Apache-2.0
//
// Format: "TIFF Revision 6.0", bilevel images, and "TIFF Technical Note 2" for deflate. Pages are
// packed from runs of equal bytes.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/print/LayerBits.h"
#include "tetvdb/print/LayerFile.h"
#include "tetvdb/print/LittleEndian.h"
#include "tetvdb/print/RunDeflate.h"

#include <algorithm>
#include <cmath>

namespace tetvdb {
namespace {

constexpr std::uint64_t kMaxBytes = 0xffffffff;

class TiffStackWriter : public LayerWriter {
public:
  explicit TiffStackWriter(const PrintInfo& info) : info_(info), file_(info.path) {
    const std::string head = std::string("II\x2a\0", 4) + littleEndianBytes(0, 4);
    file_.write(head.data(), head.size());
  }

  EncodedLayer encode(std::int32_t, const Layer& layer) const override {
    const std::size_t rowBytes = (static_cast<std::size_t>(info_.frame.width) + 7) / 8;
    RunDeflate page;
    std::string row(rowBytes, '\0');
    std::int32_t next = 0;
    for (std::size_t i = 0; i < layer.rows.size(); ++i) {
      const std::int32_t y = layer.rows[i].y;
      page.add(0, rowBytes * static_cast<std::uint64_t>(y - next));
      std::fill(row.begin(), row.end(), '\0');
      setRowBits(layer, i, row.data());
      for (const char byte : row)
        page.add(static_cast<std::uint8_t>(byte), 1);
      next = y + 1;
    }
    page.add(0, rowBytes * static_cast<std::uint64_t>(info_.frame.height - next));
    return {page.finish(), "", layer.filled, layer.overlap, layer.empty()};
  }

  void add(std::int32_t, const EncodedLayer& layer) override {
    const std::uint64_t pixels = file_.size();
    std::string bytes = layer.bytes;
    if (bytes.size() % 2 != 0)
      bytes += '\0';
    const std::uint64_t resolutions = pixels + bytes.size();
    bytes += perCentimetre(info_.frame.pixelWidth) + perCentimetre(info_.frame.pixelHeight);
    const std::uint64_t directory = pixels + bytes.size();
    bytes += directoryOf(pixels, layer.bytes.size(), resolutions);
    if (pixels + bytes.size() > kMaxBytes)
      throw Error(Status::Limit, info_.path, "a .tif file has at most 4 GiB",
                  "write a folder with `format=png`");
    file_.write(bytes.data(), bytes.size());
    const std::string link = littleEndianBytes(directory, 4);
    file_.writeAt(link_, link.data(), link.size());
    link_ = file_.size() - 4;
  }

  void finish() override {
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

private:
  static std::string perCentimetre(double millimetres) {
    constexpr double kParts = 10000;
    return littleEndianBytes(static_cast<std::uint64_t>(std::llround(10 / millimetres * kParts)),
                             4) +
           littleEndianBytes(static_cast<std::uint64_t>(kParts), 4);
  }

  std::string directoryOf(std::uint64_t pixels, std::uint64_t size,
                          std::uint64_t resolutions) const {
    constexpr int kShort = 3, kLong = 4, kRational = 5;
    const auto height = static_cast<std::uint64_t>(info_.frame.height);
    std::string entries;
    std::uint64_t count = 0;
    const auto add = [&](std::uint64_t tag, int type, std::uint64_t value) {
      entries += littleEndianBytes(tag, 2) +
                 littleEndianBytes(static_cast<std::uint64_t>(type), 2) + littleEndianBytes(1, 4) +
                 littleEndianBytes(value, 4);
      ++count;
    };
    add(256, kLong, static_cast<std::uint64_t>(info_.frame.width));
    add(257, kLong, height);
    add(258, kShort, 1);              // bits a sample
    add(259, kShort, 8);              // deflate
    add(262, kShort, 1);              // 0 is black
    add(273, kLong, pixels);          // the only strip
    add(277, kShort, 1);              // samples a pixel
    add(278, kLong, height);          // rows a strip
    add(279, kLong, size);            // bytes of the strip
    add(282, kRational, resolutions); // along x
    add(283, kRational, resolutions + 8);
    add(296, kShort, 3); // in centimetres
    return littleEndianBytes(count, 2) + entries + littleEndianBytes(0, 4);
  }

  const PrintInfo info_;
  AtomicFile file_;
  std::uint64_t link_ = 4, bytes_ = 0;
};

} // namespace

std::unique_ptr<LayerWriter> writeTiffStack(const PrintInfo& info) {
  return std::make_unique<TiffStackWriter>(info);
}

} // namespace tetvdb
