// SPDX-License-Identifier: Apache-2.0
//
// Format: Elegoo's public description of GOO 3.0, all numbers big-endian. The checksum of a layer
// is the complement of the sum of its runs' bytes, as UVtools demands.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/print/LayerFile.h"
#include "tetvdb/print/ZipLayers.h"

#include <cstring>

namespace tetvdb {
namespace {

constexpr std::string_view kMagic("\x07\0\0\0DLP\0", 8);
constexpr std::string_view kLineEnd = "\r\n";
constexpr std::size_t kHeaderBytes = 195477;
constexpr int kFullLight = 255;

class BigEndian {
public:
  BigEndian& integer(std::uint64_t number, int bytes) {
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8)
      text_ += static_cast<char>(number >> shift & 0xff);
    return *this;
  }
  BigEndian& real(double number) {
    const auto value = static_cast<float>(number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return integer(bits, 4);
  }
  BigEndian& text(std::string_view words, std::size_t size) {
    text_ += words.substr(0, size - 1);
    text_.append(size - std::min(words.size(), size - 1), '\0');
    return *this;
  }
  BigEndian& raw(std::string_view bytes) {
    text_ += bytes;
    return *this;
  }
  const std::string& get() const { return text_; }

private:
  std::string text_;
};

// Runs of pixels: type and number of length bytes, the lowest four bits of the length; then the
// grey level, then the other bytes of the length, the highest first.
class GooRuns {
public:
  void add(std::uint8_t value, std::uint64_t count) {
    constexpr std::uint64_t kLongest = 0xfffffff;
    for (; count > kLongest; count -= kLongest)
      addRun(value, kLongest);
    if (count > 0)
      addRun(value, count);
  }
  const std::string& get() const { return bytes_; }

private:
  void addRun(std::uint8_t value, std::uint64_t count) {
    const unsigned kind = value == 0 ? 0 : value == 255 ? 3 : 1;
    unsigned more = 0;
    while (count >> (4 + 8 * more) != 0)
      ++more;
    bytes_ += static_cast<char>(kind << 6 | more << 4 | (count & 15));
    if (kind == 1)
      bytes_ += static_cast<char>(value);
    for (unsigned i = more; i-- > 0;)
      bytes_ += static_cast<char>(count >> (4 + 8 * i) & 0xff);
  }

  std::string bytes_;
};

class GooWriter : public LayerWriter {
public:
  explicit GooWriter(const PrintInfo& info) : info_(info), file_(info.path) {
    if (info.frame.width > 0xffff || info.frame.height > 0xffff)
      throw Error(Status::Limit, info.path, "a .goo file has at most 65535 pixels a side");
    const std::string empty(kHeaderBytes, '\0');
    file_.write(empty.data(), empty.size());
  }

  EncodedLayer encode(std::int32_t k, const Layer& layer) const override {
    const LayerFrame& frame = info_.frame;
    const auto width = static_cast<std::uint64_t>(frame.width);
    GooRuns runs;
    std::uint64_t blank = 0, at = 0; // pixels
    std::uint8_t value = 0;
    const auto add = [&](std::uint8_t next, std::uint64_t count) {
      if (next != value) {
        runs.add(value, blank);
        value = next;
        blank = 0;
      }
      blank += count;
    };
    for (std::size_t i = 0; i < layer.rows.size(); ++i) {
      const auto [begin, end] = layer.runsOf(i);
      const std::uint64_t row = static_cast<std::uint64_t>(layer.rows[i].y) * width;
      for (const PixelRun* run = begin; run != end; ++run) {
        const std::uint64_t first = row + static_cast<std::uint64_t>(run->begin);
        if (first > at)
          add(0, first - at);
        at = row + static_cast<std::uint64_t>(run->end);
        add(run->value, at - first);
      }
    }
    const std::uint64_t all = width * static_cast<std::uint64_t>(frame.height);
    if (all > at)
      add(0, all - at);
    runs.add(value, blank);
    return {definition(k) + data(runs.get()), "", layer.filled, layer.overlap, layer.empty()};
  }

  void add(std::int32_t k, const EncodedLayer& layer) override {
    file_.write(layer.bytes.data(), layer.bytes.size());
    filled_ += layer.filled * info_.frame.heightOf(k);
  }

