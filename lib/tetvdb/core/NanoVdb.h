// SPDX-License-Identifier: Apache-2.0
//
// NanoVDB's core header, for the host's compiler and for CUDA's, and the one place that knows how
// its versions differ: 32.4 (OpenVDB 10) to 32.9 (OpenVDB 13). Headers moved in OpenVDB 11 and 12,
// and with 12 the tools got a namespace of their own; the bytes of a buffer are the same in all.
#pragma once

#include "tetvdb/core/HostDevice.h"

// Of levels without nodes NanoVDB's builder asks for the distance to their first one, which it
// never uses, and asserts that there is one: in debug builds tiles alone, or nothing, would be an
// abort.
#ifndef NDEBUG
#define NDEBUG
#include <nanovdb/NanoVDB.h>
#undef NDEBUG
#include <cassert> // NOLINT(readability-duplicate-include): asserts are defined anew
#else
#include <nanovdb/NanoVDB.h>
#endif

#include <cstdint>

/// For #include: where the headers of NanoVDB's tools lie.
#if __has_include(<nanovdb/tools/GridStats.h>) // OpenVDB 12 and later
#define TETVDB_NANOVDB_TOOL(name) <nanovdb/tools/name.h>
namespace nanovdb::tools {}
namespace tetvdb {
namespace nanotools = nanovdb::tools;
/// nanovdb::GridType of grids of `Build`.
template <class Build>
std::uint32_t gridTypeOf() {
  return static_cast<std::uint32_t>(nanovdb::toGridType<Build>());
}
} // namespace tetvdb
#else
#define TETVDB_NANOVDB_TOOL(name) <nanovdb/util/name.h>
namespace tetvdb {
namespace nanotools = nanovdb;
template <class Build>
std::uint32_t gridTypeOf() {
  return static_cast<std::uint32_t>(nanovdb::mapToGridType<Build>());
}
} // namespace tetvdb
#endif

namespace tetvdb {

// Since OpenVDB 11 these two are classes of one number.

/// Bits of nanovdb::GridFlags.
TETVDB_HD inline std::uint32_t& flagsOf(nanovdb::GridData& grid) {
  static_assert(sizeof grid.mFlags == sizeof(std::uint32_t), "one number");
  return reinterpret_cast<std::uint32_t&>(grid.mFlags);
}
/// The checksum of the head in the lower half, that of the nodes in the upper; all bits: none.
TETVDB_HD inline std::uint64_t& checksumOf(nanovdb::GridData& grid) {
  static_assert(sizeof grid.mChecksum == sizeof(std::uint64_t), "one number");
  return reinterpret_cast<std::uint64_t&>(grid.mChecksum);
}

} // namespace tetvdb
