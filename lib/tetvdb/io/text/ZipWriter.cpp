// SPDX-License-Identifier: Apache-2.0
//
// Format: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", sections 4.3.7, 4.3.12 to 4.3.16
// and 4.5.3.
#include "tetvdb/io/text/ZipWriter.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <array>
#include <new>

namespace tetvdb {
namespace {

constexpr int kRaw = -15;  // zlib: deflate of the largest window, without a header
constexpr int kMemory = 8; // zlib's default
constexpr std::size_t kOnce = std::size_t(1) << 30;
constexpr std::uint64_t kIn64 = 0xffffffff; ///< the number is in the extra field
constexpr std::uint64_t kExtra64 = 1;       ///< type of that field

std::string littleEndian(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (; bytes > 0; --bytes, number >>= 8)
    text += static_cast<char>(number & 0xff);
  return text;
}

// The extra field of a local header.
std::string sizes64(std::uint64_t unpacked, std::uint64_t packed) {
  return littleEndian(kExtra64, 2) + littleEndian(16, 2) + littleEndian(unpacked, 8) +
         littleEndian(packed, 8);
}

} // namespace

ZipWriter::ZipWriter(AtomicFile& file) : file_(file) {
  if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kRaw, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

ZipWriter::~ZipWriter() {
  deflateEnd(&stream_);
}

/// From the version to the extra field's length: common to both kinds of headers.
std::string ZipWriter::header(const Entry& entry, const std::string& extra) const {
  constexpr std::uint64_t firstDay = 0x21; // 1 January 1980
  const bool needs64 = !extra.empty();
  return littleEndian(needs64 ? 45 : 20, 2) + littleEndian(0, 2) +
         littleEndian(static_cast<std::uint64_t>(entry.method), 2) + littleEndian(0, 2) +
         littleEndian(firstDay, 2) + littleEndian(entry.crc, 4) +
         littleEndian(entry.large ? kIn64 : entry.packed, 4) +
         littleEndian(entry.large ? kIn64 : entry.unpacked, 4) +
         littleEndian(entry.name.size(), 2) + littleEndian(extra.size(), 2);
}

void ZipWriter::begin(const std::string& name, ZipMethod method, std::uint64_t size) {
  deflateReset(&stream_);
  Entry entry;
  entry.name = name;
  entry.offset = file_.size();
  entry.crc = static_cast<std::uint32_t>(crc32(0, nullptr, 0));
  entry.method = method;
  // Deflate adds at most five bytes for every 16 KB.
  entry.large = size + (size >> 10) + 64 >= kIn64;
  const std::string extra = entry.large ? sizes64(0, 0) : std::string();
  const std::string head = "PK\x03\x04" + header(entry, extra) + name + extra;
  file_.write(head.data(), head.size());
  entries_.push_back(std::move(entry));
}

void ZipWriter::write(std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), kOnce)))
    add(bytes.substr(0, kOnce), Z_NO_FLUSH);
}

void ZipWriter::add(std::string_view bytes, int flush) {
  Entry& entry = entries_.back();
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  if (!bytes.empty())
    entry.crc = static_cast<std::uint32_t>(crc32(entry.crc, data, static_cast<uInt>(bytes.size())));
  entry.unpacked += bytes.size();
  if (entry.method == ZipMethod::Deflated) {
    pack(bytes, flush);
  } else {
    file_.write(bytes.data(), bytes.size());
    entry.packed += bytes.size();
  }
}

void ZipWriter::pack(std::string_view bytes, int flush) {
  Entry& entry = entries_.back();
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  stream_.next_in = const_cast<Bytef*>(data);
  stream_.avail_in = static_cast<uInt>(bytes.size());
  std::array<Bytef, 65536> packed;
  do {
    stream_.next_out = packed.data();
    stream_.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream_, flush);
    const std::size_t n = packed.size() - stream_.avail_out;
    file_.write(packed.data(), n);
    entry.packed += n;
  } while (stream_.avail_out == 0);
}

void ZipWriter::end() {
  add({}, Z_FINISH);
  const Entry& entry = entries_.back();
  if (!entry.large && (entry.packed >= kIn64 || entry.unpacked >= kIn64))
    throw Error(Status::Limit, file_.path(), "'" + entry.name + "' takes more than 4 GiB",
                "write another format, or several files");
  const std::string extra = entry.large ? sizes64(entry.unpacked, entry.packed) : std::string();
  const std::string known = header(entry, extra);
  file_.writeAt(entry.offset + 4, known.data(), known.size());
  if (entry.large)
    file_.writeAt(entry.offset + 4 + known.size() + entry.name.size(), extra.data(), extra.size());
}

void ZipWriter::finish() {
  const std::uint64_t start = file_.size();
  std::string directory;
  for (const Entry& entry : entries_) {
    std::string extra;
    if (entry.large)
      extra += littleEndian(entry.unpacked, 8) + littleEndian(entry.packed, 8);
    const bool isFar = entry.offset >= kIn64;
    if (isFar)
      extra += littleEndian(entry.offset, 8);
    if (!extra.empty())
      extra = littleEndian(kExtra64, 2) + littleEndian(extra.size(), 2) + extra;
    directory += "PK\x01\x02" + littleEndian(extra.empty() ? 20 : 45, 2) + header(entry, extra) +
                 littleEndian(0, 10) + littleEndian(isFar ? kIn64 : entry.offset, 4) + entry.name +
                 extra;
  }
  const std::uint64_t size = directory.size(), files = entries_.size();
  const bool needs64 = start >= kIn64 || size >= kIn64 || files >= 0xffff;
  if (needs64) {
    const std::uint64_t here = start + size;
    directory += "PK\x06\x06" + littleEndian(44, 8) + littleEndian(45, 2) + littleEndian(45, 2) +
                 littleEndian(0, 8) + littleEndian(files, 8) + littleEndian(files, 8) +
                 littleEndian(size, 8) + littleEndian(start, 8);
    directory += "PK\x06\x07" + littleEndian(0, 4) + littleEndian(here, 8) + littleEndian(1, 4);
  }
  const std::uint64_t shortFiles = needs64 ? 0xffff : files;
  directory += "PK\x05\x06" + littleEndian(0, 4) + littleEndian(shortFiles, 2) +
               littleEndian(shortFiles, 2) + littleEndian(needs64 ? kIn64 : size, 4) +
               littleEndian(needs64 ? kIn64 : start, 4) + littleEndian(0, 2);
  file_.write(directory.data(), directory.size());
}

} // namespace tetvdb
