// SPDX-License-Identifier: Apache-2.0
//
// Whether two paths are one file.
#pragma once

#include <string>
#include <sys/types.h>
#include <tuple>

namespace tetvdb {

/// The path that opening `path` for writing would create or write to: symbolic links followed, also
/// one to a file that does not exist. Empty, with errno set, for cycles of links.
std::string followLinks(const std::string& path);

/// The file that a path refers to, with an order for look-up: equal for hard links, symbolic links
/// and different spellings of one file, whether it exists or not.
struct FileIdentity {
  dev_t device = 0; ///< of the file; of its folder where the file does not exist
  ino_t inode = 0;
  std::string name; ///< of a file that does not exist; with its folder where that does not exist
  bool isDevice = false; ///< a character device, which writing does not change

  friend bool operator<(const FileIdentity& a, const FileIdentity& b) {
    return std::tie(a.device, a.inode, a.name) < std::tie(b.device, b.inode, b.name);
  }
};

/// Asks the file system; never throws.
FileIdentity identify(const std::string& path);
/// Of an open file, such as standard output.
FileIdentity identify(int descriptor);

} // namespace tetvdb
