// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <sys/mman.h>
#include <unistd.h>

namespace tetvdb {

/// Returns the memory of whole pages within an array to the system, while the array keeps its size:
/// for data that is read for the last time while other data of the same size is made of it. The
/// bytes are undefined until they are written again.
inline void discardPages(void* data, std::size_t bytes) noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(data) % page) % page;
  if (bytes >= before + page)
    ::madvise(static_cast<char*>(data) + before, (bytes - before) / page * page, MADV_DONTNEED);
}

} // namespace tetvdb
