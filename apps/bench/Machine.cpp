// SPDX-License-Identifier: Apache-2.0
#include "Machine.h"

#include "Revision.h" // made by the build
#include "Table.h"
#include "tetvdb/core/Version.h"

#include <algorithm>
#include <cctype>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <openvdb/version.h>
#include <sstream>
#include <string>
#include <tbb/version.h>
#include <thread>
#include <unistd.h>

namespace tetvdb::bench {
namespace {

namespace fs = std::filesystem;

/// What follows `key` and a separator on the first line that begins with it.
std::string valueIn(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.rfind(key, 0) == 0) {
      const std::size_t at = line.find_first_of(":=", key.size());
      line = at == std::string::npos ? "" : line.substr(at + 1);
      line.erase(std::remove(line.begin(), line.end(), '"'), line.end());
      line.erase(0, std::min(line.size(), line.find_first_not_of(" \t")));
      return line;
    }
  return "";
}

std::string firstWord(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  file >> word;
  return word;
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::localtime_r(&now, &parts);
  static const char* const months[] = {"January",   "February", "March",    "April",
                                       "May",       "June",     "July",     "August",
                                       "September", "October",  "November", "December"};
  return fmt::format("{} {} {}", parts.tm_mday, months[parts.tm_mon], 1900 + parts.tm_year);
}

/// Of one process, its own time and that of children it has waited for.
struct Process {
  int parent = 0;
  double seconds = 0;
};

/// proc(5): the name is in brackets and may hold anything; state and parent follow it, utime,
/// stime, cutime and cstime are fields 14 to 17.
bool readProcess(const fs::path& folder, double ticks, Process& process) {
  std::ifstream file(folder / "stat");
  std::string line;
  if (!std::getline(file, line) || line.rfind(')') == std::string::npos)
    return false;
  std::istringstream fields(line.substr(line.rfind(')') + 1));
  std::string skipped;
  fields >> skipped >> process.parent;
  for (int field = 5; field <= 13; ++field)
    fields >> skipped;
  double sum = 0, value = 0;
  for (int field = 14; field <= 17; ++field, sum += value)
    fields >> value;
  process.seconds = sum / ticks;
  return static_cast<bool>(fields);
}

double ownSeconds(double ticks) {
  std::map<int, Process> processes;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename();
    Process process;
    if (std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c); }) &&
        readProcess(entry.path(), ticks, process))
      processes[std::stoi(name)] = process;
  }
  double sum = 0;
  for (const auto& [id, process] : processes)
    for (int at = id; at > 1 && processes.count(at) != 0; at = processes[at].parent)
      if (at == getpid()) {
        sum += process.seconds;
        break;
      }
  return sum;
}

} // namespace

Work workSoFar() {
  const auto ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, wait = 0, interrupts = 0, soft = 0, stolen = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> wait >> interrupts >> soft >> stolen))
    return {};
  return {(user + nice + system + interrupts + soft + stolen) / ticks, ownSeconds(ticks)};
}

nlohmann::ordered_json describeMachine() {
  const double memory = std::strtod(valueIn("/proc/meminfo", "MemTotal").c_str(), nullptr) * 1024;
  return {{"date", today()},
          {"processor", valueIn("/proc/cpuinfo", "model name")},
          {"cores", std::thread::hardware_concurrency()},
          {"cache", firstWord("/sys/devices/system/cpu/cpu0/cache/index3/size")},
          {"memory", size(memory)},
          {"system", valueIn("/etc/os-release", "PRETTY_NAME")},
          {"compiler", fmt::format("{} {}, {}", TETVDB_COMPILER, __VERSION__, TETVDB_BUILD_TYPE)},
          {"libraries", fmt::format("OpenVDB {}, oneTBB {}", OPENVDB_LIBRARY_VERSION_STRING,
                                    TBB_runtime_version())},
          {"version", version()},
          {"revision", kRevision}};
}

} // namespace tetvdb::bench
