// SPDX-License-Identifier: Apache-2.0
//
// A stack of pages, one a plane z; with several channels, one a plane and channel. Format: "TIFF
// Revision 6.0" and "BigTIFF", in strips or tiles; the description is ImageJ's.
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/TiffCodec.h"
#include "tetvdb/io/volume/arrays/TiffTags.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>
#include <tbb/parallel_for.h>
#include <vector>

namespace tetvdb {
namespace {

using namespace tiff;

// Numbers of a directory's entry.
struct Entry {
  std::uint16_t type = 0;
  std::uint64_t count = 0, at = 0; ///< at: of the values
};

// What pages must share.
struct PageLayout {
  std::uint64_t width = 0, height = 0, bits = 0, format = 1, samples = 1;
  std::uint64_t compression = 1, predictor = 1;
  std::uint64_t partWidth = 0, partHeight = 0; ///< of a strip or tile

  bool operator==(const PageLayout& o) const {
    return width == o.width && height == o.height && bits == o.bits && format == o.format &&
           samples == o.samples;
  }
  std::uint64_t across() const { return (width + partWidth - 1) / partWidth; }
  std::uint64_t parts() const { return across() * ((height + partHeight - 1) / partHeight); }
};

struct Page {
  PageLayout layout;
  std::vector<std::uint64_t> offsets, bytes; ///< of strips or tiles
};

// A value of ImageJ's description: "spacing=0.5".
double described(std::string_view text, std::string_view key, double missing) {
  for (std::size_t at = 0; (at = text.find(key, at)) != text.npos; at += key.size()) {
    if (at > 0 && text[at - 1] != '\n')
      continue;
    const char* begin = text.data() + at + key.size();
    double value = missing;
    std::from_chars(begin, text.data() + text.size(), value);
    return value;
  }
  return missing;
}

class TiffInput {
public:
  explicit TiffInput(const Source& source)
      : path_(source.path), bytes_(source.bytes), in_(source, source.bytes[0] == 'M') {
    in_.seek(2);
    big_ = in_.get<std::uint16_t>() == 43;
    in_.seek(big_ ? 8 : 4);
    // A loop of directories has more of them than the file has room for.
    std::uint64_t left = bytes_.size() / 14 + 1;
    for (std::uint64_t at = offset(); at != 0; at = offset(), --left) {
      if (left == 0)
        fail("its pages never end");
      readDirectory(at);
    }
    if (pages_.empty())
      fail("has no page");
    std::uint64_t packed = 0;
    for (const Page& page : pages_) {
      if (!(page.layout == pages_.front().layout))
        throw Error(Status::Invalid, path_, "its pages differ in size or type",
                    "save the pages of one stack");
      for (const std::uint64_t size : page.bytes) {
        if (size > bytes_.size() - packed)
          fail("its pages overlap, or end beyond the file");
        packed += size;
      }
    }
    addContiguousPages();
  }

  const std::vector<Page>& pages() const { return pages_; }
  bool swap() const { return in_.swap(); }
  std::string_view description() const { return description_; }

  ElementType elementOf(const PageLayout& layout) const {
    constexpr std::uint64_t kUnsigned = 1, kSigned = 2, kFloat = 3;
    for (const ElementType element : kElementTypes) {
      const bool isSigned = namesOf(element).plain[0] == 'i';
      const std::uint64_t format = isFloat(element) ? kFloat : isSigned ? kSigned : kUnsigned;
      if (8 * bytesOf(element) == layout.bits && format == layout.format)
        return element;
    }
    throw Error(Status::Invalid, path_,
                "numbers of " + std::to_string(layout.bits) + " bits are not read",
                "save it with 8, 16 or 32 bits");
  }

  // Pixels a unit of length, and the distance of pages: of ImageJ, whose unit is in the text.
  void setSize(StoredArray& array) const {
    if (description_.substr(0, 6) != "ImageJ")
      return;
    const double x = resolution_[0] > 0 ? 1 / resolution_[0] : 1;
    const double y = resolution_[1] > 0 ? 1 / resolution_[1] : x;
    const double z = described(description_, "spacing=", x);
    array.placed = true;
    array.transform[0] = x;
    array.transform[5] = y;
    array.transform[10] = z > 0 ? z : x;
  }

