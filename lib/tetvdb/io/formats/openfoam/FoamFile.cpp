// SPDX-License-Identifier: Apache-2.0
//
// The format: OpenFOAM User Guide, "Basic input/output file format" and "Mesh files"; of binary
// lists and compact lists of faces, what OpenFOAM's tools write.
#include "tetvdb/io/formats/openfoam/FoamFile.h"

#include "tetvdb/io/source/Advice.h"
#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/GunzipBytes.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <utility>

namespace tetvdb::openfoam {
namespace {

constexpr std::size_t kHeadBytes = 4096;
constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

bool endsWith(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

bool isSpace(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}
bool endsWord(char c) {
  return isSpace(c) || std::strchr("(){}[];\"", c) != nullptr;
}

} // namespace

FoamFile::FoamFile(const std::string& path, bool headAlone)
    : file_(std::make_unique<MappedFile>(path)), bytes_(file_->bytes()), in_("", path) {
  if (endsWith(path, ".gz")) {
    text_ = gunzip(bytes_, headAlone ? kHeadBytes : kAny, path);
    bytes_ = text_;
    file_.reset();
  }
  in_ = NumberParser(bytes_, path);
  readHeader();
}

FoamFile::FoamFile(std::string_view bytes, const std::string& path)
    : bytes_(bytes), in_(bytes, path) {
  readHeader();
}

void FoamFile::readHeader() {
  if (word() != "FoamFile")
    in_.fail("does not begin with 'FoamFile'", kExport);
  expect('{');
  while (!accept('}')) {
    const std::string_view key = word();
    skip();
    std::string_view value = word();
    if (value.empty() && accept('"')) {
      const std::size_t begin = in_.position(), end = bytes_.find('"', begin);
      if (end == bytes_.npos)
        in_.fail("the header does not end", kCut);
      value = bytes_.substr(begin, end - begin);
      in_.seek(end + 1);
    }
    if (key.empty())
      in_.fail("the header does not end", kCut);
    if (key == "class")
      header_.className = std::string(value);
    else if (key == "format")
      header_.binary = value == "binary";
    else if (key == "arch")
      readArch(value);
    skipEntry();
  }
}

// "LSB;label=32;scalar=64"
void FoamFile::readArch(std::string_view arch) {
  header_.swapped = arch.find("MSB") != arch.npos;
  const auto bytesOf = [&](std::string_view name, unsigned usual) {
    const std::size_t at = arch.find(name);
    if (at == arch.npos)
      return usual;
    const std::string_view bits = arch.substr(at + name.size(), 2);
    return bits == "32" ? 4U : bits == "64" ? 8U : usual;
  };
  header_.labelBytes = bytesOf("label=", 4);
  header_.scalarBytes = bytesOf("scalar=", 8);
}

std::optional<FieldClass> FoamFile::fieldClass() const {
  std::string_view name = header_.className;
  FieldClass found;
  if (name.substr(0, 5) == "point")
    found.onPoints = true;
  else if (name.substr(0, 3) != "vol")
    return {};
  name.remove_prefix(found.onPoints ? 5 : 3);
  constexpr std::string_view kInternal = "::Internal";
  if (endsWith(name, kInternal))
    name.remove_suffix(kInternal.size());
  constexpr std::pair<std::string_view, std::uint32_t> kTypes[] = {{"ScalarField", 1},
                                                                   {"VectorField", 3},
                                                                   {"SphericalTensorField", 1},
                                                                   {"SymmTensorField", 6},
                                                                   {"TensorField", 9}};
  for (const auto& [type, components] : kTypes)
    if (name == type) {
      found.components = components;
      return found;
    }
  return {};
}

// White space and comments.
void FoamFile::skip() {
  for (;;) {
    in_.skipSpace();
    const std::size_t at = in_.position();
    const std::string_view two = bytes_.substr(at, 2);
    if (two != "//" && two != "/*")
      return;
    const std::string_view end = two == "//" ? "\n" : "*/";
    const std::size_t found = bytes_.find(end, at + 2);
    in_.seek(found == bytes_.npos ? bytes_.size() : found + end.size());
  }
}

char FoamFile::peek() {
  skip();
  return in_.position() < bytes_.size() ? bytes_[in_.position()] : '\0';
}

bool FoamFile::accept(char c) {
  if (peek() != c || in_.remaining() == 0)
    return false;
  in_.seek(in_.position() + 1);
  return true;
}

void FoamFile::expect(char c) {
  if (!accept(c))
    in_.failNumber(std::string("'") + c + "'");
}

std::string_view FoamFile::word() {
  skip();
  const std::size_t begin = in_.position();
  std::size_t end = begin;
  while (end < bytes_.size() && !endsWord(bytes_[end]))
    ++end;
  in_.seek(end);
  return bytes_.substr(begin, end - begin);
}

// To the matching end of what has just been opened.
void FoamFile::skipBlock(char open, char close) {
  for (std::size_t depth = 1; depth > 0;) {
    if (in_.remaining() == 0)
      in_.fail(std::string("'") + open + "' is not closed", kCut);
    if (accept(open))
      ++depth;
    else if (accept(close))
      --depth;
    else if (word().empty())
      in_.seek(in_.position() + 1);
  }
}

// The rest of an entry: to its ';', or past its block.
void FoamFile::skipEntry() {
  while (peek() != '\0') {
    if (accept(';'))
      return;
    if (accept('{'))
      return skipBlock('{', '}');
    if (accept('('))
      skipBlock('(', ')');
    else if (accept('['))
      skipBlock('[', ']');
    else if (peek() == '}')
      return;
    else if (word().empty())
      in_.seek(in_.position() + 1);
  }
}

// Elements of a list, which the cursor is at the beginning of.
std::size_t FoamFile::count(std::string_view things, std::size_t most, std::size_t bytesEach) {
  skip();
  const std::int64_t n = in_.integer();
  if (n < 0 || static_cast<std::uint64_t>(n) > most)
    in_.fail(std::to_string(n) + " " + std::string(things) + " where there are at most " +
                 std::to_string(most),
             kCut);
  if (peek() != '{') // one value for all
    in_.checkCount(n, things, bytesEach);
  return static_cast<std::size_t>(n);
}

std::uint32_t FoamFile::label() {
  const std::int64_t value = in_.integer();
  if (value < 0 || value >= std::int64_t(std::numeric_limits<std::uint32_t>::max()))
    in_.fail("the label " + std::to_string(value) + " is out of range", kExport);
  return static_cast<std::uint32_t>(value);
}

const char* FoamFile::raw(std::size_t bytes) {
  if (bytes > in_.remaining())
    in_.fail("a list is longer than the file", kCut);
  const char* const begin = bytes_.data() + in_.position();
  in_.seek(in_.position() + bytes);
  return begin;
}

void FoamFile::rawLabels(std::size_t n, std::vector<std::uint32_t>& out) {
  const char* const from = raw(n * header_.labelBytes);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int64_t value = header_.labelBytes == 4
                                   ? loadNumber<std::int32_t>(from + 4 * i, header_.swapped)
                                   : loadNumber<std::int64_t>(from + 8 * i, header_.swapped);
    if (value < 0 || value >= std::int64_t(std::numeric_limits<std::uint32_t>::max()))
      in_.fail("the label " + std::to_string(value) + " is out of range", kExport);
    out.push_back(static_cast<std::uint32_t>(value));
  }
}

void FoamFile::rawScalars(std::size_t n, std::vector<double>& out) {
  const char* const from = raw(n * header_.scalarBytes);
  for (std::size_t i = 0; i < n; ++i)
    out.push_back(header_.scalarBytes == 4
                      ? static_cast<double>(loadNumber<float>(from + 4 * i, header_.swapped))
                      : loadNumber<double>(from + 8 * i, header_.swapped));
}

void FoamFile::failList() {
  in_.fail("expected a list '(...)'", kExport);
}

std::vector<std::uint32_t> FoamFile::labels(std::size_t most) {
  const std::size_t n = count("labels", most, header_.binary ? header_.labelBytes : 2);
  if (!accept('{'))
    return listOf(n);
  std::vector<std::uint32_t> found(n, label());
  expect('}');
  return found;
}

std::vector<std::uint32_t> FoamFile::listedLabels() {
  const std::size_t n = count("labels", bytes_.size(), header_.binary ? header_.labelBytes : 2);
  return listOf(n);
}

std::vector<std::uint32_t> FoamFile::listOf(std::size_t n) {
  std::vector<std::uint32_t> found;
  if (!accept('(')) {
    if (n > 0)
      failList();
    return found;
  }
  found.reserve(n);
  if (header_.binary)
    rawLabels(n, found);
  else
    for (std::size_t i = 0; i < n; ++i)
      found.push_back(label());
  expect(')');
  return found;
}

// A value in text: a number, or "(a b c)".
void FoamFile::element(std::uint32_t components, std::vector<double>& out) {
  const bool closed = accept('(');
  if (!closed && components > 1)
    failList();
  for (std::uint32_t k = 0; k < components; ++k)
    out.push_back(in_.value());
  if (closed)
    expect(')');
}

std::vector<double> FoamFile::numbers(std::uint32_t components, std::size_t most) {
  const std::size_t bytesEach = header_.binary
                                    ? std::size_t(header_.scalarBytes) * components
                                    : 2 * std::size_t(components) + (components > 1 ? 1 : 0);
  const std::size_t n = count("values", most, bytesEach);
  std::vector<double> found;
  found.reserve(n * components);
  if (accept('{')) {
    element(components, found);
    expect('}');
    for (std::size_t i = 1; i < n; ++i)
      for (std::uint32_t k = 0; k < components; ++k)
        found.push_back(found[k]);
    if (n == 0)
      found.clear();
    return found;
  }
  if (!accept('(')) {
    if (n > 0)
      failList();
    return found;
  }
  if (header_.binary)
    rawScalars(n * components, found);
  else
    for (std::size_t i = 0; i < n; ++i)
      element(components, found);
  expect(')');
  return found;
}

std::vector<Vec3d> FoamFile::points() {
  const std::vector<double> found = numbers(3, bytes_.size());
  std::vector<Vec3d> points(found.size() / 3);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {found[3 * i], found[3 * i + 1], found[3 * i + 2]};
  return points;
}

Faces FoamFile::faces() {
  Faces faces;
  if (header_.className == "faceCompactList") {
    const std::vector<std::uint32_t> begin = listedLabels();
    faces.corners = listedLabels();
    if (begin.empty() || begin.front() != 0 || begin.back() != faces.corners.size() ||
        !std::is_sorted(begin.begin(), begin.end()))
      in_.fail("the lists of faces and of their corners do not agree", kExport);
    faces.begin.assign(begin.begin(), begin.end());
    return faces;
  }
  const std::size_t n = count("faces", bytes_.size(), 2);
  expect('(');
  for (std::size_t i = 0; i < n; ++i) {
    const std::vector<std::uint32_t> corners = listedLabels();
    faces.corners.insert(faces.corners.end(), corners.begin(), corners.end());
    faces.begin.push_back(faces.corners.size());
  }
  expect(')');
  return faces;
}

std::vector<Zone> FoamFile::zones() {
  std::vector<Zone> zones;
  const std::size_t n = count("zones", bytes_.size(), 2);
  if (!accept('('))
    return zones;
  for (std::size_t i = 0; i < n; ++i) {
    Zone& zone = zones.emplace_back();
    zone.name = std::string(word());
    expect('{');
    while (!accept('}')) {
      const std::string_view key = word();
      if (key.empty())
        in_.fail("a zone does not end", kCut);
      if (key == "cellLabels") {
        if (const char c = peek(); c < '0' || c > '9')
          word(); // List<label>
        zone.cells = listedLabels();
      }
      skipEntry();
    }
  }
  return zones;
}

// To the value of "internalField" or "value" among the entries of the outermost level.
bool FoamFile::seekEntry() {
  while (peek() != '\0') {
    const std::string_view key = word();
    if (key == "internalField" || key == "value")
      return true;
    if (key.empty() && peek() != '(' && peek() != '[' && peek() != '{' && peek() != '"')
      in_.seek(in_.position() + 1);
    skipEntry();
  }
  return false;
}

std::optional<std::vector<double>> FoamFile::internalField(std::size_t elements,
                                                           std::uint32_t components) {
  if (!seekEntry())
    return {};
  const std::string_view how = word();
  std::vector<double> found;
  if (how == "uniform") {
    if (const char c = peek(); c == '$' || c == '#')
      return {};
    element(components, found);
    const std::vector<double> one = found;
    found.reserve(elements * components);
    for (std::size_t i = 1; i < elements; ++i)
      found.insert(found.end(), one.begin(), one.end());
    if (elements == 0)
      found.clear();
  } else if (how == "nonuniform") {
    if (const char c = peek(); c < '0' || c > '9')
      if (word().substr(0, 5) != "List<")
        return {};
    // A field of another mesh may be longer.
    found = numbers(components, std::max(elements, bytes_.size()));
  } else {
    return {};
  }
  if (components == 6) // xx, xy, xz, yy, yz, zz in the file
    for (std::size_t i = 0; i + 6 <= found.size(); i += 6) {
      const std::array<double, 6> t{found[i],     found[i + 3], found[i + 5],
                                    found[i + 1], found[i + 4], found[i + 2]};
      std::copy(t.begin(), t.end(), found.begin() + static_cast<std::ptrdiff_t>(i));
    }
  return found;
}

} // namespace tetvdb::openfoam
