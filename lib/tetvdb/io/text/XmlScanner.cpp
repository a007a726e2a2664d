// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/XmlScanner.h"

#include "tetvdb/core/Error.h"

#include <algorithm>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxDepth = 1000;

bool isSpace(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t';
}

std::string_view withoutPrefix(std::string_view name) {
  const std::size_t colon = name.find(':');
  return colon == name.npos ? name : name.substr(colon + 1);
}

} // namespace

void XmlScanner::fail(std::string_view what) const {
  const std::string_view before = text_.substr(0, at_);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  throw Error(Status::Invalid, path_ + ":" + std::to_string(line), what,
              "the file is damaged; export it again");
}

void XmlScanner::skipTo(std::string_view mark) {
  const std::size_t end = text_.find(mark, at_);
  if (end == text_.npos)
    fail("the text ends within a tag");
  at_ = end + mark.size();
}

void XmlScanner::skipSpace() {
  while (at_ < text_.size() && isSpace(text_[at_]))
    ++at_;
}

std::string_view XmlScanner::readName() {
  const std::size_t start = at_;
  while (at_ < text_.size() && !isSpace(text_[at_]) && text_[at_] != '=' && text_[at_] != '>' &&
         text_[at_] != '/' && text_[at_] != '<' && text_[at_] != '"' && text_[at_] != '\'')
    ++at_;
  if (at_ == start)
    fail("a tag is broken");
  return text_.substr(start, at_ - start);
}

bool XmlScanner::next() {
  if (begins_ && empty_) {
    begins_ = empty_ = false;
    open_.pop_back();
    return true;
  }
  for (;;) {
    at_ = std::min(text_.find('<', at_), text_.size());
    if (at_ == text_.size()) {
      if (!open_.empty())
        fail("the text ends before its elements do");
      return false;
    }
    const std::string_view rest = text_.substr(at_);
    if (rest.substr(0, 4) == "<!--")
      skipTo("-->");
    else if (rest.substr(0, 9) == "<![CDATA[")
      skipTo("]]>");
    else if (rest.substr(0, 2) == "<?")
      skipTo("?>");
    else if (rest.substr(0, 2) == "<!")
      skipTo(">");
    else if (rest.substr(0, 2) == "</")
      return readEnd(), true;
    else
      return readBegin();
  }
}

void XmlScanner::readEnd() {
  at_ += 2;
  const std::string_view name = readName();
  skipSpace();
  if (open_.empty() || open_.back() != name || at_ == text_.size() || text_[at_] != '>')
    fail("an element ends that did not begin");
  ++at_;
  open_.pop_back();
  name_ = withoutPrefix(name);
  begins_ = false;
}

bool XmlScanner::readBegin() {
  ++at_;
  const std::string_view name = readName();
  attributes_.clear();
  for (;;) {
    skipSpace();
    if (at_ == text_.size())
      fail("the text ends within a tag");
    if (text_[at_] == '>' || text_[at_] == '/')
      break;
    const std::string_view key = readName();
    skipSpace();
    if (at_ == text_.size() || text_[at_] != '=')
      fail("an attribute has no value");
    ++at_;
    skipSpace();
    const char quote = at_ < text_.size() ? text_[at_] : ' ';
    const std::size_t end = text_.find(quote, at_ + 1);
    if ((quote != '"' && quote != '\'') || end == text_.npos)
      fail("an attribute has no value in quotes");
    attributes_.emplace_back(key, text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
  }
  empty_ = text_[at_] == '/';
  if (empty_ && (++at_ == text_.size() || text_[at_] != '>'))
    fail("a tag is broken");
  ++at_;
  if (open_.size() >= kMaxDepth)
    fail("elements are nested more than 1000 times");
  open_.push_back(name);
  name_ = withoutPrefix(name);
  begins_ = true;
  return true;
}

std::string_view XmlScanner::around(std::size_t level) const {
  const std::size_t own = begins_ ? 1 : 0; // the element itself is open
  return level + own > open_.size() ? std::string_view()
                                    : withoutPrefix(open_[open_.size() - level - own]);
}

std::string_view XmlScanner::attribute(std::string_view name) const {
  const bool prefixed = name.find(':') != name.npos;
  for (const auto& [key, value] : attributes_)
    if (prefixed ? key == name : withoutPrefix(key) == name)
      return value;
  return {};
}

} // namespace tetvdb
