// SPDX-License-Identifier: Apache-2.0
//
// Converts OpenVDB to NanoVDB with NanoVDB's own builder, whose header and name depend on its
// version. Slow to compile: only for the Nvdb*Grid.cpp files.
#pragma once

#include "tetvdb/io/volume/NvdbLayout.h"

#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
#include <nanovdb/tools/CreateNanoGrid.h> // OpenVDB 12 and later
#elif __has_include(<nanovdb/util/CreateNanoGrid.h>)
#include <nanovdb/util/CreateNanoGrid.h> // OpenVDB 11
#else
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

namespace tetvdb {

template <class GridT>
NanoHandle buildNano(const GridT& grid) {
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
  return nanovdb::tools::createNanoGrid(grid, nanovdb::tools::StatsMode::All,
                                        nanovdb::CheckMode::Full);
#elif __has_include(<nanovdb/util/CreateNanoGrid.h>)
  return nanovdb::createNanoGrid(grid, nanovdb::StatsMode::All, nanovdb::ChecksumMode::Full);
#else
  return nanovdb::openToNanoVDB(grid, nanovdb::StatsMode::All, nanovdb::ChecksumMode::Full);
#endif
}

} // namespace tetvdb