  void readPage(const Page& page, ElementType element, char* out) const {
    const PageLayout& layout = page.layout;
    const std::size_t pixel = bytesOf(element) * static_cast<std::size_t>(layout.samples);
    const std::size_t row = static_cast<std::size_t>(layout.width) * pixel;
    const std::size_t partRow = static_cast<std::size_t>(layout.partWidth) * pixel;
    const bool isTiled = layout.partWidth != layout.width;
    for (std::size_t i = 0; i < page.offsets.size(); ++i) {
      const std::uint64_t x = i % layout.across() * layout.partWidth;
      const std::uint64_t y = i / layout.across() * layout.partHeight;
      const std::uint64_t rows = std::min(layout.partHeight, layout.height - y);
      const std::uint64_t stored = isTiled ? layout.partHeight : rows; // a last strip is shorter
      std::string part =
          decompress(bytes_.substr(static_cast<std::size_t>(page.offsets[i]),
                                   static_cast<std::size_t>(page.bytes[i])),
                     layout.compression, partRow * static_cast<std::size_t>(stored), path_);
      if (layout.predictor == 2)
        for (std::uint64_t r = 0; r < stored; ++r)
          addDifferences(element, layout.samples, layout.partWidth, part.data() + r * partRow);
      const std::size_t used =
          static_cast<std::size_t>(std::min(layout.partWidth, layout.width - x)) * pixel;
      for (std::uint64_t r = 0; r < rows; ++r)
        std::memcpy(out + (y + r) * row + x * pixel, part.data() + r * partRow, used);
    }
  }

private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(Status::Invalid, path_, what, kCut);
  }

  std::uint64_t offset() { return big_ ? in_.get<std::uint64_t>() : in_.get<std::uint32_t>(); }

  void readDirectory(std::uint64_t at) {
    in_.seek(at);
    const std::uint64_t count = big_ ? in_.get<std::uint64_t>() : in_.get<std::uint16_t>();
    in_.checkCount(count, big_ ? 20 : 12, "tags");
    std::map<std::uint16_t, Entry> entries;
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto tag = in_.get<std::uint16_t>();
      Entry entry;
      entry.type = in_.get<std::uint16_t>();
      entry.count = offset();
      const std::size_t place = in_.position();
      const std::uint64_t size = sizeOf(Type(entry.type));
      const bool isHere = size != 0 && entry.count <= (big_ ? 8 : 4) / size;
      entry.at = isHere ? place : offset();
      in_.seek(place + (big_ ? 8 : 4));
      entries[tag] = entry;
    }
    const std::size_t next = in_.position();
    const bool isSmaller = (number(entries, kSubfileType, 0) & 1) != 0; // of another page
    if (!isSmaller || pages_.empty())
      addPage(entries);
    in_.seek(next);
  }

  // The numbers of an entry; empty if there is none.
  std::vector<std::uint64_t> numbers(const std::map<std::uint16_t, Entry>& entries, Tag tag) {
    const auto found = entries.find(tag);
    if (found == entries.end())
      return {};
    const Entry& entry = found->second;
    in_.seek(entry.at);
    const std::size_t size = std::max<std::size_t>(sizeOf(Type(entry.type)), 1);
    std::vector<std::uint64_t> all(in_.checkCount(entry.count, size, "values"));
    for (std::uint64_t& value : all)
      value = entry.type == kShort   ? in_.get<std::uint16_t>()
              : entry.type == kLong  ? in_.get<std::uint32_t>()
              : entry.type == kLong8 ? in_.get<std::uint64_t>()
                                     : in_.get<std::uint8_t>();
    return all;
  }
  std::uint64_t number(const std::map<std::uint16_t, Entry>& entries, Tag tag,
                       std::uint64_t missing) {
    const std::vector<std::uint64_t> all = numbers(entries, tag);
    return all.empty() ? missing : all.front();
  }
  double fraction(const std::map<std::uint16_t, Entry>& entries, Tag tag) {
    const auto found = entries.find(tag);
    if (found == entries.end() || found->second.type != kRational)
      return 0;
    in_.seek(found->second.at);
    const double over = in_.get<std::uint32_t>(), under = in_.get<std::uint32_t>();
    return under > 0 ? over / under : 0;
  }

