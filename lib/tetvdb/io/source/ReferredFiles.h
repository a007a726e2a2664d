// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tetvdb {

/// The files that are read along with the mesh `path`: the pieces of .pvd, .pvtu, .vtm and the
/// like, the data of .xdmf, .gltf and .case files, the other half of .node and .ele; and what these
/// refer to. Every name in the file that is a file beside it counts, whether a reader would open it
/// or not. Files that are not there, and files that cannot be read, refer to none: never throws.
/// Looks at the first 16 MB of a file.
std::vector<std::string> referredFiles(const std::string& path);

} // namespace tetvdb
