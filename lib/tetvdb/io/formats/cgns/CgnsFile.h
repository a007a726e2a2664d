// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/Source.h"

#include <cstddef>
#include <string>

namespace tetvdb {

/// A CGNS file, opened by libcgns for reading; for a separate process (io/source/IsolatedRead.h).
/// Links to other files and HDF5's external storage are refused before libcgns can follow them.
/// Throws Error(Invalid).
class CgnsFile {
public:
  explicit CgnsFile(const Source& source);
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
