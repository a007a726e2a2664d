// SPDX-License-Identifier: Apache-2.0
//
// Format: Wavefront, "Advanced Visualizer", appendix B1 (object files): one statement per line; a
// backslash before a line break continues it.
#include "tetvdb/io/formats/obj/ObjReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/FaceCollector.h"
#include "tetvdb/io/text/NumberParser.h"

#include <charconv>
#include <cmath>
#include <vector>

namespace tetvdb {
namespace {

class ObjText {
public:
  ObjText(const Source& source, Progress& progress)
      : source_(source), progress_(progress), at_(source.bytes.data()),
        end_(at_ + source.bytes.size()), faces_(source.path) {}

  TriangleMesh read(Report& report) {
    if (source_.bytes.substr(0, 3) == "\xef\xbb\xbf") // a byte order mark
      at_ += 3;
    for (std::size_t lines = 0; at_ != end_; ++lines) {
      if (lines % kItemsPerUpdate == 0) {
        source_.release();
        progress_.update(static_cast<double>(at_ - source_.bytes.data()) /
                         static_cast<double>(source_.bytes.size()));
      }
      readLine();
    }
    return faces_.finish(report);
  }

private:
  void readLine() {
    while (at_ != end_ && isBlank(*at_))
      ++at_;
    if (end_ - at_ > 1 && (isBlank(at_[1]) || at_[1] == '\\')) {
      if (*at_ == 'v') {
        ++at_;
        readPoint();
        return skipStatement();
      }
      if (*at_ == 'f') {
        ++at_;
        readFace();
        return skipStatement();
      }
    }
    while (at_ != end_ && !isLineBreak(*at_))
      ++at_;
  }

  /// Moves to the end of the statement.
  void skipStatement() {
    while (at_ != end_ && !isLineBreak(*at_) && *at_ != '#')
      if (*at_ != '\\' || !skipContinuation())
        ++at_;
    while (at_ != end_ && !isLineBreak(*at_)) // comments do not continue
      ++at_;
  }
  /// Skips a backslash and the following line break.
  bool skipContinuation() {
    const char* next = at_ + 1;
    while (next != end_ && isBlank(*next) && !isLineBreak(*next))
      ++next;
    if (next != end_ && !isLineBreak(*next))
      return false;
    if (next != end_ && *next++ == '\r' && next != end_ && *next == '\n')
      ++next;
    at_ = next;
    return true;
  }
  /// Returns false at the end of the statement.
  bool findWord() {
    while (at_ != end_) {
      if (*at_ == '\\' && skipContinuation())
        continue;
      if (isLineBreak(*at_) || *at_ == '#')
        return false;
      if (!isBlank(*at_))
        return true;
      ++at_;
    }
    return false;
  }
  bool atWordEnd() const { return at_ == end_ || isBlank(*at_) || *at_ == '\\'; }

  void readPoint() {
    Vec3d p{};
    for (double& x : p)
      if (!findWord() || !readReal(x))
        return faces_.addUnreadablePoint();
    faces_.addPoint(p);
  }
  bool readReal(double& value) {
    const auto [stop, error] = std::from_chars(at_, end_, value);
    if (error == std::errc() && (stop == end_ || isBlank(*stop) || *stop == '\\')) {
      at_ = stop;
      return true;
    }
    // A leading '+', Fortran's exponents, numbers out of range: rare.
    const char* start = at_;
    while (!atWordEnd())
      ++at_;
    NumberParser word({start, static_cast<std::size_t>(at_ - start)}, source_.path);
    return word.tryReal(value) && word.remaining() == 0;
  }

  void readFace() {
    corners_.clear();
    while (findWord())
      corners_.push_back(readCorner());
    faces_.addPolygon(corners_.data(), corners_.size());
  }
  /// The first of "7", "7/1", "7//3" and "7/1/3": the point, from 1, or backward from the last one
  /// if negative.
  std::uint32_t readCorner() {
    std::int64_t number = 0;
    const char* start = *at_ == '+' ? at_ + 1 : at_;
    const auto [stop, error] = std::from_chars(start, end_, number);
    at_ = stop;
    const bool whole = error == std::errc() && (atWordEnd() || *stop == '/');
    if (!whole && at_ != end_ && *at_ == '\\') // a backslash that continues nothing
      ++at_;
    while (!atWordEnd())
      ++at_;
    if (!whole)
      return FaceCollector::kNone;
    const auto index =
        number < 0 ? number + static_cast<std::int64_t>(faces_.pointCount()) : number - 1;
    return index < 0 || index >= FaceCollector::kNone ? FaceCollector::kNone
                                                      : static_cast<std::uint32_t>(index);
  }

  const Source& source_;
  Progress& progress_;
  const char* at_;
  const char* end_;
  FaceCollector faces_;
  std::vector<std::uint32_t> corners_;
};

} // namespace

TriangleMesh readObj(const Source& source, Report& report, Progress& progress) {
  return ObjText(source, progress).read(report);
}

} // namespace tetvdb
