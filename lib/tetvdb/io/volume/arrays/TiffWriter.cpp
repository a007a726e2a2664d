// SPDX-License-Identifier: Apache-2.0
//
// A stack of pages, one a plane z; of vectors one a plane and component, as ImageJ orders channels.
// Format: "TIFF Revision 6.0" and "BigTIFF"; ImageJ's description as its own writer makes it. The
// pixels of all pages come first, without gaps, as ImageJ expects, and then their directories.
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/text/ZlibBytes.h"
#include "tetvdb/io/volume/arrays/ArrayWriters.h"
#include "tetvdb/io/volume/arrays/TiffTags.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

using namespace tiff;

template <typename Number>
std::string littleEndian(Number number) {
  std::string text(sizeof number, '\0');
  std::memcpy(text.data(), &number, sizeof number);
  return text;
}

// The nearest fraction of 32-bit numbers, by continued fractions.
std::pair<std::uint32_t, std::uint32_t> rational(double value) {
  constexpr double kLargest = 4294967295.0;
  if (!(value < kLargest))
    return {4294967295u, 1};
  double p0 = 0, q0 = 1, p1 = 1, q1 = 0, rest = value;
  for (int i = 0; i < 64; ++i) {
    const double whole = std::floor(rest);
    const double p = whole * p1 + p0, q = whole * q1 + q0;
    if (p > kLargest || q > kLargest)
      break;
    p0 = std::exchange(p1, p);
    q0 = std::exchange(q1, q);
    if (p / q == value || rest == whole)
      break;
    rest = 1 / (rest - whole);
  }
  return {static_cast<std::uint32_t>(p1), static_cast<std::uint32_t>(std::max(q1, 1.0))};
}

int sampleFormat(ElementType element) {
  constexpr int kUnsigned = 1, kSigned = 2, kFloat = 3;
  return isFloat(element) ? kFloat : element == ElementType::UInt8 ? kUnsigned : kSigned;
}

class TiffFile {
public:
  TiffFile(const ArrayContent& content, Progress& progress)
      : content_(content), grid_(*content.grids.front()), progress_(progress), file_(content.path),
        pages_(content.box.size(2) * grid_.components()),
        pageBytes_(static_cast<std::size_t>(content.box.size(0) * content.box.size(1)) *
                   bytesOf(grid_.element())) {
    // Directories take less than 300 bytes each.
    const double room = 4294967295.0 - static_cast<double>(pages_) * 300 - 65536;
    big_ = static_cast<double>(pages_) * static_cast<double>(pageBytes_) > room;
  }

  void write() {
    const std::string head = big_ ? std::string("II\x2b\0\x08\0\0\0", 8) + std::string(8, '\0')
                                  : std::string("II\x2a\0", 4) + std::string(4, '\0');
    file_.write(head.data(), head.size());
    ArrayStream(content_, progress_)
        .send(grid_, kXFastest, [&](const char* bytes, std::size_t size) {
          const std::size_t plane = pageBytes_ * grid_.components();
          for (std::size_t at = 0; at < size; at += plane)
            addPlane(bytes + at);
        });
    writeDirectories();
    file_.commit();
  }

private:
  struct Page {
    std::uint64_t offset, bytes;
  };

  void addPlane(const char* plane) {
    const std::size_t components = grid_.components();
    if (components == 1)
      return addPage(plane);
    const std::size_t element = bytesOf(grid_.element());
    std::string page(pageBytes_, '\0');
    for (std::size_t k = 0; k < components; ++k) {
      for (std::size_t i = 0; i < pageBytes_ / element; ++i)
        std::memcpy(page.data() + i * element, plane + (i * components + k) * element, element);
      addPage(page.data());
    }
  }

  void addPage(const char* bytes) {
    const std::uint64_t offset = file_.size();
    if (content_.compress) {
      const std::string packed = zlibBytes(bytes, pageBytes_);
      file_.write(packed.data(), packed.size());
    } else {
      file_.write(bytes, pageBytes_);
    }
    written_.push_back({offset, file_.size() - offset});
  }

  // Values too long for their place in a directory go before it.
  class Directory {
  public:
    Directory(bool big, AtomicFile& file) : big_(big), file_(file) {}

