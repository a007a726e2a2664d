// SPDX-License-Identifier: Apache-2.0
//
// The XML of an XDMF file, with its references: XPath, in attributes, texts and XIncludes.
#pragma once

#include "tetvdb/io/source/Source.h"

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

class XdmfMarkup {
public:
  /// Throws Error(Invalid) for text that is not well-formed or not an XDMF file.
  explicit XdmfMarkup(const Source& source);

  /// The first <Domain>.
  pugi::xml_node domain() const { return domain_; }
  /// The element itself, or the one named by its Reference.
  pugi::xml_node resolved(pugi::xml_node element) const;
  /// The children of `grid` of that name, including XIncludes, resolved.
  std::vector<pugi::xml_node> children(pugi::xml_node grid, std::string_view name) const;
  /// The first of them; null if there is none.
  pugi::xml_node child(pugi::xml_node grid, std::string_view name) const;
  const std::string& path() const { return path_; }
  /// "path, <Grid> 'name' at byte N": for messages.
  std::string where(pugi::xml_node element) const;

private:
  [[noreturn]] void fail(pugi::xml_node element, const std::string& what) const;
  std::vector<pugi::xml_node> select(pugi::xml_node from, std::string_view path) const;

  std::string path_;
  pugi::xml_document document_;
  pugi::xml_node domain_;
};

/// Whether two texts are equal except for case.
bool sameWord(std::string_view a, std::string_view b);
/// The position of the colon between file and dataset in "file.h5:/path" or "file.h5:path"; npos if
/// there is none.
std::size_t datasetColon(std::string_view text);
/// The text of an element without white space around it.
std::string_view trimmedText(pugi::xml_node element);

} // namespace tetvdb
