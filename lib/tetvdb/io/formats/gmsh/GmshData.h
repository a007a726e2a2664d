// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Report.h"
#include "tetvdb/io/cells/IdMap.h"
#include "tetvdb/io/formats/gmsh/GmshCursor.h"
#include "tetvdb/mesh/Attribute.h"
#include "tetvdb/mesh/SpooledMesh.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace tetvdb {

/// The $NodeData and $ElementData sections of one .msh file.
class GmshData {
public:
  GmshData(GmshCursor& in, std::size_t fileBytes, Report& report)
      : in_(in), fileBytes_(fileBytes), report_(report) {}

  /// From now on arrays are put into `mesh`; those of cells have a value for every element, until
  /// finish() leaves out elements without a volume: eachRun(visit) calls visit(elements, solid).
  void spoolTo(SpooledMesh& mesh) { spool_ = &mesh; }
  using VisitRun = std::function<void(std::size_t, bool)>;
  void finish(const std::function<void(const VisitRun&)>& eachRun);

  /// Reads a section, after its first line, into a new array of `attributes` or that of another
  /// time step. `ids` numbers the `things` nodes or elements; those without a value have NaN.
  void read(Attribute::On on, const IdMap& ids, std::size_t things,
            std::vector<Attribute>& attributes);

private:
  /// Where the values of a section go.
  struct Target {
    std::vector<double>* values = nullptr;
    FileSpool* spool = nullptr;
  };
  Target target(std::vector<Attribute>& attributes, const std::string& name, Attribute::On on,
                std::size_t components, std::size_t things, std::int64_t step);
  Target spooled(const std::string& name, Attribute::On on, std::size_t components,
                 std::size_t things, std::int64_t step);
  /// The array to fill: a new one, or that of an equal or earlier time step; empty for a time step
  /// before the existing one.
  std::vector<double>& array(std::vector<Attribute>& attributes, const std::string& name,
                             Attribute::On on, std::size_t components, std::size_t things,
                             std::int64_t step);

  GmshCursor& in_;
  std::size_t fileBytes_;
  Report& report_;
  SpooledMesh* spool_ = nullptr;
  std::size_t size_ = 0;            ///< numbers in all arrays
  std::vector<std::int64_t> steps_; ///< time step of each array
  std::vector<double> ignored_;
};

} // namespace tetvdb
