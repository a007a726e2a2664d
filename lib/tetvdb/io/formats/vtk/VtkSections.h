// SPDX-License-Identifier: Apache-2.0
//
// The header of VTK's legacy files, and the sections of arrays, which all kinds of data sets share.
#pragma once

#include "tetvdb/io/formats/vtk/VtkCells.h"
#include "tetvdb/io/formats/vtk/VtkInput.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstddef>
#include <optional>
#include <string>

namespace tetvdb::vtk {

/// Methods throw Error(Invalid) where the file has something else.
class VtkSections : public VtkInput {
public:
  VtkSections(const Source& source, Progress& progress) : VtkInput(source, progress) {}
  virtual ~VtkSections() = default;

protected:
  /// Up to the kind of data set.
  void readHeader();
  /// A section of arrays that begins with this word; false for other words.
  bool readData(const std::string& keyword);
  /// The next `width` * `tuples` numbers are those of an array: reads or skips them.
  virtual void readArray(std::string label, std::size_t width, std::size_t tuples, Number as) = 0;

  Dataset dataset_ = Dataset::Unstructured;
  // The section to which arrays belong; preceding field data are the dataset's.
  bool inData_ = false;
  Attribute::On on_ = Attribute::On::Points;
  std::size_t elements_ = 0;
  std::optional<std::size_t> pointElements_, cellElements_;

private:
  void readScalars();
  void readField();
};

} // namespace tetvdb::vtk
