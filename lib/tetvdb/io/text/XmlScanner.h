// SPDX-License-Identifier: Apache-2.0
//
// Iterates over the tags of an XML text, without a tree in memory.
//
//   tetvdb::XmlScanner in(text, "a.3mf, 3D/3dmodel.model");
//   while (in.next())
//     if (in.begins() && in.name() == "vertex") addVertex(in.attribute("x"), ...);
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetvdb {

/// Names are without their namespace's prefix. Comments, CDATA and declarations are skipped;
/// entities are not decoded. UTF-8.
class XmlScanner {
public:
  /// `text` must outlive the scanner; `path` is for messages.
  XmlScanner(std::string_view text, std::string path) : text_(text), path_(std::move(path)) {}

  /// Moves to the next begin or end of an element (an empty one has both); false at the end of the
  /// text. Throws Error(Invalid) with the line if a tag is incomplete, elements are not nested or
  /// nested more than 1000 times, or the text ends within one.
  bool next();
  bool begins() const { return begins_; }
  /// Of the element that begins or ends.
  std::string_view name() const { return name_; }
  /// The name of an enclosing element: 1 is the parent; empty if there is none.
  std::string_view around(std::size_t level) const;
  /// An attribute of the element that begins; empty if there is none of that name. A prefix is
  /// compared only if `name` has one.
  std::string_view attribute(std::string_view name) const;

  /// What stands between the begin of the element and the next tag.
  std::string_view text() const {
    return empty_ ? std::string_view() : text_.substr(at_, text_.find('<', at_) - at_);
  }

  std::size_t position() const { return at_; }
  [[noreturn]] void fail(std::string_view what) const;

private:
  void skipTo(std::string_view mark);
  bool readBegin();
  void readEnd();
  std::string_view readName();
  void skipSpace();

  std::string_view text_;
  std::string path_;
  std::size_t at_ = 0;
  std::vector<std::string_view> open_; ///< names with prefixes
  std::vector<std::pair<std::string_view, std::string_view>> attributes_;
  std::string_view name_;
  bool begins_ = false;
  bool empty_ = false; ///< the element that has begun is empty
};

} // namespace tetvdb
