// SPDX-License-Identifier: Apache-2.0
//
// The grids of an XDMF document: collections in space and time, and the uniform grids in them.
#pragma once

#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

/// Refers to the markup. Methods throw Error(Invalid).
class XdmfGrids {
public:
  explicit XdmfGrids(const XdmfMarkup& markup) : markup_(markup) {}

  static bool isTemporal(pugi::xml_node grid);
  std::vector<pugi::xml_node> children(pugi::xml_node grid) const {
    return markup_.children(grid, "Grid");
  }
  /// The first temporal collection in or below `grid`; null if there is none.
  pugi::xml_node temporal(pugi::xml_node grid, std::size_t depth = 0) const;
  struct Step {
    std::size_t count = 0; ///< of the collection; 0 where there is none
    std::size_t index = 0; ///< of the one to read
  };
  /// The step `timeStep` of a temporal collection, or of none; below 0 the last one. Throws also
  /// Error(Usage) where it has no such step.
  Step step(pugi::xml_node temporal, int timeStep) const;
  /// Adds the uniform grids of `grid` at a step. Throws for other grids, and for too many.
  void uniform(pugi::xml_node grid, std::size_t step, std::vector<pugi::xml_node>& found,
               std::size_t depth = 0) const;

private:
  static std::string_view typeOf(pugi::xml_node grid) { return grid.attribute("GridType").value(); }
  static bool isCollection(pugi::xml_node grid);
  [[noreturn]] void fail(pugi::xml_node grid, const std::string& what) const;

  const XdmfMarkup& markup_;
};

} // namespace tetvdb