  void addPage(const std::map<std::uint16_t, Entry>& entries) {
    Page page;
    PageLayout& layout = page.layout;
    layout.width = number(entries, kImageWidth, 0);
    layout.height = number(entries, kImageLength, 0);
    layout.samples = number(entries, kSamplesPerPixel, 1);
    layout.bits = number(entries, kBitsPerSample, 1);
    layout.format = number(entries, kSampleFormat, 1);
    layout.compression = number(entries, kCompression, 1);
    layout.predictor = number(entries, kPredictor, 1);
    const bool isTiled = entries.count(kTileOffsets) != 0;
    layout.partWidth = isTiled ? number(entries, kTileWidth, 0) : layout.width;
    layout.partHeight =
        isTiled ? number(entries, kTileLength, 0)
                : std::min(number(entries, kRowsPerStrip, layout.height), layout.height);
    page.offsets = numbers(entries, isTiled ? kTileOffsets : kStripOffsets);
    page.bytes = numbers(entries, isTiled ? kTileByteCounts : kStripByteCounts);
    check(page, number(entries, kPlanarConfiguration, 1));
    if (pages_.empty()) {
      if (const auto text = entries.find(kImageDescription); text != entries.end()) {
        in_.seek(text->second.at);
        description_ = in_.take(in_.checkCount(text->second.count, 1, "characters"));
      }
      resolution_ = {fraction(entries, kXResolution), fraction(entries, kYResolution)};
    }
    pages_.push_back(std::move(page));
  }

  void check(const Page& page, std::uint64_t planar) const {
    const PageLayout& layout = page.layout;
    constexpr std::uint64_t kLargest = 1U << 30;
    if (layout.width == 0 || layout.height == 0 || layout.width > kLargest ||
        layout.height > kLargest || layout.partWidth == 0 || layout.partHeight == 0 ||
        layout.partWidth > kLargest || layout.partHeight > kLargest)
      fail("a page has no size");
    if (layout.samples == 0 || layout.samples > 16 || (planar != 1 && layout.samples > 1))
      throw Error(Status::Invalid, path_, "has channels that are not read", "save one of them");
    const std::uint64_t ratio = largestRatio(layout.compression);
    if (ratio == 0 || layout.predictor > 2)
      throw Error(Status::Invalid, path_, "is compressed in a way that is not read",
                  "save it without compression, or with LZW or deflate");
    elementOf(layout);
    if (page.offsets.size() != layout.parts() || page.bytes.size() != layout.parts())
      fail("a page lacks strips or tiles");
    std::uint64_t packed = 0;
    for (std::size_t i = 0; i < page.offsets.size(); ++i) {
      if (page.offsets[i] > bytes_.size() || page.bytes[i] > bytes_.size() - page.offsets[i])
        fail("a page ends beyond the file");
      packed += page.bytes[i];
    }
    // Tiles reach beyond a page's sides, strips do not.
    const bool isTiled = layout.partWidth != layout.width;
    const std::uint64_t sizes[] = {layout.partWidth,
                                   isTiled ? layout.partHeight * layout.parts() : layout.height,
                                   layout.samples};
    requireBytes(path_, packed * ratio, layout.bits / 8, sizes);
  }

