// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/ResidentBytes.h"

#include <cstdio>
#include <unistd.h>

namespace tetvdb {

std::size_t residentBytes() noexcept {
  std::size_t total = 0;
  std::size_t resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu %zu", &total, &resident) != 2)
      resident = 0;
    std::fclose(file);
  }
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

} // namespace tetvdb
