// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuData.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <climits>
#include <cstring>
#include <lz4.h>
#include <lzma.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <vector>
#include <zlib.h>

namespace tetvdb::vtk {
namespace {

[[noreturn]] void fail(const std::string& path, std::size_t at, const std::string& what) {
  throw Error(Status::Invalid, path + " at byte " + std::to_string(at), what, kCut);
}

constexpr std::uint8_t kNoDigit = 0x80;

constexpr std::array<std::uint8_t, 256> makeDigits() {
  std::array<std::uint8_t, 256> digits{};
  for (auto& digit : digits)
    digit = kNoDigit;
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  return digits;
}
constexpr std::array<std::uint8_t, 256> kDigits = makeDigits();

/// Decodes base64. Padding within the text is permitted, since some writers encode an array's
/// header separately from its data and others do not.
class Base64 {
public:
  Base64(const Excerpt& text, const std::string& path) : text_(text), path_(path) {}

  /// An upper bound of the remaining bytes.
  std::uint64_t max() const { return carried_ + (text_.bytes.size() - at_) / 4 * 3; }
  std::size_t position() const { return text_.begin + at_; }

  void read(char* out, std::size_t n) {
    if (n > max())
      fail(path_, text_.begin + text_.bytes.size(),
           "the base64 text ends " + std::to_string(n - max()) + " bytes early");
    while (n > 0 && carried_ > 0)
      *out++ = next(), --n;
    const std::size_t quads = n / 3;
    if (quads > 0 && text_.bytes.size() - at_ >= quads * 4 && readQuads(out, quads)) {
      out += quads * 3;
      n -= quads * 3;
      at_ += quads * 4;
    }
    while (n-- > 0)
      *out++ = next();
  }

private:
  char next() {
    if (carried_ == 0)
      fill();
    return carry_[3 - carried_--];
  }

  // The next four digits, skipping white space between them.
  void fill() {
    std::uint32_t bits = 0;
    unsigned digits = 0, padding = 0;
    while (digits + padding < 4) {
      if (at_ == text_.bytes.size())
        fail(path_, position(), "the base64 text ends early");
      const char c = text_.bytes[at_++];
      const std::uint8_t digit = kDigits[static_cast<unsigned char>(c)];
      if (static_cast<unsigned char>(c) <= ' ')
        continue;
      if (c == '=' && digits >= 2) {
        ++padding;
      } else if (digit != kNoDigit && padding == 0) {
        bits = bits << 6 | digit;
        ++digits;
      } else {
        fail(path_, position() - 1, "a character that is not base64");
      }
    }
    bits <<= 6 * padding;
    // Stored at the end of carry_, so that the last carried_ of three are the remaining ones.
    carried_ = digits - 1;
    for (unsigned i = 0; i < carried_; ++i)
      carry_[3 - carried_ + i] = static_cast<char>(bits >> (16 - 8 * i) & 0xff);
  }

  // Returns false, without reading, if there is anything except digits.
  bool readQuads(char* out, std::size_t quads) const {
    std::atomic<bool> clean{true};
    const char* text = text_.bytes.data() + at_;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, quads, 1 << 15), [&](const auto& range) {
      std::uint32_t wrong = 0;
      const char* from = text + range.begin() * 4;
      char* to = out + range.begin() * 3;
      const auto digit = [&](int i) {
        const std::uint32_t d = kDigits[static_cast<unsigned char>(from[i])];
        wrong |= d;
        return d;
      };
      for (std::size_t i = range.begin(); i < range.end(); ++i, from += 4, to += 3) {
        const std::uint32_t bits = digit(0) << 18 | digit(1) << 12 | digit(2) << 6 | digit(3);
        to[0] = static_cast<char>(bits >> 16 & 0xff);
        to[1] = static_cast<char>(bits >> 8 & 0xff);
        to[2] = static_cast<char>(bits & 0xff);
      }
      if ((wrong & kNoDigit) != 0)
        clean = false;
    });
    return clean;
  }

  Excerpt text_;
  const std::string& path_;
  std::size_t at_ = 0;
  unsigned carried_ = 0;
  char carry_[3] = {};
};

std::uint64_t headerWord(const char* words, std::size_t i, const Encoding& encoding) {
  return encoding.wideHeader ? loadNumber<std::uint64_t>(words + i * 8, encoding.swap)
                             : loadNumber<std::uint32_t>(words + i * 4, encoding.swap);
}

