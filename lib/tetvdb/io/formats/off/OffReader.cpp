// SPDX-License-Identifier: Apache-2.0
//
// Format: Geomview manual, "OFF files". The keyword may have its counts attached, as in ModelNet's
// files.
#include "tetvdb/io/formats/off/OffReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/FaceCollector.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cmath>
#include <vector>

namespace tetvdb {
namespace {

struct OffKeyword {
  std::size_t length = 0; ///< 0: none
  std::size_t width = 3;  ///< numbers per vertex
  bool fourD = false, manyD = false;
};

/// [ST][C][N][4][n]OFF, in any case; counts may follow directly.
OffKeyword parseKeyword(std::string_view text) {
  OffKeyword keyword;
  std::size_t at = 0;
  const auto skip = [&](std::string_view upper) {
    for (std::size_t k = 0; k < upper.size(); ++k) {
      if (at + k >= text.size())
        return false;
      const char c = text[at + k];
      if (c != upper[k] && c != static_cast<char>(upper[k] - 'A' + 'a'))
        return false;
    }
    at += upper.size();
    return true;
  };
  if (skip("ST"))
    keyword.width += 2;
  if (skip("C"))
    keyword.width += 4;
  if (skip("N") && at < text.size() && (text[at] == 'O' || text[at] == 'o' || text[at] == '4'))
    keyword.width += 3;
  if (at < text.size() && text[at] == '4') {
    keyword.fourD = true;
    ++at;
  }
  if (at < text.size() && text[at] == 'n') {
    keyword.manyD = true;
    ++at;
  }
  if (!skip("OFF"))
    return {};
  const bool ends = at == text.size() || static_cast<unsigned char>(text[at]) <= ' ' ||
                    (text[at] >= '0' && text[at] <= '9') || text[at] == '#';
  keyword.length = ends ? at : 0;
  return keyword;
}

void warnOfMissingFaces(Report& report, std::uint64_t declared, std::uint64_t found) {
  report.warn("truncated", std::to_string(declared) + " faces are declared, " +
                               std::to_string(found) + " are there: the file is cut off");
  report.partial = true;
}

class OffText {
public:
  OffText(const Source& source, std::size_t begin, std::size_t width, Report& report,
          Progress& progress)
      : source_(source), width_(width), report_(report), progress_(progress),
        in_(source, '#', begin), faces_(source.path) {}

  TriangleMesh read() {
    const std::size_t points = in_.count("vertices", 2 * 3);
    const std::int64_t faces = in_.integer();
    if (faces < 0)
      in_.fail("negative number of faces");
    skipEdgeCount();
    // Declared faces beyond the file's size do not exist: no memory is reserved for them.
    const auto wanted = static_cast<std::uint64_t>(faces);
    faces_.reserve(points, static_cast<std::size_t>(
                               std::min<std::uint64_t>(wanted, in_.remaining() / (2 * 4))));
    lines_ = numbersOnLine() < 2 * width_ || linesFollow(points);
    readPoints(points);
    readFaces(wanted);
    return faces_.finish(report_);
  }

private:
  /// Numbers from the cursor to the end of the next line that has any; the cursor does not move.
  std::size_t numbersOnLine() {
    const std::size_t start = in_.position();
    in_.skipSpace();
    NumberParser line(in_.line(), source_.path, '#');
    in_.seek(start);
    std::size_t n = 0;
    while (!line.word().empty())
      ++n;
    return n;
  }

  /// Whether there are at least `n` more lines: otherwise several vertices share one.
  bool linesFollow(std::size_t n) {
    const std::size_t start = in_.position();
    for (; n > 0 && !in_.atEnd(); --n)
      in_.line();
    in_.seek(start);
    return n == 0;
  }

  /// The edge count may be missing, or be on a separate line.
  void skipEdgeCount() {
    const std::size_t start = in_.position();
    NumberParser rest(in_.line(), source_.path, '#');
    if (!rest.atEnd()) {
      // All counts may be on this line, and the edge count is an integer.
      in_.seek(start);
      std::int64_t edges = 0;
      in_.tryInteger(edges);
      return;
    }
    if (numbersOnLine() == 1)
      in_.word();
  }

  double number() {
    double value = NAN;
    if (in_.tryReal(value) && in_.atWordEnd())
      return value;
    in_.word();
    return NAN;
  }
  std::uint32_t index() {
    std::int64_t value = 0;
    if (in_.tryInteger(value) && in_.atWordEnd())
      return value < 0 || value >= FaceCollector::kNone ? FaceCollector::kNone
                                                        : static_cast<std::uint32_t>(value);
    in_.word();
    return FaceCollector::kNone;
  }