  void finish() override {
    const std::string end = std::string(3, '\0') + std::string(kMagic);
    file_.write(end.data(), end.size());
    const std::string head = header();
    if (head.size() != kHeaderBytes)
      throw Error(Status::Write, info_.path, "the header has a wrong size");
    file_.writeAt(0, head.data(), head.size());
    bytes_ = file_.size();
    file_.commit();
  }
  std::uint64_t bytes() const override { return bytes_; }

private:
  struct Lift {
    double height, speed;
  };
  Lift liftOf(bool bottom) const {
    const PrinterSettings& p = info_.printer;
    return bottom ? Lift{p.bottomLiftHeight, p.bottomLiftSpeed} : Lift{p.liftHeight, p.liftSpeed};
  }

  std::string definition(std::int32_t k) const {
    const PrinterSettings& printer = info_.printer;
    const Lift lift = liftOf(k < printer.bottomLayers);
    BigEndian out;
    out.integer(0, 2).real(0); // no pause
    out.real(info_.frame.bottomOf(k + 1)).real(printer.exposureOf(k)).real(printer.lightOffDelay);
    out.real(0).real(0).real(0); // waits
    out.real(lift.height).real(lift.speed).real(0).real(0);
    out.real(lift.height).real(printer.retractSpeed).real(0).real(0);
    out.integer(kFullLight, 2).raw(kLineEnd);
    return out.get();
  }

  static std::string data(const std::string& runs) {
    unsigned sum = 0;
    for (const char byte : runs)
      sum += static_cast<unsigned char>(byte);
    BigEndian out;
    out.integer(runs.size() + 2, 4).integer(0x55, 1).raw(runs).integer(~sum & 0xff, 1);
    out.raw(kLineEnd);
    return out.get();
  }

  std::string header() const {
    const PrinterSettings& printer = info_.printer;
    const LayerFrame& frame = info_.frame;
    const auto flag = [](bool is) { return is ? 1u : 0u; };
    BigEndian out;
    out.raw("V3.0").raw(kMagic).text("TetVDB", 32).text(version(), 24);
    out.text("1980-01-01 00:00:00", 24).text(keyOr("printer_model", "unknown"), 32);
    out.text("resin", 32).text(keyOr("sla_print_settings_id", "default"), 32);
    out.integer(1, 2).integer(0, 2).integer(0, 2); // antialiasing, grey, blur
    for (const std::size_t side : {116u, 290u})
      out.raw(std::string(2 * side * side, '\0')).raw(kLineEnd);
    out.integer(static_cast<std::uint64_t>(frame.layers), 4);
    out.integer(static_cast<std::uint64_t>(frame.width), 2);
    out.integer(static_cast<std::uint64_t>(frame.height), 2);
    out.integer(flag(printer.mirror[0]), 1).integer(flag(printer.mirror[1]), 1);
    out.real(frame.pixelWidth * frame.width).real(frame.pixelHeight * frame.height);
    out.real(printer.maxHeight).real(frame.layerHeight).real(printer.exposure);
    out.integer(1, 1).real(printer.lightOffDelay);
    for (int wait = 0; wait < 6; ++wait)
      out.real(0);
    out.real(printer.exposureOf(0)).integer(static_cast<std::uint64_t>(printer.bottomLayers), 4);
    const Lift bottom = liftOf(true), normal = liftOf(false);
    out.real(bottom.height).real(bottom.speed).real(normal.height).real(normal.speed);
    out.real(bottom.height).real(printer.retractSpeed);
    out.real(normal.height).real(printer.retractSpeed);
    for (int second = 0; second < 8; ++second)
      out.real(0);
    out.integer(kFullLight, 2).integer(kFullLight, 2);
    out.integer(1, 1); // layers have individual settings
    out.integer(static_cast<std::uint64_t>(exposureTime(info_)), 4);
    const double volume = filled_ * frame.pixelWidth * frame.pixelHeight;
    out.real(volume).real(0).real(0).text("$", 8);
    out.integer(kHeaderBytes, 4).integer(255, 1);
    out.integer(static_cast<std::uint64_t>(printer.fadedLayers), 2);
    return out.get();
  }

  std::string keyOr(const std::string& key, const std::string& other) const {
    const auto found = info_.printer.keys.find(key);
    return found == info_.printer.keys.end() || found->second.empty() ? other : found->second;
  }

  const PrintInfo info_;
  AtomicFile file_;
  double filled_ = 0;
  std::uint64_t bytes_ = 0;
};

} // namespace

std::unique_ptr<LayerWriter> writeGoo(const PrintInfo& info) {
  return std::make_unique<GooWriter>(info);
}

} // namespace tetvdb
