// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tetvdb {

/// The path of the file `name` that the file `path` refers to, relative to that file's folder.
/// Throws Error(Invalid) for absolute names, for those that lead out of the folder, by a link too,
/// and where there is no such regular file.
std::string pathWithin(const std::string& path, const std::string& name);

} // namespace tetvdb
