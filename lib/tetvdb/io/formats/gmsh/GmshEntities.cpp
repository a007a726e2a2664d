// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/gmsh/GmshEntities.h"

#include <cstdlib>
#include <limits>

namespace tetvdb {

std::int32_t gmshTag(const GmshCursor& in, std::int64_t number) {
  // Physical tags of entities are negative if their orientation is reversed.
  constexpr std::int64_t max = std::numeric_limits<std::int32_t>::max();
  if (number < -max || number > max)
    in.fail("a tag is out of range");
  return static_cast<std::int32_t>(std::abs(number));
}

void readEntities(GmshCursor& in, bool partitioned, bool old, GmshVolumes& volumes) {
  in.enterBinary();
  if (partitioned) {
    in.size();
    const std::size_t ghosts = in.count("ghost entities", 4, 8);
    for (std::size_t i = 0; i < 2 * ghosts; ++i)
      in.integer();
  }
  std::size_t counts[4];
  for (std::size_t& n : counts)
    n = in.count("entities", 8, 4 + 3 * 8);
  for (int dimension = 0; dimension < 4; ++dimension)
    for (std::size_t i = 0; i < counts[dimension]; ++i) {
      const std::int64_t number = in.integer();
      GmshVolumeTags tags{0, gmshTag(in, number)};
      if (partitioned) {
        const std::int64_t parentDimension = in.integer();
        const std::int64_t parent = in.integer();
        if (parentDimension == 3)
          tags.geometrical = gmshTag(in, parent);
        const std::size_t partitions = in.count("partitions", 2, 4);
        for (std::size_t k = 0; k < partitions; ++k)
          in.integer();
      }
      for (int k = dimension == 0 && !old ? 3 : 6; k > 0; --k)
        in.real();
      const std::size_t groups = in.count("physical groups", 2, 4);
      for (std::size_t k = 0; k < groups; ++k) {
        const std::int64_t group = in.integer();
        if (k == 0)
          tags.physical = gmshTag(in, group);
      }
      if (dimension > 0) {
        const std::size_t bounds = in.count("bounding entities", 2, 4);
        for (std::size_t k = 0; k < bounds; ++k)
          in.integer();
      }
      if (dimension == 3)
        volumes[number] = tags;
    }
}

} // namespace tetvdb
