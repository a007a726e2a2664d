// SPDX-License-Identifier: Apache-2.0
//
// Format: G. Turk, "The PLY Polygon File Format" (1994).
#include "tetvdb/io/formats/ply/PlyReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/cells/FaceCollector.h"
#include "tetvdb/io/formats/ply/PlyHeader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace tetvdb {
namespace {

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

std::uint32_t toIndex(double value) {
  return value >= 0 && value < FaceCollector::kNone ? static_cast<std::uint32_t>(value)
                                                    : FaceCollector::kNone;
}

/// Rows of numbers in text, one element per line. Further content of a line is skipped, unless the
/// whole file is one line.
class TextRows {
public:
  static constexpr bool isText = true;
  TextRows(const Source& source, const PlyHeader& header)
      : in_(source, 0, header.bodyBegin), size_(source.bytes.size()) {
    in_.skipSpace();
    const std::size_t start = in_.position();
    NumberParser line(in_.line(), source.path);
    in_.seek(start);
    std::size_t numbers = 0;
    while (!line.word().empty())
      ++numbers;
    const auto first =
        std::find_if(header.elements.begin(), header.elements.end(),
                     [](const PlyElement& e) { return e.count > 0 && !e.properties.empty(); });
    lines_ = first == header.elements.end() || first->hasLists() ||
             numbers < 2 * first->properties.size();
  }

  bool atEnd() { return in_.atEnd(); }
  std::size_t remaining() const { return in_.remaining(); }
  double fraction() const {
    return static_cast<double>(in_.position()) / static_cast<double>(size_);
  }
  double number(PlyType) {
    double value = NAN;
    if (in_.tryReal(value) && in_.atWordEnd())
      return value;
    in_.word();
    return NAN;
  }
  /// Whether `n` numbers of a type can be present.
  bool holds(double n, PlyType) const { return n <= static_cast<double>(in_.remaining() / 2 + 1); }
  void skip(std::size_t n, PlyType type) {
    for (std::size_t i = 0; i < n && !in_.atEnd(); ++i)
      number(type);
  }
  bool skipsRest() const { return lines_; }
  void skipRest() { in_.line(); }
  /// Whether the file ends with the last number, which may be truncated.
  bool atVeryEnd() const { return in_.remaining() == 0; }

private:
  NumberParser in_;
  std::size_t size_;
  bool lines_ = true;
};

class BinaryRows {
public:
  static constexpr bool isText = false;
  BinaryRows(const Source& source, const PlyHeader& header)
      : bytes_(source.bytes), at_(header.bodyBegin),
        swap_(header.format == PlyHeader::Format::BigEndian) {}

  bool atEnd() const { return at_ >= bytes_.size() || cut_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  double fraction() const { return static_cast<double>(at_) / static_cast<double>(bytes_.size()); }
  double number(PlyType type) {
    if (!holds(1, type)) {
      cut_ = true;
      return NAN;
    }
    const char* from = bytes_.data() + at_;
    at_ += plyTypeSize(type);
    return loadPlyNumber(from, type, swap_);
  }
  bool holds(double n, PlyType type) const {
    return n <= static_cast<double>(remaining() / plyTypeSize(type));
  }
  void skip(std::size_t n, PlyType type) { at_ += n * plyTypeSize(type); }
  static constexpr bool skipsRest() { return false; }
  static constexpr void skipRest() {}
  bool atVeryEnd() const { return cut_; }

private:
  std::string_view bytes_;
  std::size_t at_;
  bool swap_;
  bool cut_ = false;
};

template <class Rows>
class PlyBody {
public:
  PlyBody(const Source& source, const PlyHeader& header, Report& report, Progress& progress)
      : header_(header), report_(report), progress_(progress), rows_(source, header),
        faces_(source.path), source_(source) {}

  TriangleMesh read() {
    for (const PlyElement& element : header_.elements) {
      chooseProperties(element);
      if (!readElement(element))
        break;
    }
    return faces_.finish(report_);
  }

private:
  enum class Kind { Vertex, Face, Strips, Other };

  void chooseProperties(const PlyElement& element) {
    std::fill(std::begin(axes_), std::end(axes_), kNowhere);
    list_ = kNowhere;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      for (std::size_t k = 0; k < 3; ++k)
        if (!property.list && property.name == std::string_view("xyz").substr(k, 1))
          axes_[k] = i;
      if (property.list && list_ == kNowhere &&
          (property.name == "vertex_indices" || property.name == "vertex_index"))
        list_ = i;
    }
    // Properties after the last required one are skipped with the line.
    needed_ = *std::max_element(std::begin(axes_), std::end(axes_));
    kind_ = Kind::Other;
    if (element.name == "vertex" && needed_ != kNowhere) {
      kind_ = Kind::Vertex;
    } else if (list_ != kNowhere && (element.name == "face" || element.name == "tristrips")) {
      kind_ = element.name == "face" ? Kind::Face : Kind::Strips;
      needed_ = list_;
    }
  }