/// A common interface of the two encodings.
class Stream {
public:
  Stream(const Excerpt& from, bool base64, const std::string& path)
      : base64_(base64), text_(from, path), raw_(from), path_(path) {}

  std::uint64_t max() const { return base64_ ? text_.max() : raw_.bytes.size() - at_; }
  std::size_t position() const { return base64_ ? text_.position() : raw_.begin + at_; }

  std::uint64_t header(const Encoding& encoding) {
    const Decoded word = take(encoding.wideHeader ? 8 : 4);
    return headerWord(word.data, 0, encoding);
  }

  /// The next `n` bytes; a view if they are raw.
  Decoded take(std::uint64_t n) {
    if (n > max())
      fail(path_, position(),
           "an array of " + std::to_string(n) + " bytes, but only " + std::to_string(max()) +
               " are left");
    Decoded out;
    out.size = n;
    if (base64_) {
      out.owned.reset(new char[n]);
      text_.read(out.owned.get(), n);
      out.data = out.owned.get();
    } else {
      out.data = raw_.bytes.data() + at_;
      at_ += n;
    }
    return out;
  }
  /// The same as a copy.
  void read(char* out, std::uint64_t n) {
    if (base64_) {
      text_.read(out, n);
    } else {
      const Decoded view = take(n);
      std::memcpy(out, view.data, n);
    }
  }

private:
  bool base64_;
  Base64 text_;
  Excerpt raw_;
  std::size_t at_ = 0;
  const std::string& path_;
};

/// The maximum size of `n` compressed bytes after decompression.
double maxExpansion(Compressor compressor) {
  switch (compressor) {
  case Compressor::Zlib:
    return 1040;
  case Compressor::Lz4:
    return 256;
  default:
    return 20000;
  }
}

bool decompress(Compressor compressor, const char* from, std::size_t size, char* to,
                std::size_t expected) {
  switch (compressor) {
  case Compressor::Zlib: {
    uLongf length = expected;
    return uncompress(reinterpret_cast<Bytef*>(to), &length, reinterpret_cast<const Bytef*>(from),
                      size) == Z_OK &&
           length == expected;
  }
  case Compressor::Lz4:
    return size <= INT_MAX && expected <= INT_MAX &&
           LZ4_decompress_safe(from, to, static_cast<int>(size), static_cast<int>(expected)) ==
               static_cast<int>(expected);
  case Compressor::Lzma: {
    std::uint64_t memory = std::uint64_t(256) << 20;
    std::size_t read = 0, written = 0;
    return lzma_stream_buffer_decode(
               &memory, 0, nullptr, reinterpret_cast<const std::uint8_t*>(from), &read, size,
               reinterpret_cast<std::uint8_t*>(to), &written, expected) == LZMA_OK &&
           written == expected;
  }
  case Compressor::None:
    break;
  }
  return false;
}

// What precedes compressed blocks: their number, the size of each and of the last (0: as the
// others) before compression, the size of each after compression.
struct BlockTable {
  std::size_t start = 0;             // of the array, for messages
  std::vector<std::uint64_t> begins; // of the blocks and of their end, after compression
  std::uint64_t blockSize = 0, lastSize = 0;

  std::size_t count() const { return begins.size() - 1; }
  std::uint64_t sizeOf(std::size_t block) const {
    return block + 1 < count() ? blockSize : lastSize;
  }
  std::uint64_t total() const { return count() == 0 ? 0 : (count() - 1) * blockSize + lastSize; }
};

BlockTable readBlockTable(Stream& stream, const Encoding& encoding, std::uint64_t min,
                          const std::string& path) {
  BlockTable table;
  table.start = stream.position();
  const std::uint64_t count = stream.header(encoding);
  table.blockSize = stream.header(encoding);
  table.lastSize = stream.header(encoding);
  if (count > stream.max() / (encoding.wideHeader ? 8 : 4))
    fail(path, table.start, std::to_string(count) + " compressed blocks, more than the file holds");
  const Decoded sizes = stream.take(count * (encoding.wideHeader ? 8 : 4));
  std::vector<std::uint64_t>& begins = table.begins;
  begins.assign(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    begins[i + 1] = begins[i] + headerWord(sizes.data, i, encoding);
    if (begins[i + 1] < begins[i] || begins[i + 1] > stream.max())
      fail(path, table.start, "compressed blocks that do not fit the file");
  }
  if (count == 0) {
    if (min > 0)
      fail(path, table.start, "an array without data");
    return table;
  }
  if (table.lastSize == 0)
    table.lastSize = table.blockSize;
  const double total = static_cast<double>(count - 1) * static_cast<double>(table.blockSize) +
                       static_cast<double>(table.lastSize);
  const double room = maxExpansion(encoding.compressor) * static_cast<double>(begins[count] + 64);
  if (total > 9e18 || table.lastSize > table.blockSize || total > room)
    fail(path, table.start, "compressed blocks that claim more bytes than they can hold");
  if (table.total() < min)
    fail(path, table.start,
         "an array of " + std::to_string(table.total()) + " bytes in place of " +
             std::to_string(min));
  return table;
}

