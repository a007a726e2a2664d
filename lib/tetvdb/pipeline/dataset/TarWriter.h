// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/core/AtomicFile.h"

#include <string>
#include <string_view>

namespace tetvdb {

/// Writes files into a tar archive (POSIX.1-1988, names above 100 bytes by GNU's extension). Owners
/// and times are 0, so that the bytes depend only on the content. Throws Error(Write), Error(Limit)
/// for a file of 8 GiB or more.
class TarWriter {
public:
  explicit TarWriter(AtomicFile& file) : file_(file) {}

  void add(const std::string& name, std::string_view bytes);
  /// Writes the end; nothing may follow.
  void finish();

private:
  void entry(const std::string& name, char type, std::string_view bytes);

  AtomicFile& file_;
};

} // namespace tetvdb
