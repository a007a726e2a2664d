// SPDX-License-Identifier: Apache-2.0
//
// The grids that can be made of any mesh: one row a kind. Options, help, messages, the report,
// pictures and the Blender add-on read this table. Every other name of a grid is that of an array
// of the mesh (fields/Field.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

enum class GridKind : std::uint8_t { Density, Mask, Surface, Fog, Coverage, TetId, Material };

/// The algorithm that makes a grid's values.
enum class GridMaker : std::uint8_t {
  Occupancy, ///< which voxels are inside (voxelize/Voxelize.h)
  Owner,     ///< which cell owns a voxel (voxelize/Voxelize.h)
  Distance,  ///< the distance to the surface (fields/LevelSet.h)
  Share      ///< the share of a voxel that is inside (fields/Coverage.h)
};

struct GridKindInfo {
  GridKind kind;
  std::string_view name;       ///< in options and in a volume
  std::string_view type;       ///< of its values, as OpenVDB names it
  std::string_view gridClass;  ///< as OpenVDB names it
  std::string_view background; ///< the value outside
  std::string_view about;      ///< what an active voxel holds
  GridMaker maker;
  bool needsTets;  ///< rather than triangles
  bool needsCubes; ///< voxels whose three sides are equal
  bool onDevice;   ///< whether a GPU can find it
  bool drawsSolid; ///< whether a picture of it shows the solid
};

inline constexpr std::array<GridKindInfo, 7> kGridKinds{{
    {GridKind::Density, "density", "float", "fog volume", "0", "1 in voxels whose centre is inside",
     GridMaker::Occupancy, false, false, true, true},
    {GridKind::Mask, "mask", "bool", "unknown", "false", "true in voxels whose centre is inside",
     GridMaker::Occupancy, false, false, true, true},
    {GridKind::Surface, "surface", "float", "level set", "half-width",
     "signed distance to the surface, world units", GridMaker::Distance, false, true, true, true},
    {GridKind::Fog, "fog", "float", "fog volume", "0",
     "0 at the surface, rising to 1 a half-width inside", GridMaker::Distance, false, true, true,
     true},
    {GridKind::Coverage, "coverage", "float", "fog volume", "0",
     "share of the voxel's cube that is inside", GridMaker::Share, false, false, true, true},
    {GridKind::TetId, "tet_id", "int32", "unknown", "-1",
     "number of the input cell that owns the voxel, from 0", GridMaker::Owner, true, false, true,
     false},
    {GridKind::Material, "material", "int32", "unknown", "-1",
     "region of that cell; of triangles, number of the file, from 1", GridMaker::Owner, false,
     false, true, false},
}};

constexpr const GridKindInfo& infoOf(GridKind kind) {
  return kGridKinds[static_cast<std::size_t>(kind)];
}

/// Nothing where `name` is that of no kind.
inline std::optional<GridKind> gridKindOf(std::string_view name) {
  for (const GridKindInfo& info : kGridKinds)
    if (info.name == name)
      return info.kind;
  return {};
}

/// Names in the order of the table.
std::vector<std::string> gridKindNames();

/// "density, mask, ... and material".
std::string listGridKinds();

inline bool contains(const std::vector<GridKind>& kinds, GridKind kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// Those of `kinds` that one of `makers` makes, in their order.
std::vector<GridKind> madeBy(const std::vector<GridKind>& kinds,
                             std::initializer_list<GridMaker> makers);

/// Throws Error(Usage) where there is no kind, one twice, or one that none of `makers` makes.
void checkGridKinds(const std::vector<GridKind>& kinds, std::initializer_list<GridMaker> makers);

} // namespace tetvdb
