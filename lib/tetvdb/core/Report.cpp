// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Report.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <new>
#include <sys/resource.h>
#include <utility>

namespace tetvdb {

std::size_t peakResidentBytes() {
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0)
    return 0;
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

namespace {

constexpr std::size_t kUnlimited = std::numeric_limits<std::size_t>::max();

// A control-group file holds one number, or "max".
std::size_t numberIn(const char* path) {
  std::ifstream file(path);
  std::size_t value = 0;
  return file >> value ? value : kUnlimited;
}

// limit - used, 0 where used is larger, unlimited where there is no limit.
std::size_t left(std::size_t limit, std::size_t used) {
  if (limit == kUnlimited || used == kUnlimited)
    return kUnlimited;
  return limit > used ? limit - used : 0;
}

std::size_t systemAvailable() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  std::size_t kilobytes = 0;
  std::string unit;
  while (file >> key >> kilobytes) {
    if (key == "MemAvailable:")
      return kilobytes * 1024;
    std::getline(file, unit);
  }
  return kUnlimited;
}

std::size_t addressSpaceLeft() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return kUnlimited;
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return left(static_cast<std::size_t>(limit.rlim_cur), pages * 4096);
}

} // namespace

std::size_t availableBytes() {
  return std::min(
      {systemAvailable(), addressSpaceLeft(),
       left(numberIn("/sys/fs/cgroup/memory.max"), numberIn("/sys/fs/cgroup/memory.current")),
       left(numberIn("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
            numberIn("/sys/fs/cgroup/memory/memory.usage_in_bytes"))});
}

StageTimer::StageTimer(Report& report, std::string_view name)
    : report_(report), start_(Clock::now()), partStart_(start_) {
  stage_.name = name;
}

StageTimer::~StageTimer() {
  const auto now = Clock::now();
  endPart(now);
  stage_.seconds = std::chrono::duration<double>(now - start_).count();
  stage_.peakBytes = peakResidentBytes();
  try {
    report_.stages.push_back(std::move(stage_));
  } catch (const std::bad_alloc&) { // maybe while another error is on its way; the stage is missing
  }
}

void StageTimer::part(std::string_view name) {
  const auto now = Clock::now();
  endPart(now);
  stage_.parts.push_back({std::string(name), 0});
  partStart_ = now;
}

void StageTimer::endPart(Clock::time_point now) {
  if (!stage_.parts.empty())
    stage_.parts.back().seconds = std::chrono::duration<double>(now - partStart_).count();
}

} // namespace tetvdb
