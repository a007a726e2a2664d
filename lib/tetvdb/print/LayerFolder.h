// SPDX-License-Identifier: Apache-2.0
//
// A folder of files that is whole or absent.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// Files are written into a folder with a temporary name beside the target, which is then renamed.
/// An existing folder is replaced if all of its files have names of this class's files
/// (manifest.json, and digits after `stem` with the ending) and manifest.json is among them, or if
/// it is empty. Not thread-safe.
class LayerFolder {
public:
  /// `ending` includes its dot. Throws Error(Usage) if the existing target cannot be replaced,
  /// Error(Write) if no folder can be created.
  LayerFolder(std::string path, std::string_view stem, std::string_view ending);
  /// Removes the temporary folder.
  ~LayerFolder();
  LayerFolder(const LayerFolder&) = delete;
  LayerFolder& operator=(const LayerFolder&) = delete;

  /// The name of layer k: "layer00012.png".
  std::string nameOf(std::int32_t k) const;
  /// Throws Error(Write).
  void write(const std::string& name, std::string_view bytes);
  /// Bytes written so far.
  std::uint64_t bytes() const { return bytes_; }
  /// Throws Error(Write); the target is then unchanged.
  void commit();

private:
  bool isOurs(const std::string& name) const;

  std::string path_, stem_, ending_, temporary_;
  std::uint64_t bytes_ = 0;
};

} // namespace tetvdb
