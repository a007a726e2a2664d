// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/xdmf/XdmfMarkup.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/source/Advice.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxReferences = 16; // successive references
// The evaluation of longer paths, or of more predicates, could take very long.
constexpr std::size_t kLongestPath = 400;
constexpr auto kMaxPredicates = 8, kMaxDescents = 3; // each may visit the whole document

} // namespace

bool sameWord(std::string_view a, std::string_view b) {
  return lowerCase(a) == lowerCase(b);
}

std::size_t datasetColon(std::string_view text) {
  const std::size_t colon = text.rfind(":/");
  return colon != std::string_view::npos ? colon : text.rfind(':');
}

std::string_view trimmedText(pugi::xml_node element) {
  return trimmed(element.text().get());
}

XdmfMarkup::XdmfMarkup(const Source& source) : path_(source.path) {
  const pugi::xml_parse_result parsed =
      document_.load_buffer(source.bytes.data(), source.bytes.size());
  if (!parsed)
    throw Error(Status::Invalid,
                path_ + " at byte " + std::to_string(std::max<std::ptrdiff_t>(parsed.offset, 0)),
                std::string("the XML is not well-formed: ") + parsed.description(), kCut);
  const pugi::xml_node root = document_.child("Xdmf");
  domain_ = root.child("Domain");
  if (!root || !domain_)
    throw Error(Status::Invalid, path_, root ? "has no <Domain>" : "has no <Xdmf>",
                "export it again");
}

std::string XdmfMarkup::where(pugi::xml_node element) const {
  std::string text = path_ + ", <" + element.name() + ">";
  if (const char* name = element.attribute("Name").value(); *name != 0)
    text += std::string(" '") + name + "'";
  return text + " at byte " + std::to_string(std::max<std::ptrdiff_t>(element.offset_debug(), 0));
}

void XdmfMarkup::fail(pugi::xml_node element, const std::string& what) const {
  throw Error(Status::Invalid, where(element), what, kExport);
}

std::vector<pugi::xml_node> XdmfMarkup::select(pugi::xml_node from, std::string_view path) const {
  int descents = 0;
  for (const char* axis : {"//", "descendant", "ancestor", "following", "preceding"})
    for (std::size_t at = path.find(axis); at != path.npos; at = path.find(axis, at + 1))
      ++descents;
  if (path.size() > kLongestPath || descents > kMaxDescents ||
      std::count(path.begin(), path.end(), '[') > kMaxPredicates)
    fail(from, "refers to something by a path that is too long or too complex");
  std::vector<pugi::xml_node> nodes;
  try {
    for (const pugi::xpath_node& found : from.select_nodes(std::string(path).c_str()))
      if (found.node())
        nodes.push_back(found.node());
  } catch (const pugi::xpath_exception&) {
    fail(from, "refers to something by '" + std::string(path) + "', which is no path");
  }
  return nodes;
}

pugi::xml_node XdmfMarkup::resolved(pugi::xml_node element) const {
  for (std::size_t step = 0; step < kMaxReferences; ++step) {
    std::string_view reference = element.attribute("Reference").value();
    if (reference.empty())
      return element;
    if (sameWord(reference, "XML")) // version 2: the path is the text
      reference = trimmedText(element);
    const std::vector<pugi::xml_node> found = select(element, reference);
    if (found.empty())
      fail(element, "refers to '" + std::string(reference) + "', which is not there");
    element = found.front();
  }
  fail(element, "refers to itself, or through too many others");
}

std::vector<pugi::xml_node> XdmfMarkup::children(pugi::xml_node grid, std::string_view name) const {
  std::vector<pugi::xml_node> all;
  const auto add = [&](pugi::xml_node node) {
    if (name == node.name())
      all.push_back(resolved(node));
  };
  for (const pugi::xml_node child : grid.children()) {
    // For any prefix: usually xi, ns0 if Python's xml module chose it (meshio).
    std::string_view tag = child.name();
    tag.remove_prefix(std::min(tag.size(), tag.find(':') + 1));
    if (tag != "include") {
      add(child);
      continue;
    }
    // xpointer(PATH); other files are not included.
    std::string_view pointer = child.attribute("xpointer").value();
    constexpr std::string_view kStart = "xpointer(";
    if (pointer.substr(0, kStart.size()) != kStart || pointer.back() != ')')
      fail(child, "includes something by another way than xpointer()");
    if (const char* href = child.attribute("href").value(); *href != 0)
      fail(child, std::string("includes the file '") + href + "', which is not read");
    pointer.remove_prefix(kStart.size());
    pointer.remove_suffix(1);
    const std::vector<pugi::xml_node> found = select(child, pointer);
    if (found.empty())
      fail(child, "includes '" + std::string(pointer) + "', which is not there");
    for (const pugi::xml_node node : found)
      add(node);
  }
  return all;
}

pugi::xml_node XdmfMarkup::child(pugi::xml_node grid, std::string_view name) const {
  const std::vector<pugi::xml_node> all = children(grid, name);
  return all.empty() ? pugi::xml_node() : all.front();
}

} // namespace tetvdb
