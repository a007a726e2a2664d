// SPDX-License-Identifier: Apache-2.0
//
// Format: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", sections 4.3.7, 4.3.12, 4.3.16.
#include "tetvdb/io/ZipWriter.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <array>
#include <new>

namespace tetvdb {
namespace {

constexpr int kRaw = -15;  // zlib: deflate of the largest window, without a header
constexpr int kMemory = 8; // zlib's default
constexpr std::size_t kOnce = std::size_t(1) << 30;

std::string littleEndian(std::uint64_t number, std::size_t bytes) {
  std::string text;
  for (; bytes > 0; --bytes, number >>= 8)
    text += static_cast<char>(number & 0xff);
  return text;
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

std::uint32_t ZipWriter::checked(std::uint64_t number) const {
  if (number >= UINT32_MAX)
    throw Error(Status::Limit, file_.path(), "more than 4 GiB in a ZIP archive",
                "write another format, or several files");
  return static_cast<std::uint32_t>(number);
}

/// From the version to the length of the extra field: what both kinds of headers have.
std::string ZipWriter::header(const Entry& entry) const {
  constexpr std::uint64_t version = 20, deflated = 8, firstDay = 0x21; // 1 January 1980
  return littleEndian(version, 2) + littleEndian(0, 2) + littleEndian(deflated, 2) +
         littleEndian(0, 2) + littleEndian(firstDay, 2) + littleEndian(entry.crc, 4) +
         littleEndian(checked(entry.packed), 4) + littleEndian(checked(entry.unpacked), 4) +
         littleEndian(entry.name.size(), 2) + littleEndian(0, 2);
}

void ZipWriter::begin(const std::string& name) {
  deflateReset(&stream_);
  Entry entry;
  entry.name = name;
  entry.offset = file_.size();
  entry.crc = static_cast<std::uint32_t>(crc32(0, nullptr, 0));
  const std::string head = "PK\x03\x04" + header(entry) + name;
  file_.write(head.data(), head.size());
  entries_.push_back(std::move(entry));
}

void ZipWriter::write(std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), kOnce)))
    pack(bytes.substr(0, kOnce), Z_NO_FLUSH);
}

void ZipWriter::pack(std::string_view bytes, int flush) {
  Entry& entry = entries_.back();
  const auto* data = reinterpret_cast<const Bytef*>(bytes.data());
  if (!bytes.empty())
    entry.crc = static_cast<std::uint32_t>(crc32(entry.crc, data, static_cast<uInt>(bytes.size())));
  entry.unpacked += bytes.size();
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
  pack({}, Z_FINISH);
  const std::string known = header(entries_.back());
  file_.writeAt(entries_.back().offset + 4, known.data(), known.size());
}

void ZipWriter::finish() {
  const std::uint64_t start = file_.size();
  std::string directory;
  for (const Entry& entry : entries_)
    directory += "PK\x01\x02" + littleEndian(20, 2) + header(entry) + littleEndian(0, 10) +
                 littleEndian(checked(entry.offset), 4) + entry.name;
  const std::string end = "PK\x05\x06" + littleEndian(0, 4) + littleEndian(entries_.size(), 2) +
                          littleEndian(entries_.size(), 2) + littleEndian(directory.size(), 4) +
                          littleEndian(checked(start), 4) + littleEndian(0, 2);
  directory += end;
  file_.write(directory.data(), directory.size());
}

} // namespace tetvdb
