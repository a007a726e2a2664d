// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/NumberedPath.h"

#include <charconv>
#include <filesystem>

namespace tetvdb {

NumberedPath::NumberedPath(const std::string& path) {
  namespace fs = std::filesystem;
  const auto isDigit = [&](std::size_t i) { return path[i] >= '0' && path[i] <= '9'; };
  extension = fs::path(path).extension().string();
  const std::size_t name = path.size() - fs::path(path).filename().string().size();
  const std::size_t stemEnd = path.size() - extension.size();
  std::size_t end = stemEnd;
  while (end > name && !isDigit(end - 1))
    --end;
  std::size_t begin = end;
  while (begin > name && isDigit(begin - 1))
    --begin;
  if (begin == end)
    begin = end = stemEnd;
  before = path.substr(0, begin);
  digits = path.substr(begin, end - begin);
  after = path.substr(end, stemEnd - end);
  unsigned long long value = 0;
  if (!digits.empty() &&
      std::from_chars(digits.data(), digits.data() + digits.size(), value).ec == std::errc())
    number = value;
}

} // namespace tetvdb