  void readPoints(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      if (in_.atEnd())
        in_.fail("the file ends after " + std::to_string(i) + " of " + std::to_string(n) +
                     " vertices, before the faces",
                 "it is cut off; export it again");
      Vec3d p{};
      for (double& x : p)
        x = number();
      faces_.addPoint(p);
      if (lines_)
        in_.line(); // normals, colours
      else
        for (std::size_t k = 3; k < width_; ++k)
          number();
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  void readFaces(std::uint64_t n) {
    for (std::uint64_t i = 0; i < n; ++i) {
      if (in_.atEnd())
        return warnOfMissingFaces(report_, n, i);
      std::int64_t corners = 0;
      const bool whole = in_.tryInteger(corners) && in_.atWordEnd() && corners >= 0;
      if (!whole || static_cast<std::uint64_t>(corners) > in_.remaining() / 2) {
        in_.line();
        if (whole && in_.atEnd())
          return warnOfMissingFaces(report_, n, i);
        faces_.addUnreadableFace();
        continue;
      }
      corners_.clear();
      for (std::int64_t k = 0; k < corners && !in_.atEnd(); ++k)
        corners_.push_back(index());
      const bool tooFew = corners_.size() < static_cast<std::size_t>(corners);
      if (in_.remaining() == 0 &&
          (tooFew || (i + 1 < n && corners > 0 && faces_.mayBeCut(corners_.back()))))
        return warnOfMissingFaces(report_, n, i);
      faces_.addPolygon(corners_.data(), corners_.size());
      if (lines_)
        in_.line(); // colours
      if (i % kItemsPerUpdate == 0)
        update();
    }
  }

  void update() {
    source_.release();
    progress_.update(static_cast<double>(in_.position()) /
                     static_cast<double>(source_.bytes.size()));
  }

  const Source& source_;
  std::size_t width_;
  Report& report_;
  Progress& progress_;
  NumberParser in_;
  FaceCollector faces_;
  std::vector<std::uint32_t> corners_;
  bool lines_ = true;
};

/// Big-endian: three counts, floats of the vertices, and a face's corners, colour components and
/// colours.
TriangleMesh readOffBinary(const Source& source, std::size_t begin, std::size_t width,
                           Report& report, Progress& progress) {
  const bool swap = true; // of this library's machines, which are little-endian
  ByteReader in(source, swap, begin);
  const std::size_t points = in.checkCount(in.get<std::int32_t>(), 4 * width, "vertices");
  const auto faces = in.get<std::int32_t>();
  in.get<std::int32_t>();
  if (faces < 0)
    in.fail("negative number of faces");
  in.checkCount(points, 4 * width, "vertices");
  FaceCollector collector(source.path);
  std::vector<float> vertex(width);
  for (std::size_t i = 0; i < points; ++i) {
    in.read<float>(vertex.data(), width);
    collector.addPoint({double(vertex[0]), double(vertex[1]), double(vertex[2])});
  }
  std::vector<std::uint32_t> corners;
  for (std::int32_t i = 0; i < faces; ++i) {
    if (i % static_cast<std::int32_t>(kItemsPerUpdate) == 0) {
      source.release();
      progress.update(static_cast<double>(in.position()) /
                      static_cast<double>(source.bytes.size()));
    }
    const auto n = in.remaining() < 8 ? -1 : in.get<std::int32_t>();
    if (n < 0 || (std::uint64_t(n) + 1) * 4 > in.remaining()) {
      warnOfMissingFaces(report, std::uint64_t(faces), std::uint64_t(i));
      break;
    }
    corners.resize(std::size_t(n));
    in.read<std::uint32_t>(corners.data(), corners.size());
    collector.addPolygon(corners.data(), corners.size());
    const auto colours = in.get<std::int32_t>();
    in.skip(std::min<std::uint64_t>(4 * std::uint64_t(std::max(colours, 0)), in.remaining()));
  }
  return collector.finish(report);
}

} // namespace

bool hasOffKeyword(std::string_view text) {
  return parseKeyword(text).length > 0;
}

TriangleMesh readOff(const Source& source, Report& report, Progress& progress) {
  NumberParser in(source, '#');
  if (source.bytes.substr(0, 3) == "\xef\xbb\xbf")
    in.seek(3);
  in.skipSpace();
  const OffKeyword keyword = parseKeyword(source.bytes.substr(in.position()));
  if (keyword.fourD || keyword.manyD)
    in.fail("it is of four or more dimensions", "export it with three");
  const std::size_t begin = in.position() + keyword.length; // the keyword may be missing
  in.seek(begin);
  if (const std::string_view word = in.word(); keyword.length > 0 && word == "BINARY") {
    in.line();
    return readOffBinary(source, in.position(), keyword.width, report, progress);
  }
  return OffText(source, begin, keyword.width, report, progress).read();
}

} // namespace tetvdb
