// SPDX-License-Identifier: Apache-2.0
//
// A file of an OpenFOAM case: a header, then lists or a dictionary, as text or with binary lists.
//
//   tetvdb::openfoam::FoamFile file("case/constant/polyMesh/points");
//   const std::vector<tetvdb::Vec3d> points = file.points();
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb::openfoam {

struct Header {
  std::string className; ///< "vectorField", "volScalarField", ...
  bool binary = false;
  bool swapped = false;                     ///< lists are in the other byte order
  unsigned labelBytes = 4, scalarBytes = 8; ///< in binary lists
};

struct Faces {
  std::vector<std::size_t> begin{0}; ///< of each face's corners, and the end
  std::vector<std::uint32_t> corners;

  std::size_t count() const { return begin.size() - 1; }
};

struct Zone {
  std::string name;
  std::vector<std::uint32_t> cells;
};

/// What a class of fields holds.
struct FieldClass {
  bool onPoints = false;
  std::uint32_t components = 1;
};

/// Methods that read continue where the last one ended; they throw Error(Invalid) with "path:line".
/// What a list may take is bounded by the file, or by a number that the caller knows.
class FoamFile {
public:
  /// A name that ends with ".gz" is decompressed; `headAlone`: only its first bytes.
  explicit FoamFile(const std::string& path, bool headAlone = false);
  FoamFile(std::string_view bytes, const std::string& path);

  const Header& header() const { return header_; }
  /// Of volume and point fields; none for other classes.
  std::optional<FieldClass> fieldClass() const;

  std::vector<Vec3d> points();
  Faces faces();
  /// At most `most` labels, all below 2^32 - 1.
  std::vector<std::uint32_t> labels(std::size_t most);
  std::vector<Zone> zones();
  /// The entry "internalField" (or "value") of `elements` values, [element * components +
  /// component], symmetric tensors as xx, yy, zz, xy, yz, xz. None where the entry is missing or
  /// needs what OpenFOAM computes (macros, #calc); its length may differ from that asked for.
  std::optional<std::vector<double>> internalField(std::size_t elements, std::uint32_t components);

private:
  void readHeader();
  void readArch(std::string_view arch);
  void skip();
  bool accept(char c);
  void expect(char c);
  char peek();
  std::string_view word();
  void skipEntry();
  void skipBlock(char open, char close);
  bool seekEntry();
  std::size_t count(std::string_view things, std::size_t most, std::size_t bytesEach);
  std::uint32_t label();
  /// Without the form N{label}, which a file of many lists could make too much of.
  std::vector<std::uint32_t> listedLabels();
  std::vector<std::uint32_t> listOf(std::size_t n);
  const char* raw(std::size_t bytes);
  void rawLabels(std::size_t n, std::vector<std::uint32_t>& out);
  void rawScalars(std::size_t n, std::vector<double>& out);
  void element(std::uint32_t components, std::vector<double>& out);
  std::vector<double> numbers(std::uint32_t components, std::size_t most);
  [[noreturn]] void failList();

  std::unique_ptr<MappedFile> file_;
  std::string text_; ///< decompressed
  std::string_view bytes_;
  NumberParser in_;
  Header header_;
};

} // namespace tetvdb::openfoam
