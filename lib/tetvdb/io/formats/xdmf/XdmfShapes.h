// SPDX-License-Identifier: Apache-2.0
//
// The kinds of cells of XDMF topologies. Internal.
#pragma once

#include "tetvdb/core/Letters.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// A topology type: its cells are VTK's, nodes in VTK's order.
struct XdmfShape {
  std::string_view name;   ///< in lower case without underscores
  std::uint8_t vtk = 0;    ///< cell type
  std::uint32_t nodes = 0; ///< of each cell; 0: NodesPerElement says, or 1 and 2
  std::int64_t mixed = -1; ///< its number in a Mixed topology
};

// The numbers are those of the XDMF model and format.
inline constexpr std::array<XdmfShape, 24> kXdmfShapes{
    {{"polyvertex", 2, 0, 1},       {"polyline", 4, 0, 2},         {"polygon", 7, 0, 3},
     {"triangle", 5, 3, 4},         {"quadrilateral", 9, 4, 5},    {"tetrahedron", 10, 4, 6},
     {"pyramid", 14, 5, 7},         {"wedge", 13, 6, 8},           {"hexahedron", 12, 8, 9},
     {"edge3", 21, 3, 34},          {"quadrilateral9", 28, 9, 35}, {"triangle6", 22, 6, 36},
     {"quadrilateral8", 23, 8, 37}, {"tetrahedron10", 24, 10, 38}, {"pyramid13", 27, 13, 39},
     {"wedge15", 26, 15, 40},       {"wedge18", 32, 18, 41},       {"hexahedron20", 25, 20, 48},
     {"hexahedron24", 33, 24, 49},  {"hexahedron27", 29, 27, 50},  {"tet10", 24, 10, -1},
     {"tri6", 22, 6, -1},           {"hex20", 25, 20, -1},         {"hex27", 29, 27, -1}}};

/// A topology type in lower case without underscores.
inline std::string xdmfTypeName(std::string_view name) {
  std::string text = lowerCase(name);
  text.erase(std::remove(text.begin(), text.end(), '_'), text.end());
  return text;
}

/// The shape of that name (xdmfTypeName()); null where there is none.
inline const XdmfShape* xdmfShape(std::string_view name) {
  const auto* shape = std::find_if(kXdmfShapes.begin(), kXdmfShapes.end(),
                                   [&](const XdmfShape& known) { return known.name == name; });
  return shape == kXdmfShapes.end() ? nullptr : shape;
}

/// The shape of that number in a Mixed topology; null where there is none.
inline const XdmfShape* xdmfShapeOf(std::uint64_t number) {
  const auto* shape =
      std::find_if(kXdmfShapes.begin(), kXdmfShapes.end(), [&](const XdmfShape& known) {
        return known.mixed >= 0 && static_cast<std::uint64_t>(known.mixed) == number;
      });
  return shape == kXdmfShapes.end() ? nullptr : shape;
}

} // namespace tetvdb
