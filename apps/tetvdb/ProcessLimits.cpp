// SPDX-License-Identifier: Apache-2.0
#include "ProcessLimits.h"

#include "ParseQuantities.h"
#include "tetvdb/core/Report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>

namespace tetvdb::cli {
namespace {

#ifdef TETVDB_SANITIZED
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

// Writable private memory as RLIMIT_DATA counts it, of this process so far (proc(5), statm).
std::uint64_t dataBytes() {
  std::uint64_t size = 0, resident = 0, shared = 0, text = 0, unused = 0, data = 0;
  std::ifstream("/proc/self/statm") >> size >> resident >> shared >> text >> unused >> data;
  return data * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limitMemory(const JobOptions& options) {
  if (kSanitized || ::access("/dev/nvidiactl", F_OK) == 0)
    return;
  const std::uint64_t asked = memoryLimit(options);
  rlimit stack{}, data{};
  ::getrlimit(RLIMIT_STACK, &stack);
  ::getrlimit(RLIMIT_DATA, &data);
  const auto threads = static_cast<std::uint64_t>(threadCount(options));
  const std::uint64_t stacks =
      threads * std::min<std::uint64_t>(stack.rlim_cur, std::uint64_t(8) << 20);
  const std::uint64_t limit =
      dataBytes() + stacks + (asked > 0 ? asked + asked / 4 : availableBytes());
  data.rlim_cur = std::min<std::uint64_t>(data.rlim_max, limit);
  ::setrlimit(RLIMIT_DATA, &data);
}

} // namespace

void limitProcess(const JobOptions& options, Progress& progress) {
  limitMemory(options);
  if (options.maxTime.empty())
    return;
  // A year stands for no limit, and fits the clock.
  const double seconds = std::min(parseSeconds("--max-time", options.maxTime), 3.2e7);
  progress.setDeadline(Progress::Clock::now() +
                       std::chrono::duration_cast<Progress::Clock::duration>(
                           std::chrono::duration<double>(seconds)));
  const double grace = std::clamp(0.5 * seconds, 5.0, 60.0);
  ::alarm(static_cast<unsigned>(std::ceil(seconds + grace)));
}

} // namespace tetvdb::cli
