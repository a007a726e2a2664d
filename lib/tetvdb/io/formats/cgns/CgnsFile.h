// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <string>

namespace tetvdb {

/// A path by which libcgns can open a source: its own, or while this lives that of a temporary file
/// that has its bytes. Made before the separate process, which writes no files.
///
/// libcgns refuses HDF5 files of a later major version than its own, although version 4 has the
/// elements of 3.4 under another number: the temporary file has libcgns's number.
///
/// Throws Error(Limit) if the bytes do not fit into the temporary folder, Error(Cancelled).
class CgnsBytes {
public:
  CgnsBytes(const Source& source, Progress& progress);
  ~CgnsBytes();
  CgnsBytes(const CgnsBytes&) = delete;
  CgnsBytes& operator=(const CgnsBytes&) = delete;
  const std::string& path() const { return path_; }

private:
  std::string path_, temporary_;
};

/// A CGNS file, opened by libcgns for reading; for a separate process (io/source/IsolatedRead.h).
/// Links to other files and HDF5's external storage are refused before libcgns can follow them.
/// Throws Error(Invalid).
class CgnsFile {
public:
  /// `path`: that of CgnsBytes for `source`.
  CgnsFile(const Source& source, const std::string& path);
  ~CgnsFile();
  CgnsFile(const CgnsFile&) = delete;
  CgnsFile& operator=(const CgnsFile&) = delete;

  int id() const { return id_; }
  /// Throws with libcgns's message if `status` is not CG_OK.
  void check(int status, const char* what) const;
  [[noreturn]] void fail(const std::string& what, const char* advice = nullptr) const;
  /// `n` numbers of `bytesEach` bytes, after checking that the file can hold them.
  std::size_t checked(double n, std::size_t bytesEach, const char* things) const;

private:
  void refuseLinks(const std::string& path) const;

  const Source& source_;
  int id_ = -1;
};

} // namespace tetvdb
