// SPDX-License-Identifier: Apache-2.0
//
// Which files a job reads and writes, so that it cannot destroy what it reads or has written.
//
//   tetvdb::FileUse files;
//   files.reads("a.stl");
//   files.writes("link-to-a.stl");   // throws Error(Usage)
#pragma once

#include "tetvdb/core/FileIdentity.h"

#include <map>
#include <string>

namespace tetvdb {

/// Not thread-safe. Files that exist are identified by device and inode, so that links and other
/// spellings are the same file, others by folder and name. Cost: a few system calls a path.
class FileUse {
public:
  /// An empty path is ignored. Throws Error(Usage) where the file is written too.
  void reads(const std::string& path);
  /// Throws Error(Usage) where the file is read, or written by another output. Devices such as
  /// /dev/null can be written to by several. "-" is standard output; an empty path is ignored.
  void writes(const std::string& path);

  /// Whether one of the files that are written is standard output.
  bool writesStandardOutput() const;

private:
  std::map<FileIdentity, std::string> read_, written_;
};

} // namespace tetvdb
