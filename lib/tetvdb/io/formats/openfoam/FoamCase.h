// SPDX-License-Identifier: Apache-2.0
//
// What files an OpenFOAM case has: its parts (processors, regions), its times, and for each the
// latest mesh.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb::openfoam {

/// A mesh of the case.
struct CasePart {
  std::string folder; ///< within the case: "", or "processor3"
  std::string region; ///< of a case with several meshes: a name; else ""
};

/// A field of a time.
struct FieldFile {
  std::string name, path;
};

/// Paths are resolved by pathWithin(), in the case's folder.
class FoamCase {
public:
  /// The case that a .foam file lies in, or that a `system/controlDict` belongs to. Throws
  /// Error(Invalid) where there is no mesh.
  explicit FoamCase(const Source& source);

  const std::vector<CasePart>& parts() const { return parts_; }
  /// Ascending; empty where the case has none.
  const std::vector<double>& times() const { return times_; }
  /// The file "points", "faces", "owner", ... of a part's mesh at a time (none: where the case has
  /// none), which is the latest that was written up to then.
  std::optional<std::string> meshFile(const CasePart& part, std::optional<std::size_t> time,
                                      const std::string& name) const;
  /// By name.
  std::vector<FieldFile> fields(const CasePart& part, std::size_t time) const;

private:
  void takeTimes(const std::string& folder, std::vector<double>& times,
                 std::vector<std::string>& names) const;
  void takeParts(const std::string& folder, std::vector<CasePart>& parts) const;
  std::optional<std::string> file(const std::string& name) const;
  bool hasFolder(const std::string& name) const;

  std::string path_;   ///< of what was opened
  std::string folder_; ///< of the case
  std::vector<CasePart> parts_;
  std::vector<double> times_;
  std::vector<std::string> timeNames_;
};

} // namespace tetvdb::openfoam
