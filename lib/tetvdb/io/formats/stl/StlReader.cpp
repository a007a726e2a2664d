// SPDX-License-Identifier: Apache-2.0
//
// Format: 3D Systems, "StereoLithography Interface Specification" (1989). A binary file is a header
// of 80 bytes, a count, and 50 bytes per facet: normal, three corners, two bytes of attributes.
#include "tetvdb/io/formats/stl/StlReader.h"

#include "tetvdb/core/Constants.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/cells/FaceCollector.h"
#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace tetvdb {
namespace {

constexpr std::size_t kHead = 84, kFacet = 50;
constexpr std::size_t kLook = 4096; // bytes tested for text
constexpr bool kBigEndian = false;  // numbers are stored least byte first
constexpr std::size_t kMaxFacets = (UINT32_MAX - 1) / 3;

void checkFacetCount(std::size_t n, const std::string& path) {
  if (n > kMaxFacets)
    throw Error(Status::Limit, path, "more facets than 32-bit point numbers reach",
                "split it into several files");
}

bool equalsIgnoringCase(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() &&
         std::equal(word.begin(), word.end(), lower.begin(), [](char a, char b) {
           return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
         });
}

/// Successive corners are faces: the indices of a soup.
void numberCorners(TriangleMesh& mesh) {
  mesh.triangles.resize(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    mesh.triangles[i] = static_cast<std::uint32_t>(i);
  mesh.faceCount = mesh.triangleCount();
}

// --- Binary -------------------------------------------------------------------------------------

/// Whether bytes after the declared facets are also facets: finite, with a normal of about unit
/// length or zero, and not all zero like padding.
bool areFacets(std::string_view bytes) {
  for (std::size_t at = 0; at < bytes.size(); at += kFacet) {
    std::array<float, 12> numbers;
    std::memcpy(numbers.data(), bytes.data() + at, sizeof numbers);
    float normal = 0;
    bool zero = true;
    for (std::size_t k = 0; k < 12; ++k) {
      if (!std::isfinite(numbers[k]))
        return false;
      zero = zero && numbers[k] == 0;
      if (k < 3)
        normal = std::max(normal, std::abs(numbers[k]));
    }
    if (zero || normal > 1.1F)
      return false;
  }
  return true;
}

/// Number of facets to read; warns if it differs from the header.
std::size_t binaryFacetCount(const Source& source, Report& report) {
  const std::size_t declared = loadNumber<std::uint32_t>(source.bytes.data() + 80, kBigEndian);
  const std::size_t room = source.bytes.size() - kHead;
  const std::size_t whole = room / kFacet;
  if (declared * kFacet == room)
    return declared;
  if (declared > whole) {
    report.warn("truncated", std::to_string(declared) + " facets are declared, " +
                                 std::to_string(whole) + " are there: the file is cut off");
    report.partial = true;
    return whole;
  }
  const std::size_t rest = room - declared * kFacet;
  if (rest % kFacet == 0 && areFacets(source.bytes.substr(kHead + declared * kFacet))) {
    report.warn("wrong-count", std::to_string(declared) + " facets are declared, " +
                                   std::to_string(whole) + " are there, and all were read");
    return whole;
  }
  report.warn("trailing-bytes", std::to_string(rest) + " bytes follow the last of the " +
                                    std::to_string(declared) + " facets and were ignored");
  return declared;
}

TriangleMesh readBinary(const Source& source, Report& report, Progress& progress) {
  if (source.bytes.size() < kHead)
    throw Error(Status::Invalid, source.path,
                "neither a text nor a whole header of a binary STL file", kCut);
  const std::size_t n = binaryFacetCount(source, report);
  checkFacetCount(n, source.path);
  TriangleMesh mesh;
  mesh.points.resize(3 * n);
  Vec3d* to = mesh.points.data();
  const char* from = source.bytes.data() + kHead + 12; // behind the normal
  for (std::size_t done = 0; done < n;) {
    for (const std::size_t end = std::min(n, done + kItemsPerUpdate); done < end; ++done) {
      std::array<float, 9> corners;
      std::memcpy(corners.data(), from, sizeof corners);
      from += kFacet;
      float check = 0; // NaN if a number is not finite
      for (std::size_t k = 0; k < 9; ++k) {
        to[k / 3][k % 3] = static_cast<double>(corners[k]);
        check += corners[k] * 0.0F;
      }
      if (check == 0.0F)
        to += 3;
    }
    source.release();
    progress.update(static_cast<double>(done) / static_cast<double>(n));
  }
  mesh.points.resize(static_cast<std::size_t>(to - mesh.points.data()));
  const std::size_t bad = n - mesh.points.size() / 3;
  if (n == 0 || bad == n)
    throw Error(Status::Invalid, source.path,
                n == 0 ? "it holds no facets"
                       : "none of its " + std::to_string(n) + " facets has finite corners",
                "the file is damaged; export it again");
  if (bad > 0)
    warnOfBadFaces(report, bad, "their corners are not finite numbers");
  numberCorners(mesh);
  return mesh;
}

// --- Text ---------------------------------------------------------------------------------------

/// Only `vertex` and the end of a facet are evaluated, since exporters differ in all other words.
class TextReader {
public:
  TextReader(const Source& source, Report& report, Progress& progress)
      : source_(source), report_(report), progress_(progress), in_(source) {}

  TriangleMesh read() {
    for (std::size_t words = 0; !in_.atEnd(); ++words) {
      if (words % kItemsPerUpdate == 0) {
        source_.release();
        progress_.update(static_cast<double>(in_.position()) /
                         static_cast<double>(source_.bytes.size()));
      }
      readStatement(in_.word());
    }
    finishText();
    numberCorners(mesh_);
    mesh_.faceCount = faces_;
    return std::move(mesh_);
  }

private:
  void readStatement(std::string_view word) {
    if (equalsIgnoringCase(word, "vertex")) {
      addCorner();
    } else if (equalsIgnoringCase(word, "endloop") || equalsIgnoringCase(word, "endfacet") ||
               equalsIgnoringCase(word, "facet") || equalsIgnoringCase(word, "outer")) {
      endFacet();
    } else if (equalsIgnoringCase(word, "solid")) {
      endFacet();
      ++solids_;
      skipName();
    } else if (equalsIgnoringCase(word, "endsolid") ||
               (equalsIgnoringCase(word, "end") && equalsIgnoringCase(in_.peekWord(), "solid"))) {
      endFacet();
      ++endedSolids_;
      skipName();
    }
  }

  /// A name may contain any words; it ends with the line, or at the first facet of a one-line text.
  void skipName() {
    const std::string_view text = source_.bytes;
    for (std::size_t at = in_.position(); at < text.size() && !isLineBreak(text[at]);) {
      const std::size_t start = at;
      while (at < text.size() && static_cast<unsigned char>(text[at]) > ' ')
        ++at;
      const std::string_view word = text.substr(start, at - start);
      in_.seek(at);
      if (equalsIgnoringCase(word, "facet") && equalsIgnoringCase(in_.peekWord(), "normal")) {
        in_.seek(start);
        return;
      }
      at = std::max(at, start + 1);
    }
  }

  void addCorner() {
    Vec3d p{};
    for (double& x : p)
      if (!in_.tryReal(x) || !in_.atWordEnd())
        x = NAN;
    bad_ = bad_ || !std::isfinite(p[0] + p[1] + p[2]);
    corners_.push_back(p);
    touchesEnd_ = in_.remaining() == 0;
  }

  /// A facet of more than three corners is a fan.
  void endFacet() {
    if (corners_.empty())
      return;
    ++facetsSeen_;
    if (bad_ || corners_.size() < 3) {
      ++badFacets_;
    } else {
      ++faces_;
      checkFacetCount(mesh_.points.size() / 3 + corners_.size(), source_.path);
      for (std::size_t k = 1; k + 1 < corners_.size(); ++k)
        mesh_.points.insert(mesh_.points.end(), {corners_[0], corners_[k], corners_[k + 1]});
    }
    corners_.clear();
    bad_ = false;
  }

  void finishText() {
    bool cut = solids_ > endedSolids_;
    if (!corners_.empty()) { // the last number may be truncated
      cut = true;
      if (corners_.size() >= 3 && !bad_ && !touchesEnd_)
        endFacet();
    }
    if (mesh_.points.empty())
      throw Error(Status::Invalid, source_.path,
                  facetsSeen_ == 0 ? "it holds no facets"
                                   : "none of its " + std::to_string(facetsSeen_) +
                                         " facets has three finite corners",
                  "the file is damaged; export it again");
    if (badFacets_ > 0)
      warnOfBadFaces(report_, badFacets_, "their corners are not three or more finite points");
    if (cut) {
      report_.warn("truncated", "the file ends without 'endsolid': it may be cut off; " +
                                    std::to_string(faces_) + " facets were read");
      report_.partial = true;
    }
  }

  const Source& source_;
  Report& report_;
  Progress& progress_;
  NumberParser in_;
  TriangleMesh mesh_;
  std::vector<Vec3d> corners_; ///< of the facet that is being read
  bool bad_ = false;
  bool touchesEnd_ = false;
  std::size_t faces_ = 0, facetsSeen_ = 0, badFacets_ = 0;
  std::size_t solids_ = 0, endedSolids_ = 0;
};

} // namespace

bool isBinaryStlBySize(std::string_view bytes) {
  if (bytes.size() < kHead + kFacet || (bytes.size() - kHead) % kFacet != 0)
    return false;
  return loadNumber<std::uint32_t>(bytes.data() + 80, kBigEndian) ==
         (bytes.size() - kHead) / kFacet;
}

bool isTextStl(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, kLook);
  if (head.find('\0') != head.npos)
    return false;
  NumberParser words(head, "");
  for (std::string_view word = words.word(); !word.empty(); word = words.word())
    for (const char* known : {"facet", "vertex", "endsolid"})
      if (equalsIgnoringCase(word, known))
        return true;
  return false;
}

TriangleMesh readStl(const Source& source, Report& report, Progress& progress) {
  if (!isBinaryStlBySize(source.bytes) && isTextStl(source.bytes))
    return TextReader(source, report, progress).read();
  return readBinary(source, report, progress);
}

} // namespace tetvdb
