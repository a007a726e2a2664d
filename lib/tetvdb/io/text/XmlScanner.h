// SPDX-License-Identifier: Apache-2.0
//
// The tags of an XML text, one after the other, without a tree in memory.
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

/// Names come without their namespace's prefix. Text between tags, comments, CDATA and declarations
/// are passed over; entities are left as they stand. UTF-8.
class XmlScanner {
public:
  /// `text` must outlive the scanner; `path` is for messages.
  XmlScanner(std::string_view text, std::string path) : text_(text), path_(std::move(path)) {}

  /// Moves to the next begin or end of an element (an empty one has both); false at the end of the
  /// text. Throws Error(Invalid) with the line where a tag is not whole, elements are not nested or
  /// nested more than 1000 times, or the text ends within one.
  bool next();
  bool begins() const { return begins_; }
  /// Of the element that begins or ends.
  std::string_view name() const { return name_; }
  /// The name of an element around it: 1 is the parent; empty where there is none.
  std::string_view around(std::size_t level) const;
  /// Of the element that begins; empty where there is none of that name. A prefix matters only
  /// where `name` has one.
  std::string_view attribute(std::string_view name) const;

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
  bool empty_ = false; ///< the element that has begun ends at once
};

} // namespace tetvdb
