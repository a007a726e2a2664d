// SPDX-License-Identifier: Apache-2.0
//
// Checks of files and limits before a job starts.
#pragma once

#include "tetvdb/core/FileUse.h"
#include "tetvdb/io/Formats.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace tetvdb {

struct OutputInfo {
  std::string path;
  std::uint64_t bytes = 0;
};

/// Describes a file that was just written; 0 bytes for a pipe or a device.
OutputInfo written(const std::string& path);

/// Files' names without folder and extension; "_2" and so on is appended to repeated names.
std::vector<std::string> uniqueStems(const std::vector<std::string>& paths);

/// Throws Error(Usage) unless the path ends like a format with one of `uses`, in any case.
void requireFormat(const std::string& path, std::initializer_list<FormatUse> uses);

/// Throws Error(Usage) with `advice` unless the path ends in one of `known`, in any case.
void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice);

/// Declares that an input is read: the file, or the matches of a pattern, and the files they refer
/// to (io/source/ReferredFiles.h). Throws as FileUse::reads() does.
void addInput(FileUse& files, const std::string& path);

/// Throws Error(Usage) if a file is both an input, or referred to by one, and an output, or if two
/// outputs are the same file. Empty paths are ignored.
void requireSeparateFiles(const std::vector<std::string>& inputs,
                          const std::vector<std::string>& outputs);

/// Throws Error(Write) unless a file can be created at `path`: its folder must exist and be
/// writable, and it must not be a folder itself. Leaves no file behind.
void requireWritable(const std::string& path);

/// The remaining part of a limit for the whole process, in bytes; 0 for no limit. Throws
/// Error(Limit) if the mesh in memory has used it up.
std::size_t memoryLeft(std::size_t limit);

} // namespace tetvdb
