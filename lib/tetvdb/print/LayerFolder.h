// SPDX-License-Identifier: Apache-2.0
//
// A folder of files that is whole or absent.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// Files are written into a folder of a temporary name beside the target, which then takes its
/// place. A folder that is there is replaced where all that is in it has the names of this class's
/// files (manifest.json, and digits behind `stem` with the ending) and manifest.json is among them,
/// or where it is empty. For one thread at a time.
class LayerFolder {
public:
  /// `ending` with its dot. Throws Error(Usage) for what is there and cannot be replaced,
  /// Error(Write) where no folder can be made.
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
  /// Throws Error(Write); the target is then as it was.
  void commit();

private:
  bool isOurs(const std::string& name) const;

  std::string path_, stem_, ending_, temporary_;
  std::uint64_t bytes_ = 0;
};

} // namespace tetvdb
