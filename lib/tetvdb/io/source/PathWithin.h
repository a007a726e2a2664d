// SPDX-License-Identifier: Apache-2.0
//
// Files that a mesh file names. A file from elsewhere must not make the program read what its user
// keeps in other folders, nor devices and pipes.
#pragma once

#include <cstddef>
#include <string>

namespace tetvdb {

/// The path of the file `name` that the file `path` refers to, relative to that file's folder.
/// Throws Error(Invalid) where there is no such regular file and, unless references may lead
/// outside, for names that lead out of the folder, by a link too. Absolute names of files within
/// the folder are allowed. Thread-safe.
std::string pathWithin(const std::string& path, const std::string& name);

/// How deep files may include one another, and how many may be included.
constexpr std::size_t kDeepestInclusion = 16, kMostInclusions = 10000;

/// Whether the files that this process reads may refer to files outside of their folders; false
/// from the start. Thread-safe; meant to be called before anything is read.
void allowReferencesOutside(bool allowed);
bool areReferencesAllowedOutside();

} // namespace tetvdb