    void add(Tag tag, Type type, std::uint64_t count, std::string value) {
      const std::size_t place = big_ ? 8 : 4;
      if (value.size() > place) {
        const std::uint64_t at = pad(file_);
        file_.write(value.data(), value.size());
        value = big_ ? littleEndian(at) : littleEndian(static_cast<std::uint32_t>(at));
      }
      value.resize(place, '\0');
      entries_ += littleEndian(static_cast<std::uint16_t>(tag)) +
                  littleEndian(static_cast<std::uint16_t>(type)) +
                  (big_ ? littleEndian(count) : littleEndian(static_cast<std::uint32_t>(count))) +
                  value;
      ++count_;
    }
    void number(Tag tag, Type type, std::uint64_t value) {
      add(tag, type, 1, littleEndian(value).substr(0, sizeOf(type)));
    }
    void text(Tag tag, const std::string& value) {
      add(tag, kAscii, value.size() + 1, value + '\0');
    }
    void fraction(Tag tag, double value) {
      const auto [over, under] = rational(value);
      add(tag, kRational, 1, littleEndian(over) + littleEndian(under));
    }
    // Where it starts, and where in the file its link to the next is.
    std::pair<std::uint64_t, std::uint64_t> write() {
      const std::uint64_t at = pad(file_);
      const std::string count =
          big_ ? littleEndian(count_) : littleEndian(static_cast<std::uint16_t>(count_));
      const std::string all = count + entries_ + std::string(big_ ? 8 : 4, '\0');
      file_.write(all.data(), all.size());
      return {at, file_.size() - (big_ ? 8 : 4)};
    }

  private:
    // Offsets are even.
    static std::uint64_t pad(AtomicFile& file) {
      if (file.size() % 2 != 0)
        file.write("", 1);
      return file.size();
    }

    bool big_;
    AtomicFile& file_;
    std::string entries_;
    std::uint64_t count_ = 0;
  };

  std::string description() const {
    const Vec3d h = content_.voxelSize();
    std::string text = fmt::format("ImageJ=1.53t\nimages={}\n", pages_);
    if (grid_.components() > 1)
      text += fmt::format("channels={}\n", grid_.components());
    text += fmt::format("slices={}\n", content_.box.size(2));
    if (grid_.components() > 1)
      text += "hyperstack=true\nmode=grayscale\n";
    const auto units = content_.metadata.find("units");
    std::string unit = units == content_.metadata.end() ? "" : units->second;
    std::replace_if(
        unit.begin(), unit.end(),
        [](char c) { return static_cast<unsigned char>(c) < 0x20 || (c & 0x80) != 0; }, '?');
    if (!unit.empty())
      text += "unit=" + unit + "\n";
    return text + fmt::format("spacing={}\nloop=false\n", h[2]);
  }

  void writeDirectories() {
    const Vec3d h = content_.voxelSize();
    std::uint64_t link = big_ ? 8 : 4; // where the next directory's offset goes
    for (std::size_t i = 0; i < written_.size(); ++i) {
      if (i % 256 == 0)
        progress_.check();
      const Type offset = big_ ? kLong8 : kLong;
      Directory page(big_, file_);
      page.number(kImageWidth, kLong, content_.box.size(0));
      page.number(kImageLength, kLong, content_.box.size(1));
      page.number(kBitsPerSample, kShort, 8 * bytesOf(grid_.element()));
      page.number(kCompression, kShort, content_.compress ? 8 : 1);
      page.number(kPhotometric, kShort, 1); // black is zero
      if (i == 0)
        page.text(kImageDescription, description());
      page.number(kStripOffsets, offset, written_[i].offset);
      page.number(kSamplesPerPixel, kShort, 1);
      page.number(kRowsPerStrip, kLong, content_.box.size(1));
      page.number(kStripByteCounts, offset, written_[i].bytes);
      page.fraction(kXResolution, 1 / h[0]);
      page.fraction(kYResolution, 1 / h[1]);
      page.number(kResolutionUnit, kShort, 1); // none: it is in the description
      if (i == 0)
        page.text(kSoftware, "TetVDB");
      page.number(kSampleFormat, kShort, static_cast<std::uint64_t>(sampleFormat(grid_.element())));
      const auto [at, next] = page.write();
      if (!big_ && file_.size() > 4294967295u)
        throw Error(Status::Limit, content_.path, "the pages' directories leave 4 GiB",
                    "write .npz or .nrrd");
      const std::string bytes =
          big_ ? littleEndian(at) : littleEndian(static_cast<std::uint32_t>(at));
      file_.writeAt(link, bytes.data(), bytes.size());
      link = next;
    }
  }

  const ArrayContent& content_;
  const DenseGrid& grid_;
  Progress& progress_;
  AtomicFile file_;
  std::uint64_t pages_;
  std::size_t pageBytes_;
  bool big_ = false; ///< BigTIFF
  std::vector<Page> written_;
};

} // namespace

void writeTiff(const ArrayContent& content, Progress& progress) {
  content.requireOneGrid("a .tif file");
  content.requireAxisAligned("a .tif file");
  for (std::size_t axis = 0; axis < 2; ++axis)
    if (content.box.size(axis) > 4294967295u)
      throw Error(Status::Limit, content.path, "a page is wider than TIFF allows",
                  "choose a part with `box`");
  TiffFile(content, progress).write();
}

} // namespace tetvdb
