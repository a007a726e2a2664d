// SPDX-License-Identifier: Apache-2.0
//
// One model file of a 3MF archive.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/cells/PlacedFaces.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// An object that another one, or the build, places.
struct ThreeMfReference {
  std::string path; ///< of the model file; empty: the same
  std::string object;
  Placement placement;
};

struct ThreeMfObject {
  std::string name;
  std::vector<Vec3d> points; ///< NAN where they cannot be read
  std::vector<std::uint32_t> triangles;
  std::vector<ThreeMfReference> components;
  bool known = false; ///< holds a mesh or components
};

struct ThreeMfModel {
  std::string units; ///< "millimetre" and so on
  std::map<std::string, ThreeMfObject, std::less<>> objects;
  std::vector<ThreeMfReference> items; ///< the build
  std::uint64_t beams = 0;
};

/// Reads the core and the production extension's paths; corners that are no numbers are
/// FaceCollector::kNone. Throws Error(Invalid) with `path` and line for broken XML and transforms.
ThreeMfModel parseThreeMfModel(std::string_view text, const std::string& path, Progress& progress);

} // namespace tetvdb
