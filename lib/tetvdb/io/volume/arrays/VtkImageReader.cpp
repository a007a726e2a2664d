// SPDX-License-Identifier: Apache-2.0
//
// Format: "VTK File Formats", legacy files with a DATASET STRUCTURED_POINTS.
#include "tetvdb/io/formats/vtk/VtkSections.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/VtkElement.h"

#include <utility>

namespace tetvdb {
namespace {

using namespace vtk;

class VtkImage : VtkSections {
public:
  VtkImage(const Source& source, const ArraySink& sink, Progress& progress)
      : VtkSections(source, progress), source_(source), sink_(sink) {}

  void read() {
    readHeader();
    if (dataset_ != Dataset::Image)
      fail("holds no STRUCTURED_POINTS", kExport);
    while (!text().atEnd()) {
      const std::string keyword = word();
      if (!readGeometry(keyword) && !readData(keyword))
        fail("unknown keyword '" + readable(keyword) + "'", kExport);
      source_.release();
    }
  }

private:
  bool readGeometry(const std::string& keyword) {
    if (keyword == "dimensions")
      for (std::uint64_t& points : size_)
        points = count();
    else if (keyword == "origin")
      for (double& number : origin_)
        number = text().real();
    else if (keyword == "spacing" || keyword == "aspect_ratio")
      for (double& number : spacing_)
        number = text().real();
    else if (keyword == "metadata")
      skipMetadata();
    else
      return false;
    return true;
  }

  void readArray(std::string label, std::size_t width, std::size_t tuples, Number as) override {
    const bool isCells = on_ == Attribute::On::Cells;
    StoredArray array;
    array.size = size_;
    if (isCells)
      for (std::uint64_t& size : array.size)
        size -= size > 1 ? 1 : 0;
    const auto element = elementOf(as);
    const bool fits = product(product(array.size[0], array.size[1]), array.size[2]) == tuples;
    if (!inData_ || !element || width == 0 || !fits) {
      skipNumbers(as, product(width, tuples));
      sink_.leftOut(label, fits ? "no array of numbers" : "of another length than the image");
      return;
    }
    const Array found = numbers(as, product(width, tuples));
    array.name = std::move(label);
    array.element = *element;
    array.swap = found.swap;
    array.components = width;
    array.separate = width != 3;
    array.setSteps(kXFastest);
    array.bytes = {found.data, found.count * bytesOf(*element)};
    array.placed = true;
    for (std::size_t k = 0; k < 3; ++k) {
      array.transform[5 * k] = spacing_[k];
      array.transform[4 * k + 3] = origin_[k] + (isCells ? spacing_[k] / 2 : 0);
    }
    sink_.array(array);
  }

  const Source& source_;
  const ArraySink& sink_;
  std::array<std::uint64_t, 3> size_{};
  std::array<double, 3> origin_{0, 0, 0}, spacing_{1, 1, 1};
};

} // namespace

void readVtkImage(const Source& source, const ArraySink& sink, Progress& progress) {
  VtkImage(source, sink, progress).read();
}

} // namespace tetvdb
