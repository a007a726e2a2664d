// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/formats/gmsh/GmshCursor.h"

#include <cstdint>
#include <map>

namespace tetvdb {

/// Tags of an entity of dimension 3 ($Entities, $PartitionedEntities).
struct GmshVolumeTags {
  std::int32_t physical, geometrical;
};
using GmshVolumes = std::map<std::int64_t, GmshVolumeTags>;

/// A tag without its sign. Throws Error(Invalid) for one beyond 32 bits.
std::int32_t gmshTag(const GmshCursor& in, std::int64_t number);

/// Reads a section, after its first line, and adds its volumes. `old`: of version 4.0.
void readEntities(GmshCursor& in, bool partitioned, bool old, GmshVolumes& volumes);

} // namespace tetvdb
