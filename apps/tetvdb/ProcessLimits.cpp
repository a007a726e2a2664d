// SPDX-License-Identifier: Apache-2.0
#include "ProcessLimits.h"

#include "ParseQuantities.h"
#include "tetvdb/core/Report.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <malloc.h>
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

// glibc's heap of a thread: 64 MB of addresses (malloc/arena.c, HEAP_MAX_SIZE), which it makes
// writable a few pages at a time, a system call each that waits for those of all other threads.
// Makes it writable at once, and keeps blocks of up to 32 MB in it. Returns the bytes of all heaps,
// or 0 where they would be more than an eighth of the available memory: then nothing changes.
std::uint64_t growHeapsAtOnce(std::uint64_t threads) {
  constexpr std::uint64_t heap = std::uint64_t(64) << 20;
  if (threads * heap > availableBytes() / 8)
    return 0;
  ::mallopt(M_TOP_PAD, static_cast<int>(heap));
  ::mallopt(M_TRIM_THRESHOLD, static_cast<int>(heap));
  ::mallopt(M_MMAP_THRESHOLD, static_cast<int>(heap / 2));
  return threads * heap;
}

void limitMemory(const JobOptions& options) {
  if (kSanitized)
    return;
  const std::uint64_t asked = memoryLimit(options);
  const auto threads = static_cast<std::uint64_t>(threadCount(options));
  const std::uint64_t heaps = asked > 0 ? 0 : growHeapsAtOnce(threads);
  if (::access("/dev/nvidiactl", F_OK) == 0)
    return;
  rlimit stack{}, data{};
  ::getrlimit(RLIMIT_STACK, &stack);
  ::getrlimit(RLIMIT_DATA, &data);
  const std::uint64_t stacks =
      threads * std::min<std::uint64_t>(stack.rlim_cur, std::uint64_t(8) << 20);
  const std::uint64_t limit =
      dataBytes() + stacks + heaps + (asked > 0 ? asked + asked / 4 : availableBytes());
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
