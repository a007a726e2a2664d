// SPDX-License-Identifier: Apache-2.0
//
// A folder of layers that is whole or absent.
#pragma once

#include "tetvdb/core/AtomicFolder.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace tetvdb {

/// Layers have digits after `stem`, and the ending; manifest.json is the index. Not thread-safe.
class LayerFolder {
public:
  /// `ending` includes its dot. Throws as AtomicFolder does.
  LayerFolder(std::string path, std::string_view stem, std::string_view ending);

  /// The name of layer k: "layer00012.png".
  std::string nameOf(std::int32_t k) const;
  /// Throws Error(Write).
  void write(const std::string& name, std::string_view bytes);
  /// Bytes written so far.
  std::uint64_t bytes() const { return bytes_; }
  /// Throws Error(Write); the target is then unchanged.
  void commit() { folder_.commit(); }

private:
  [[noreturn]] void fail(const char* what) const;

  std::string stem_, ending_;
  AtomicFolder folder_;
  std::uint64_t bytes_ = 0;
};

} // namespace tetvdb
