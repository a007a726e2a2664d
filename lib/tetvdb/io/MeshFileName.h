// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tetvdb {

/// Whether the search of a folder for meshes uses a file of that name: its ending is that of a
/// format with triangles or solid cells. Of TetGen's two files, only the one with cells is used.
bool isMeshFileName(const std::string& path);

} // namespace tetvdb
