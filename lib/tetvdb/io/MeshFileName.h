// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tetvdb {

/// Whether a folder's search for meshes takes a file of that name: its ending is that of a format
/// with triangles or solid cells. Of TetGen's two files the one with the cells represents both.
bool isMeshFileName(const std::string& path);

} // namespace tetvdb
