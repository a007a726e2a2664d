// SPDX-License-Identifier: Apache-2.0
//
// OpenVDB's reader trusts sizes that it reads: a damaged file can overflow a buffer, and one that
// is cut within raw data reads as zeros. This traverses the whole structure of a .vdb file
// beforehand, header by header, without decompressing anything. Internal to the .vdb reader.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <string>
#include <vector>

namespace tetvdb {

/// One grid of a .vdb file.
struct VdbGridEntry {
  std::string name;   ///< as the file's table has it, with the suffix that tells equal names apart
  std::string type;   ///< "Tree_float_5_4_3", ...
  bool known = false; ///< of KnownGrids: its structure is checked and OpenVDB may read it
};

/// The grids of a .vdb file in the order of the file. Grids of other types than KnownGrids are
/// checked only so far as their place in the file. Throws Error(Invalid) where `file` is not a
/// whole .vdb file, for files before version 222 (OpenVDB 3, 2015), for versions that the linked
/// OpenVDB does not know, and where a grid of an unknown type cannot be skipped (a stream without
/// offsets). Cost: a few dozen nanoseconds a leaf.
std::vector<VdbGridEntry> checkVdb(const Source& file);

} // namespace tetvdb
