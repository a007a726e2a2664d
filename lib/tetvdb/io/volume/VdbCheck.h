// SPDX-License-Identifier: Apache-2.0
//
// Checks the whole structure of a .vdb file, header by header, without decompressing anything. It
// runs before OpenVDB's reader, which trusts the sizes that it reads: a damaged file can overflow a
// buffer, and a file cut within raw data reads as zeros. Internal to the .vdb reader.
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/VdbHeader.h"

#include <string>
#include <vector>

namespace tetvdb {

/// One grid of a .vdb file.
struct VdbGridEntry {
  std::string name;   ///< as the file's table has it, with the suffix that tells equal names apart
  std::string type;   ///< "Tree_float_5_4_3", ...
  bool known = false; ///< of KnownGrids: its structure is checked and OpenVDB may read it
  std::vector<VdbLowerPlace> lowers; ///< of a known one that is no instance
};

/// The grids of a .vdb file in the order of the file. For grids of other types than KnownGrids only
/// the place in the file is checked. Throws Error(Invalid) where `file` is not a whole .vdb file,
/// for files before version 222 (OpenVDB 3, 2015), for versions that the linked OpenVDB does not
/// know, and where a grid of an unknown type cannot be skipped (a stream without offsets). Cost: a
/// few dozen nanoseconds a leaf.
std::vector<VdbGridEntry> checkVdb(const Source& file);

} // namespace tetvdb
