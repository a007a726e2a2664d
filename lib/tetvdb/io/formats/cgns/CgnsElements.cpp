// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/cgns/CgnsElements.h"

#include "tetvdb/io/formats/vtk/VtkCells.h"

#include <string>

namespace tetvdb {
namespace {

// SIDS, "unstructured grid element numbering conventions": the mids of vertical edges come before
// those above, the middles of faces bottom, front, right, back, left, top.
constexpr std::uint8_t kCgnsHexahedronOrder[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,
                                                 9,  10, 11, 16, 17, 18, 19, 12, 13,
                                                 14, 15, 24, 22, 21, 23, 20, 25, 26};
constexpr std::uint8_t kCgnsWedgeOrder[] = {0,  1,  2,  3, 4,  5,  6,  7,  8,
                                            12, 13, 14, 9, 10, 11, 15, 16, 17};

CellKind quadratic(const char* name, CellType type, std::uint32_t corners, std::uint32_t nodes,
                   const std::uint8_t* order = nullptr) {
  const std::uint32_t kept = keptNodes(type, nodes);
  return {name, type, corners, nodes, kept, kept != 0 ? order : nullptr};
}

} // namespace

CellKind cgnsElement(ElementType_t type) {
  switch (type) {
  case TETRA_4:
    return {"TETRA_4", CellType::Tetra, 4, 4};
  case TETRA_10:
    return quadratic("TETRA_10", CellType::Tetra, 4, 10);
  case PYRA_5:
    return {"PYRA_5", CellType::Pyramid, 5, 5};
  case PYRA_13:
    return quadratic("PYRA_13", CellType::Pyramid, 5, 13);
  case PYRA_14:
    return quadratic("PYRA_14", CellType::Pyramid, 5, 14);
  case PENTA_6:
    return {"PENTA_6", CellType::Wedge, 6, 6};
  case PENTA_15:
    return quadratic("PENTA_15", CellType::Wedge, 6, 15, kCgnsWedgeOrder);
  case PENTA_18:
    return quadratic("PENTA_18", CellType::Wedge, 6, 18, kCgnsWedgeOrder);
  case HEXA_8:
    return {"HEXA_8", CellType::Hexahedron, 8, 8};
  case HEXA_20:
    return quadratic("HEXA_20", CellType::Hexahedron, 8, 20, kCgnsHexahedronOrder);
  case HEXA_27:
    return quadratic("HEXA_27", CellType::Hexahedron, 8, 27, kCgnsHexahedronOrder);
  default:
    break;
  }
  int nodes = 0;
  if (cg_npe(type, &nodes) != CG_OK || nodes < 1)
    return {"", CellType::OtherSolid, 0, 0};
  const auto each = static_cast<std::uint32_t>(nodes);
  const std::string name = cg_ElementTypeName(type);
  const bool flat = name.rfind("NODE", 0) == 0 || name.rfind("BAR", 0) == 0 ||
                    name.rfind("TRI_", 0) == 0 || name.rfind("QUAD_", 0) == 0;
  return {cg_ElementTypeName(type), flat ? CellType::Flat : CellType::OtherSolid, 0, each};
}

std::uint32_t polygonCorners(const CellKind& kind) {
  const std::string name = kind.name;
  return name.rfind("TRI_", 0) == 0 ? 3 : name.rfind("QUAD_", 0) == 0 ? 4 : 0;
}

} // namespace tetvdb
