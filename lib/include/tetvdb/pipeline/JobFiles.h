// SPDX-License-Identifier: Apache-2.0
//
// What jobs check about their files and limits before they work.
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

/// A file that was written just now; 0 bytes where it is a pipe or a device.
OutputInfo written(const std::string& path);

/// Files' names without folder and extension; "_2" and so on is added where one comes again.
std::vector<std::string> uniqueStems(const std::vector<std::string>& paths);

/// Throws Error(Usage) unless the path ends like a format that has one of `uses`, in any case.
void requireFormat(const std::string& path, std::initializer_list<FormatUse> uses);

/// Throws Error(Usage) with `advice` unless the path ends in one of `known`, in any case.
void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice);

/// Declares that an input is read: the file, or those that match it where it is a pattern, and the
/// files they refer to (io/source/ReferredFiles.h). Throws as FileUse::reads() does.
void addInput(FileUse& files, const std::string& path);

/// Throws Error(Usage) if a file is an input, or referred to by one, as well as an output, or is
/// two outputs. Empty paths are none.
void requireSeparateFiles(const std::vector<std::string>& inputs,
                          const std::vector<std::string>& outputs);

/// Throws Error(Write) unless a file can be created at `path`: its folder exists and is writable,
/// and it is no folder itself. Leaves nothing behind.
void requireWritable(const std::string& path);

/// What a limit for the whole process leaves now, in bytes; 0 for no limit. Throws Error(Limit)
/// where the mesh in memory has used it up.
std::size_t memoryLeft(std::size_t limit);

} // namespace tetvdb