  /// Returns false if the file ends first.
  bool readElement(const PlyElement& element) {
    if (element.properties.empty())
      return true;
    if (kind_ == Kind::Vertex)
      faces_.reserve(std::min<std::uint64_t>(element.count, rows_.remaining() / 3), 0);
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (i % kItemsPerUpdate == 0) {
        source_.release();
        progress_.update(rows_.fraction());
      }
      if (rows_.atEnd() || !readRow(element) || (i + 1 < element.count && isCut())) {
        if (faces_.faceCount() == 0)
          throw Error(Status::Invalid, source_.path,
                      "the file ends after " + std::to_string(i) + " of " +
                          std::to_string(element.count) + " elements '" + element.name +
                          "', before any face",
                      "it is cut off; export it again");
        report_.warn("truncated", std::to_string(element.count) + " elements '" + element.name +
                                      "' are declared, " + std::to_string(i) +
                                      " are there: the file is cut off");
        report_.partial = true;
        return false;
      }
      use();
    }
    return true;
  }

  /// Whether the row ends with the file, possibly within a number.
  bool isCut() const {
    if (!rows_.atVeryEnd())
      return false;
    const bool corner = Rows::isText && kind_ == Kind::Face && !corners_.empty();
    return !corner || faces_.mayBeCut(toIndex(corners_.back()));
  }

  bool readRow(const PlyElement& element) {
    corners_.clear();
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (property.list) {
        if (rows_.atEnd())
          return false;
        const double n = rows_.number(property.countType);
        if (!(n >= 0) || !rows_.holds(n, property.type)) {
          if (!rows_.skipsRest())
            return false; // the begin of the next row is unknown
          rows_.skipRest();
          return !(n >= 0 && rows_.atEnd());
        }
        const auto count = static_cast<std::size_t>(n);
        if (i == list_) {
          for (std::size_t k = 0; k < count; ++k) {
            if (rows_.atEnd())
              return false;
            corners_.push_back(rows_.number(property.type));
          }
        } else {
          rows_.skip(count, property.type);
        }
      } else {
        if (rows_.atEnd())
          return false;
        const double value = rows_.number(property.type);
        for (std::size_t k = 0; k < 3; ++k)
          if (axes_[k] == i)
            point_[k] = value;
      }
      if (i == needed_ && rows_.skipsRest())
        break;
    }
    if (rows_.skipsRest())
      rows_.skipRest();
    return true;
  }

  void use() {
    if (kind_ == Kind::Vertex) {
      faces_.addPoint(point_);
    } else if (kind_ == Kind::Face) {
      polygon_.clear();
      for (const double corner : corners_)
        polygon_.push_back(toIndex(corner));
      faces_.addPolygon(polygon_.data(), polygon_.size());
    } else if (kind_ == Kind::Strips) {
      addStrips();
    }
  }

  /// Three successive corners are a triangle, every second one reversed; -1 starts a new strip.
  void addStrips() {
    std::size_t length = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      length = corners_[i] == -1 ? 0 : length + 1;
      if (length < 3)
        continue;
      std::uint32_t triangle[3];
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = toIndex(corners_[i - 2 + k]);
      if (length % 2 == 0)
        std::swap(triangle[0], triangle[1]);
      faces_.addPolygon(triangle, 3);
    }
  }

  const PlyHeader& header_;
  Report& report_;
  Progress& progress_;
  Rows rows_;
  FaceCollector faces_;
  const Source& source_;
  Kind kind_ = Kind::Other;
  std::size_t axes_[3] = {}; ///< indices of x, y, z among the properties
  std::size_t list_ = 0;     ///< index of the corners
  std::size_t needed_ = 0;   ///< index of the last required property
  Vec3d point_{};
  std::vector<double> corners_;
  std::vector<std::uint32_t> polygon_;
};

} // namespace

TriangleMesh readPly(const Source& source, Report& report, Progress& progress) {
  const PlyHeader header = parsePlyHeader(source);
  if (!header.unknown.empty())
    report.warn("header-line", "a line of the header is no statement of PLY and was left out: '" +
                                   header.unknown + "'");
  if (header.format == PlyHeader::Format::Text)
    return PlyBody<TextRows>(source, header, report, progress).read();
  return PlyBody<BinaryRows>(source, header, report, progress).read();
}

} // namespace tetvdb