  // ImageJ's stacks of over 4 GB have a directory for the first page alone.
  void addContiguousPages() {
    const double images = described(description_, "images=", 1);
    const PageLayout& layout = pages_.front().layout;
    if (pages_.size() != 1 || !(images > 1) || layout.compression != kNone || layout.parts() != 1)
      return;
    const std::uint64_t first = pages_.front().offsets.front(), size = pages_.front().bytes.front();
    const std::uint64_t there = (bytes_.size() - first) / std::max<std::uint64_t>(size, 1);
    if (images > static_cast<double>(there))
      fail("has fewer pages than its description says");
    for (std::uint64_t i = 1; i < static_cast<std::uint64_t>(images); ++i) {
      Page page = pages_.front();
      page.offsets.front() = first + i * size;
      pages_.push_back(std::move(page));
    }
  }

  // Section 14: each sample is stored as the difference to that of the pixel before.
  void addDifferences(ElementType element, std::uint64_t samples, std::uint64_t width,
                      char* row) const {
    switch (bytesOf(element)) {
    case 1:
      return sum<std::uint8_t>(samples, width, row);
    case 2:
      return sum<std::uint16_t>(samples, width, row);
    case 4:
      return sum<std::uint32_t>(samples, width, row);
    default:
      return sum<std::uint64_t>(samples, width, row);
    }
  }
  template <typename Number>
  void sum(std::uint64_t samples, std::uint64_t width, char* row) const {
    for (std::uint64_t i = samples; i < samples * width; ++i) {
      char* at = row + i * sizeof(Number);
      const auto before = loadNumber<Number>(at - samples * sizeof(Number), in_.swap());
      auto value = static_cast<Number>(loadNumber<Number>(at, in_.swap()) + before);
      value = in_.swap() ? byteSwapped(value) : value;
      std::memcpy(at, &value, sizeof value);
    }
  }

  std::string path_;
  std::string_view bytes_;
  ByteReader in_;
  bool big_ = false;
  std::vector<Page> pages_;
  std::string_view description_;
  std::array<double, 2> resolution_{};
};

} // namespace

void readTiffs(const std::vector<Source>& sources, const ArraySink& sink, Progress& progress) {
  std::vector<TiffInput> files;
  files.reserve(sources.size());
  struct Place {
    const TiffInput* file;
    const Page* page;
  };
  std::vector<Place> pages;
  for (const Source& source : sources) {
    progress.check();
    const TiffInput& file = files.emplace_back(source);
    if (!(file.pages().front().layout == files.front().pages().front().layout) ||
        file.swap() != files.front().swap())
      throw Error(Status::Invalid, source.path,
                  "its pages are not like those of '" + sources.front().path + "'",
                  "name the pages of one stack");
    for (const Page& page : file.pages())
      pages.push_back({&file, &page});
  }
  const TiffInput& first = files.front();
  const PageLayout& layout = first.pages().front().layout;
  StoredArray array;
  array.element = first.elementOf(layout);
  array.swap = first.swap();
  const auto channels = static_cast<std::uint64_t>(
      std::clamp(described(first.description(), "channels=", 1), 1.0, 1e6));
  const bool hasChannels = layout.samples == 1 && channels > 1 && pages.size() % channels == 0;
  array.components = hasChannels ? channels : layout.samples;
  array.size = {layout.width, layout.height, pages.size() / (hasChannels ? channels : 1)};
  const std::uint64_t page = layout.width * layout.height * layout.samples;
  array.step = {layout.samples, layout.width * layout.samples, page * (hasChannels ? channels : 1)};
  array.componentStep = hasChannels ? page : 1;
  first.setSize(array);

  const std::size_t pageBytes = static_cast<std::size_t>(page) * bytesOf(array.element);
  std::string bytes(pageBytes * pages.size(), '\0');
  tbb::parallel_for(std::size_t(0), pages.size(), [&](std::size_t i) {
    progress.check();
    pages[i].file->readPage(*pages[i].page, array.element, bytes.data() + i * pageBytes);
  });
  array.bytes = bytes;
  sink.array(array);
}

void readTiff(const Source& source, const ArraySink& sink, Progress& progress) {
  readTiffs({source}, sink, progress);
}

} // namespace tetvdb
