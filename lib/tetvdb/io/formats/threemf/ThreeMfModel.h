// SPDX-License-Identifier: Apache-2.0
//
// One model file of a 3MF archive.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/cells/PlacedFaces.h"
#include "tetvdb/io/formats/threemf/BeamLattice.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// A reference to an object by another one or the build.
struct ThreeMfReference {
  std::string path; ///< of the model file; empty: the same
  std::string object;
  Placement placement;
};

struct ThreeMfObject {
  std::string name;
  std::vector<Vec3d> points; ///< NAN if they cannot be read
  std::vector<std::uint32_t> triangles;
  std::vector<ThreeMfReference> components;
  BeamLattice lattice;
  bool known = false; ///< has a mesh or components
};

struct ThreeMfModel {
  std::string units; ///< "millimetre" and so on
  std::map<std::string, ThreeMfObject, std::less<>> objects;
  std::vector<ThreeMfReference> items; ///< the build
};

/// Reads the core, the production extension's paths and beam lattices; invalid corners are
/// FaceCollector::kNone. Throws Error(Invalid) with `path` and line for broken XML and transforms.
ThreeMfModel parseThreeMfModel(std::string_view text, const std::string& path, Progress& progress);

} // namespace tetvdb
