// SPDX-License-Identifier: Apache-2.0
#include "JsonReport.h"

#include "tetvdb/core/AtomicFile.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace tetvdb::cli {
namespace {

// Far above what a report of ten thousand inputs has.
constexpr std::uintmax_t kLargestReport = std::uintmax_t(1) << 28;

bool isReport(const std::string& path) {
  std::error_code error;
  if (std::filesystem::file_size(path, error) > kLargestReport || error)
    return false;
  std::ifstream file(path, std::ios::binary);
  if (file.get() != '{')
    return false;
  file.seekg(0);
  const nlohmann::json parsed = nlohmann::json::parse(file, nullptr, false);
  const auto holds = [&](const char* key, auto is) {
    const auto found = parsed.find(key);
    return found != parsed.end() && is(*found);
  };
  const auto isText = [](const nlohmann::json& value) { return value.is_string(); };
  return parsed.is_object() && holds("version", isText) && holds("command", isText) &&
         holds("status", [](const nlohmann::json& value) { return value.is_number_integer(); });
}

} // namespace

void requireReplaceable(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::is_empty(path, error))
    return;
  if (!isReport(path))
    throw Error(Status::Usage, path, "exists and is no report of this program",
                "choose another file for --json, or add --force to replace it");
}

void requireWritableReport(const std::string& path) {
  try {
    const AtomicFile probe(path);
  } catch (const Error&) {
    throw Error(Status::Write, path, "cannot create the report", "choose another file for --json");
  }
}

void writeReport(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text.data(), text.size());
  file.commit();
}

std::string oneLine(const std::string& text) {
  constexpr std::size_t kLongest = 2000; // a message may quote a file
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool latin = byte == 0xc2 && i + 1 < text.size() &&
                       (static_cast<unsigned char>(text[i + 1]) & 0xe0) == 0x80;
    if (latin) // U+0080 to U+009F in UTF-8: control characters of terminals
      ++i;
    line += latin || byte < 0x20 || byte == 0x7f ? ' ' : text[i];
    if (line.size() == kLongest) {
      line.resize(line.find_last_not_of(" ") + 1);
      return line + " ...";
    }
  }
  while (!line.empty() && line.back() == ' ')
    line.pop_back();
  return line;
}

} // namespace tetvdb::cli
