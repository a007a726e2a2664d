// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtkSections.h"

#include "tetvdb/io/source/Advice.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tetvdb::vtk {
namespace {

// By Dataset.
constexpr std::string_view kLegacyDatasets[] = {"unstructured_grid", "polydata", "structured_grid",
                                                "rectilinear_grid", "structured_points"};

std::size_t widthOf(const std::string& keyword) {
  if (keyword == "vectors" || keyword == "normals")
    return 3;
  if (keyword == "tensors")
    return 9;
  if (keyword == "tensors6")
    return 6;
  return keyword == "global_ids" || keyword == "pedigree_ids" || keyword == "edge_flags" ? 1 : 0;
}

} // namespace

void VtkSections::readHeader() {
  const std::string first = keywordOf(text().line());
  const std::size_t version = first.find("version");
  if (first.find("vtk datafile") == first.npos)
    fail("does not begin with '# vtk DataFile Version'", kExport);
  if (version != first.npos && first.find_first_of("0123456789", version) == first.npos)
    fail("has no file version", kExport);
  text().line(); // the title
  const std::string mode = word();
  if (mode != "ascii" && mode != "binary")
    fail("the third line is neither ASCII nor BINARY", kExport);
  if (word() != "dataset")
    fail("DATASET is missing", kExport);
  const std::string_view dataset = text().word();
  const auto* known =
      std::find(std::begin(kLegacyDatasets), std::end(kLegacyDatasets), keywordOf(dataset));
  if (known == std::end(kLegacyDatasets))
    fail("holds a DATASET " + readable(dataset) +
             ", not an UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID or POLYDATA",
         "save the mesh as an unstructured grid");
  dataset_ = Dataset(known - std::begin(kLegacyDatasets));
  setBinary(mode == "binary");
}

bool VtkSections::readData(const std::string& keyword) {
  if (keyword == "point_data" || keyword == "cell_data") {
    inData_ = true;
    on_ = keyword == "point_data" ? Attribute::On::Points : Attribute::On::Cells;
    elements_ = count();
    (on_ == Attribute::On::Points ? pointElements_ : cellElements_) = elements_;
  } else if (keyword == "field") {
    readField();
  } else if (keyword == "lookup_table") {
    name();
    const std::size_t n = product(count(), 4);
    endLine();
    skipNumbers(isBinary() ? Number::UInt8 : Number::Float32, n);
  } else if (keyword == "scalars") {
    readScalars();
  } else if (keyword == "color_scalars") {
    std::string label = name();
    const std::size_t width = count();
    endLine();
    readArray(std::move(label), width, elements_, isBinary() ? Number::UInt8 : Number::Float32);
  } else if (keyword == "texture_coordinates") {
    std::string label = name();
    const std::size_t width = count();
    const Number as = type();
    endLine();
    readArray(std::move(label), width, elements_, as);
  } else if (const std::size_t width = widthOf(keyword); width > 0) {
    std::string label = name();
    const Number as = type();
    endLine();
    readArray(std::move(label), width, elements_, as);
  } else {
    return false;
  }
  return true;
}

// SCALARS name type [components], on one line.
void VtkSections::readScalars() {
  std::string label = name();
  const Number as = type();
  const std::string_view rest = text().line();
  NumberParser words(rest, where());
  std::int64_t width = 1;
  if (!words.atEnd() && (!words.tryInteger(width) || width < 1))
    fail("expected a number of components, found '" + readable(rest) + "'", kExport);
  if (next("lookup_table")) {
    name();
    endLine();
  }
  readArray(std::move(label), static_cast<std::size_t>(width), elements_, as);
}

void VtkSections::readField() {
  name();
  const std::size_t arrays = count();
  for (std::size_t i = 0; i < arrays; ++i) {
    std::string label = name();
    while (keywordOf(label) == "metadata") {
      skipMetadata();
      label = name();
    }
    if (label.empty())
      fail("the file ends within FIELD", kCut);
    if (label == "NULL_ARRAY")
      continue;
    const std::size_t width = count();
    const std::size_t tuples = count();
    const std::string word = keywordOf(text().peekWord());
    if (word == "string" || word == "utf8_string" || word == "variant") {
      text().word();
      text().line();
      skipStrings(product(width, tuples), isBinary() && word != "variant");
      continue;
    }
    const Number as = type();
    endLine();
    readArray(std::move(label), width, tuples, as);
  }
}

} // namespace tetvdb::vtk
