// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/formats/vtk/VtkArray.h"
#include "tetvdb/io/volume/arrays/ArrayLayout.h"

#include <optional>

namespace tetvdb {

/// That of arrays of VTK's files; none for bits.
inline std::optional<ElementType> elementOf(vtk::Number type) {
  for (const ElementType element : kElementTypes)
    if (namesOf(element).vtk != nullptr && vtk::xmlNumber(namesOf(element).vtk) == type)
      return element;
  return {};
}

} // namespace tetvdb
