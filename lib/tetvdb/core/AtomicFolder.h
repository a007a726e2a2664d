// SPDX-License-Identifier: Apache-2.0
//
// A folder of files that is whole or absent.
#pragma once

#include <functional>
#include <string>

namespace tetvdb {

/// Files are written into a folder with a temporary name beside the target, which is then renamed.
/// Not thread-safe.
class AtomicFolder {
public:
  /// What a folder of this kind holds.
  struct Contents {
    std::string things; ///< such as "layers", for messages
    std::string index;  ///< the name of the file that every one has
    std::function<bool(const std::string& name)> isOurs; ///< whether the others have such names
  };

  /// An existing folder, or the one that a symbolic link names, is replaced if it is empty, or has
  /// the index and no files but ours. Throws
  /// Error(Usage) if it cannot be replaced, Error(Write) if no folder can be created.
  AtomicFolder(std::string path, const Contents& contents);
  /// Removes the temporary folder.
  ~AtomicFolder();
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;

  const std::string& target() const { return path_; } ///< no slash at its end
  const std::string& temporary() const {
    return temporary_;
  } ///< where files are put until commit()
  /// Once. Throws Error(Write); the target is then unchanged.
  void commit();

private:
  std::string path_, temporary_;
  int folder_ = -1; ///< the temporary folder, opened; -1 after commit()
};

} // namespace tetvdb
