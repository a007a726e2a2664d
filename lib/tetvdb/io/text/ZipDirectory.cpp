// SPDX-License-Identifier: Apache-2.0
//
// Format: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", sections 4.3.12 to 4.3.16.
#include "tetvdb/io/text/ZipDirectory.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"

#include <algorithm>
#include <new>
#include <zlib.h>

namespace tetvdb {
namespace {

constexpr std::size_t kEndBytes = 22; // the record at the end, without its comment
constexpr std::size_t kLocatorBytes = 20;
constexpr std::uint32_t kInZip64 = UINT32_MAX; // the number is in a ZIP64 field
constexpr std::uint64_t kFreeBytes = std::uint64_t(64) << 20;

constexpr std::size_t kAtOnce = std::size_t(1) << 20;

constexpr std::string_view kEndMark("PK\x05\x06", 4);
constexpr std::string_view kEndMark64("PK\x06\x06", 4);
constexpr std::string_view kLocatorMark("PK\x06\x07", 4);
constexpr std::string_view kFileMark("PK\x03\x04", 4);
constexpr std::string_view kEntryMark("PK\x01\x02", 4);

[[noreturn]] void failDamaged(const Source& source) {
  throw Error(Status::Invalid, source.path, "it is no whole ZIP archive", kCut);
}

struct Directory {
  std::uint64_t entries, offset;
};

Directory findDirectory(const Source& source) {
  const std::string_view bytes = source.bytes;
  const std::size_t end = bytes.rfind(kEndMark);
  if (end == bytes.npos || bytes.size() - end < kEndBytes)
    failDamaged(source);
  ByteReader in(source, false, end + 10);
  Directory found{in.get<std::uint16_t>(), 0};
  in.skip(4);
  found.offset = in.get<std::uint32_t>();
  if (end < kLocatorBytes || bytes.substr(end - kLocatorBytes, 4) != kLocatorMark)
    return found;
  in.seek(end - kLocatorBytes + 8);
  in.seek(in.get<std::uint64_t>());
  if (in.take(4) != kEndMark64)
    failDamaged(source);
  in.skip(28);
  found.entries = in.get<std::uint64_t>();
  in.skip(8);
  found.offset = in.get<std::uint64_t>();
  return found;
}

/// Replaces 32-bit sizes by 64-bit ones, in this order, if they are marked.
void readZip64(ByteReader extra, ZipEntry& entry) {
  constexpr std::uint16_t zip64 = 1;
  while (extra.remaining() >= 4) {
    const auto id = extra.get<std::uint16_t>();
    const auto size = extra.get<std::uint16_t>();
    if (id != zip64) {
      extra.skip(size);
      continue;
    }
    if (entry.unpacked == kInZip64)
      entry.unpacked = extra.get<std::uint64_t>();
    if (entry.packed == kInZip64)
      entry.packed = extra.get<std::uint64_t>();
    if (entry.offset == kInZip64)
      entry.offset = extra.get<std::uint64_t>();
    return;
  }
}

struct Inflater {
  Inflater() {
    constexpr int raw = -15; // without zlib's header
    if (inflateInit2(&stream, raw) != Z_OK)
      throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream stream{};
};

std::string_view packedBytes(const ZipEntry& entry, const Source& source) {
  ByteReader in(source);
  in.seek(entry.offset);
  if (in.take(4) != kFileMark)
    failDamaged(source);
  in.skip(22);
  const auto nameBytes = in.get<std::uint16_t>();
  const auto extraBytes = in.get<std::uint16_t>();
  in.skip(std::uint64_t(nameBytes) + extraBytes);
  return in.take(entry.packed);
}

} // namespace

std::vector<ZipEntry> readZipDirectory(const Source& source) {
  const Directory directory = findDirectory(source);
  ByteReader in(source);
  in.seek(directory.offset);
  in.checkCount(directory.entries, 46, "files");
  std::vector<ZipEntry> entries;
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    if (in.take(4) != kEntryMark)
      failDamaged(source);
    in.skip(6);
    ZipEntry entry;
    entry.method = in.get<std::uint16_t>();
    in.skip(8);
    entry.packed = in.get<std::uint32_t>();
    entry.unpacked = in.get<std::uint32_t>();
    const auto nameBytes = in.get<std::uint16_t>();
    const auto extraBytes = in.get<std::uint16_t>();
    const auto commentBytes = in.get<std::uint16_t>();
    in.skip(8);
    entry.offset = in.get<std::uint32_t>();
    entry.name = in.take(nameBytes);
    readZip64(ByteReader(in.take(extraBytes), source.path), entry);
    in.skip(commentBytes);
    entries.push_back(std::move(entry));
  }
  return entries;
}

void checkZipSizes(const std::vector<ZipEntry>& entries, const Source& source,
                   std::uint64_t largestRatio) {
  const std::uint64_t size = source.bytes.size();
  const std::uint64_t limit = std::max(kFreeBytes, largestRatio * size);
  std::uint64_t packed = 0, unpacked = 0;
  for (const ZipEntry& entry : entries) {
    if (entry.packed > size - packed)
      throw Error(Status::Invalid, source.path, "the files in it overlap",
                  "it is no archive that an exporter writes; export it again");
    packed += entry.packed;
    if (entry.unpacked > limit - unpacked)
      throw Error(Status::Limit, source.path,
                  "what is packed in it would take more than " + std::to_string(limit >> 20) +
                      " MiB, over " + std::to_string(limit / size) + " times the file's size",
                  "unpack and check it, or export it again");
    unpacked += entry.unpacked;
  }
}

std::string unpackZipEntry(const ZipEntry& entry, const Source& source, Progress& progress) {
  constexpr std::uint16_t stored = 0, deflated = 8;
  std::string_view packed = packedBytes(entry, source);
  if (entry.method == stored && entry.unpacked == entry.packed)
    return std::string(packed);
  if (entry.method != deflated)
    throw Error(Status::Invalid, source.path, "a file in it is packed in an unknown way",
                "pack it with deflate, as other programs do");
  std::string bytes(static_cast<std::size_t>(entry.unpacked), '\0');
  std::size_t done = 0;
  Inflater inflater;
  int status = Z_OK;
  while (status == Z_OK) {
    char beyond = 0; // one byte more than declared is an error
    const bool full = done == bytes.size();
    const std::size_t in = std::min(packed.size(), kAtOnce);
    const std::size_t out = full ? 1 : std::min(bytes.size() - done, kAtOnce);
    z_stream& stream = inflater.stream;
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(full ? &beyond : bytes.data() + done);
    stream.avail_out = static_cast<uInt>(out);
    status = inflate(&stream, Z_NO_FLUSH);
    packed.remove_prefix(in - stream.avail_in);
    if (full && stream.avail_out == 0)
      status = Z_DATA_ERROR;
    done += full ? 0 : out - stream.avail_out;
    progress.check();
  }
  if (status != Z_STREAM_END || done != bytes.size())
    throw Error(Status::Invalid, source.path,
                "a file in it does not unpack to the " + std::to_string(entry.unpacked) +
                    " bytes that are declared",
                "the file is damaged; export it again");
  return bytes;
}

} // namespace tetvdb
