// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace tetvdb::cli {

/// A folder under $TMPDIR, or /tmp, that is removed with what it holds. Folders of processes that
/// were killed are removed when the next one is made: no process holds their lock any more.
class TemporaryFolder {
public:
  /// Throws Error(Write) where no folder can be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

private:
  std::filesystem::path path_;
  int locked_ = -1; ///< the folder, open
};

} // namespace tetvdb::cli
