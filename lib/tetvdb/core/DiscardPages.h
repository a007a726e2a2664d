// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <sys/mman.h>
#include <unistd.h>

namespace tetvdb {

/// Gives the memory of whole pages within an array back to the system while the array still stands:
/// for what is read for the last time while something as large is made of it. Afterwards the bytes
/// are undefined until they are written again.
inline void discardPages(void* data, std::size_t bytes) noexcept {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const std::size_t before = (page - reinterpret_cast<std::uintptr_t>(data) % page) % page;
  if (bytes >= before + page)
    ::madvise(static_cast<char*>(data) + before, (bytes - before) / page * page, MADV_DONTNEED);
}

} // namespace tetvdb
