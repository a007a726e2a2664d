// SPDX-License-Identifier: Apache-2.0
//
// The frame number in a file's name.
#pragma once

#include <optional>
#include <string>

namespace tetvdb {

/// A path split around the last run of digits in its name: "out/a.", "0007", "" and ".vdb" of
/// "out/a.0007.vdb". Without digits, `before` is the whole path without the extension.
struct NumberedPath {
  std::string before, digits, after, extension;
  std::optional<unsigned long long> number; ///< empty without digits, or with too many

  explicit NumberedPath(const std::string& path);
};

} // namespace tetvdb
