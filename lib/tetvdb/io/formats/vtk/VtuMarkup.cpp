// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/formats/vtk/VtuMarkup.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace tetvdb::vtk {
namespace {

// Larger markup is refused: it would need several gigabytes as a document.
constexpr std::size_t kMaxMarkup = std::size_t(1) << 27;

bool isSpace(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

/// Copies tags, and replaces each text by its "offset length". Comments and CDATA are omitted.
class Skeleton {
public:
  explicit Skeleton(const Source& source) : path_(source.path), bytes_(source.bytes) {}

  void scan() {
    const std::size_t first = bytes_.find('<');
    if (first == bytes_.npos)
      fail(0, "no XML");
    at_ = first;
    note();
    while (at_ < bytes_.size()) {
      if (bytes_[at_] != '<')
        text();
      else if (starts("<!--"))
        skip("-->");
      else if (starts("<![CDATA["))
        skip("]]>");
      else if (tag())
        return;
    }
    fail(at_, "the file ends within its markup: it is cut off");
  }

  /// Offset in the file of byte `at` of the markup.
  std::size_t fileOffset(std::size_t at) const {
    auto next = std::upper_bound(notes_.begin(), notes_.end(), std::pair(at, SIZE_MAX));
    return next == notes_.begin() ? 0 : at - (--next)->first + next->second;
  }

  std::string markup;
  std::size_t appendedBegin = 0; ///< after the tag <AppendedData ...>; 0: there is none

  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw Error(Status::Invalid, path_ + " at byte " + std::to_string(at), what, kExport);
  }

private:
  bool starts(std::string_view what) const { return bytes_.substr(at_, what.size()) == what; }
  void note() { notes_.emplace_back(markup.size(), at_); }

  void skip(std::string_view end) {
    const std::size_t found = bytes_.find(end, at_);
    if (found == bytes_.npos)
      fail(at_, "the file ends within its markup: it is cut off");
    at_ = found + end.size();
    note();
  }

  void text() {
    std::size_t end = bytes_.find('<', at_);
    if (end == bytes_.npos)
      fail(bytes_.size(), "the file ends within its data: it is cut off");
    std::size_t begin = at_;
    while (begin < end && isSpace(bytes_[begin]))
      ++begin;
    at_ = end;
    while (end > begin && isSpace(bytes_[end - 1]))
      --end;
    if (begin == end)
      return note();
    markup += std::to_string(begin) + ' ' + std::to_string(end - begin);
    note();
  }

  // Returns true if nothing relevant follows.
  bool tag() {
    std::size_t end = at_ + 1;
    for (char quote = 0; end < bytes_.size() && (quote != 0 || bytes_[end] != '>'); ++end) {
      const char c = bytes_[end];
      if (quote == 0 && (c == '"' || c == '\''))
        quote = c;
      else if (c == quote)
        quote = 0;
    }
    if (end == bytes_.size())
      fail(at_, "a tag does not end: the file is cut off");
    const std::string_view found = bytes_.substr(at_, end + 1 - at_);
    if (markup.size() + found.size() > kMaxMarkup)
      fail(at_, "more markup than a mesh can need");
    markup += found;
    at_ = end + 1;
    if (found.substr(0, 13) == "<AppendedData") {
      appendedBegin = at_;
      if (found[found.size() - 2] != '/')
        markup += "</AppendedData>";
      markup += "</VTKFile>";
      return true;
    }
    return found.substr(0, 9) == "</VTKFile";
  }

  const std::string& path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> notes_; // markup offset, file offset
};

} // namespace

VtuMarkup::VtuMarkup(const Source& source) : source_(source) {
  Skeleton skeleton(source);
  skeleton.scan();
  const auto result = document_.load_buffer(skeleton.markup.data(), skeleton.markup.size(),
                                            pugi::parse_default, pugi::encoding_utf8);
  const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0));
  if (!result)
    skeleton.fail(skeleton.fileOffset(offset),
                  std::string("not well-formed XML (") + result.description() + ")");
  if (!root())
    skeleton.fail(0, "no <VTKFile> element: not a VTK XML file");
  if (skeleton.appendedBegin == 0)
    return;

  const std::string_view encoding = root().child("AppendedData").attribute("encoding").value();
  if (encoding != "raw" && encoding != "base64" && !encoding.empty())
    skeleton.fail(skeleton.appendedBegin,
                  "appended data in an unknown encoding; raw and base64 are known");
  appendedIsRaw_ = encoding == "raw";
  std::size_t begin = skeleton.appendedBegin;
  while (begin < source.bytes.size() && isSpace(source.bytes[begin]))
    ++begin;
  if (begin == source.bytes.size() || source.bytes[begin] != '_')
    skeleton.fail(begin, "appended data do not begin with '_'");
  ++begin;
  // Raw data may contain anything: it ends at the last closing tag of the file.
  const std::size_t end =
      appendedIsRaw_ ? source.bytes.rfind("</AppendedData") : source.bytes.find('<', begin);
  appended_ = {begin, source.bytes.substr(begin, end == source.bytes.npos || end < begin
                                                     ? source.bytes.npos
                                                     : end - begin)};
}

Excerpt VtuMarkup::text(pugi::xml_node node) const {
  const std::string_view reference = node.child_value();
  if (reference.empty())
    return {source_.bytes.size(), {}};
  NumberParser in(reference, source_.path);
  const auto begin = static_cast<std::size_t>(in.integer());
  // Where a quotation mark is missing, the file's own text stands here.
  if (begin > source_.bytes.size())
    throw Error(Status::Invalid, source_.path, "the quotation marks of its tags are not in pairs",
                kExport);
  return {begin, source_.bytes.substr(begin, static_cast<std::size_t>(in.integer()))};
}

} // namespace tetvdb::vtk
