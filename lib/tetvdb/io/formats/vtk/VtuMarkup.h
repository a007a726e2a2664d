// SPDX-License-Identifier: Apache-2.0
//
// The markup of a VTK XML file without its data, so that the XML parser processes only kilobytes
// and no raw bytes.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <pugixml.hpp>
#include <string>
#include <string_view>

namespace tetvdb::vtk {

/// Bytes of a file.
struct Excerpt {
  std::size_t begin = 0;
  std::string_view bytes;
};

/// A VTK XML file, parsed.
class VtuMarkup {
public:
  /// Throws Error(Invalid) for text that is not well-formed or ends early.
  explicit VtuMarkup(const Source& source);

  /// <VTKFile>.
  pugi::xml_node root() const { return document_.child("VTKFile"); }
  /// The text directly within `node`, without surrounding white space.
  Excerpt text(pugi::xml_node node) const;
  /// The data after the '_' of <AppendedData>; empty if the file has none.
  const Excerpt& appended() const { return appended_; }
  bool appendedIsRaw() const { return appendedIsRaw_; }

private:
  Source source_;
  pugi::xml_document document_;
  Excerpt appended_;
  bool appendedIsRaw_ = false;
};

} // namespace tetvdb::vtk
