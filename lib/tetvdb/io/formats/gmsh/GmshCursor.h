// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/text/ByteReader.h"
#include "tetvdb/io/text/NumberParser.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

constexpr const char* kExportWithGmsh = "export it again, for instance with gmsh -save";

/// Reads a .msh file, whose section marks and names are text and whose numbers are text or binary.
/// One of two cursors is active at any time; enterBinary() and leaveBinary() switch between them.
class GmshCursor {
public:
  explicit GmshCursor(const Source& source) : text(source), bytes(source) {}

  bool binary = false;       ///< numbers are binary, by $MeshFormat
  std::size_t sizeBytes = 8; ///< width of a size_t in a binary file

  NumberParser text;
  ByteReader bytes;

  /// To be called after a line that ends the text part of a section. No effect on ASCII files.
  void enterBinary() {
    if (binary)
      bytes.seek(text.position());
    inBinary_ = binary;
  }
  void leaveBinary() {
    if (inBinary_)
      text.seek(bytes.position());
    inBinary_ = false;
  }

  /// A C int.
  std::int64_t integer() { return inBinary_ ? bytes.get<std::int32_t>() : text.integer(); }
  /// A size_t (or unsigned long in 4.0).
  std::int64_t size() {
    if (!inBinary_)
      return text.integer();
    return sizeBytes == 4 ? bytes.get<std::uint32_t>()
                          : static_cast<std::int64_t>(bytes.get<std::uint64_t>());
  }
  double real() { return inBinary_ ? bytes.get<double>() : text.real(); }
  /// size() of elements with at least these numbers of bytes each in ASCII and in binary files.
  std::size_t count(std::string_view things, std::size_t textBytes, std::size_t binaryBytes) {
    return checkCount(size(), things, textBytes, binaryBytes);
  }
  std::size_t checkCount(std::int64_t n, std::string_view things, std::size_t textBytes,
                         std::size_t binaryBytes) const {
    if (inBinary_)
      return bytes.checkCount(n, binaryBytes, things);
    text.checkCount(n, things, textBytes);
    return static_cast<std::size_t>(n);
  }

  [[noreturn]] void fail(std::string_view what, std::string_view advice = {}) const {
    if (inBinary_)
      bytes.fail(what, advice);
    text.fail(what, advice);
  }

private:
  bool inBinary_ = false;
};

} // namespace tetvdb