void decompressBlock(const BlockTable& table, std::size_t block, Compressor compressor,
                     const char* packed, char* out, const std::string& path) {
  if (!decompress(compressor, packed, table.begins[block + 1] - table.begins[block], out,
                  table.sizeOf(block)))
    fail(path, table.start, "a compressed block of an array is damaged");
}

Decoded decodeBlocks(Stream& stream, const Encoding& encoding, std::uint64_t min,
                     const std::string& path, Progress& progress) {
  const BlockTable table = readBlockTable(stream, encoding, min, path);
  Decoded out;
  if (table.count() == 0)
    return out;
  out.size = table.total();
  const Decoded packed = stream.take(table.begins.back());
  out.owned.reset(new char[out.size]); // not cleared: only decompressed bytes use memory
  out.data = out.owned.get();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, table.count()), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (i % 64 == 0)
        progress.check();
      decompressBlock(table, i, encoding.compressor, packed.data + table.begins[i],
                      out.owned.get() + i * table.blockSize, path);
    }
  });
  return out;
}

} // namespace

Decoded decode(const Excerpt& from, bool base64, const Encoding& encoding, std::uint64_t min,
               const std::string& path, Progress& progress) {
  Stream stream(from, base64, path);
  if (min == 0 && from.bytes.empty())
    return {};
  if (encoding.compressor != Compressor::None)
    return decodeBlocks(stream, encoding, min, path, progress);
  const std::size_t start = stream.position();
  const std::uint64_t size = stream.header(encoding);
  if (size < min)
    fail(path, start,
         "an array of " + std::to_string(size) + " bytes in place of " + std::to_string(min));
  return stream.take(size);
}

struct ArrayStream::State {
  State(const Excerpt& from, bool isBase64, const Encoding& how, const std::string& file)
      : path(file), encoding(how), stream(from, isBase64, path) {
    if (from.bytes.empty())
      return;
    if (encoding.compressor == Compressor::None) {
      left = stream.header(encoding);
    } else {
      table = readBlockTable(stream, encoding, 0, path);
      left = table.total();
    }
  }

  void nextBlock() {
    const Decoded packed = stream.take(table.begins[next + 1] - table.begins[next]);
    block.resize(static_cast<std::size_t>(table.sizeOf(next)));
    decompressBlock(table, next, encoding.compressor, packed.data, block.data(), path);
    ++next;
    at = 0;
  }

  std::string path;
  Encoding encoding;
  Stream stream;
  BlockTable table;
  std::uint64_t left = 0;
  std::vector<char> block; // the one being read, up to `at`
  std::size_t at = 0, next = 0;
};

ArrayStream::ArrayStream(const Excerpt& from, bool base64, const Encoding& encoding,
                         const std::string& path)
    : state_(std::make_unique<State>(from, base64, encoding, path)) {}
ArrayStream::~ArrayStream() = default;

std::uint64_t ArrayStream::left() const {
  return state_->left;
}

void ArrayStream::read(char* out, std::uint64_t n) {
  State& s = *state_;
  if (n > s.left)
    fail(s.path, s.stream.position(),
         "an array that ends " + std::to_string(n - s.left) + " bytes early");
  s.left -= n;
  if (s.encoding.compressor == Compressor::None) {
    s.stream.read(out, n);
    return;
  }
  while (n > 0) {
    if (s.at == s.block.size())
      s.nextBlock();
    const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(n, s.block.size() - s.at));
    std::memcpy(out, s.block.data() + s.at, size);
    s.at += size;
    out += size;
    n -= size;
  }
}

} // namespace tetvdb::vtk
