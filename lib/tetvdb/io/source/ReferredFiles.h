// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tetvdb {

/// The files that are read together with the mesh `path`: the pieces of .pvd, .pvtu, .vtm and
/// similar files, the data of .xdmf, .gltf and .case files, the other half of .node and .ele; and
/// the files to which these refer. Every name in the file that is an existing file beside it
/// counts, whether or not a reader would open it. Missing and unreadable files refer to none: does
/// not throw. Reads the first 16 MB of a file.
std::vector<std::string> referredFiles(const std::string& path);

} // namespace tetvdb
