// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/TarWriter.h"

#include "tetvdb/core/Error.h"

#include <array>
#include <cstdio>
#include <cstring>

namespace tetvdb {
namespace {

constexpr std::size_t kBlock = 512, kNameLength = 100;

} // namespace

void TarWriter::entry(const std::string& name, char type, std::string_view bytes) {
  if (bytes.size() >= std::uint64_t(1) << 33)
    throw Error(Status::Limit, name, "is too large for a tar archive");
  std::array<char, kBlock> header{};
  const auto put = [&](std::size_t at, const char* text) {
    std::memcpy(header.data() + at, text, std::strlen(text));
  };
  std::memcpy(header.data(), name.data(), std::min(name.size(), kNameLength));
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  char size[12];
  std::snprintf(size, sizeof size, "%011llo", static_cast<unsigned long long>(bytes.size()));
  put(124, size);
  put(136, "00000000000");
  header[156] = type;
  put(257, "ustar");
  put(263, "00");
  std::memset(header.data() + 148, ' ', 8);
  unsigned sum = 0;
  for (const char c : header)
    sum += static_cast<unsigned char>(c);
  char check[8];
  std::snprintf(check, sizeof check, "%06o", sum & 0777777u);
  put(148, check);
  header[154] = 0;
  file_.write(header.data(), header.size());
  file_.write(bytes.data(), bytes.size());
  const std::array<char, kBlock> zeros{};
  if (bytes.size() % kBlock != 0)
    file_.write(zeros.data(), kBlock - bytes.size() % kBlock);
}

void TarWriter::add(const std::string& name, std::string_view bytes) {
  if (name.size() > kNameLength)
    entry("././@LongLink", 'L', std::string_view(name.c_str(), name.size() + 1));
  entry(name, '0', bytes);
}

void TarWriter::finish() {
  const std::array<char, 2 * kBlock> zeros{};
  file_.write(zeros.data(), zeros.size());
}

} // namespace tetvdb
