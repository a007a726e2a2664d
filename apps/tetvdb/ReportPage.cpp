// SPDX-License-Identifier: Apache-2.0
#include "ReportRow.h"
#include "tetvdb/core/Version.h"

#include <ctime>
#include <fmt/format.h>
#include <fstream>
#include <thread>

namespace tetvdb::cli {

extern const char* const kReportTemplate; // made from report/page.html

namespace {

using Json = nlohmann::ordered_json;

/// "2026-11-22", local time.
std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::localtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

/// JSON that can stand within a script element: no "</script>", no "<!--".
std::string embeddable(const Json& data) {
  const std::string text = data.dump(-1, ' ', true, Json::error_handler_t::replace);
  std::string result;
  result.reserve(text.size() + 64);
  for (const char c : text) {
    if (c == '<')
      result += "\\u003c"; // only ever within strings
    else
      result += c;
  }
  return result;
}

} // namespace

std::string reportPage(const std::vector<Json>& rows, const ReportSettings& settings) {
  Json panels = Json::array();
  for (const Json& row : rows)
    if (row["panels"].size() > panels.size())
      panels = row["panels"];
  const Json data = {{"version", version()}, {"date", today()},
                     {"machine", machine()}, {"resolution", settings.resolution},
                     {"panels", panels},     {"rows", rows}};
  std::string page = kReportTemplate;
  const std::string place = "@TETVDB_DATA@";
  return page.replace(page.find(place), place.size(), embeddable(data));
}

} // namespace tetvdb::cli
