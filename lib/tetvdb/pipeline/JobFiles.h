// SPDX-License-Identifier: Apache-2.0
//
// What jobs check about their files and limits before they work.
#pragma once

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

/// A file that was written just now.
OutputInfo written(const std::string& path);

/// Files' names without folder and extension; "_2" and so on is added where one comes again.
std::vector<std::string> uniqueStems(const std::vector<std::string>& paths);

/// Throws Error(Usage) with `advice` unless the path ends in one of `known`, in any case.
void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice);

/// Throws Error(Usage) if the output is one of the inputs.
void requireNoInput(const std::string& output, const std::vector<std::string>& inputs);

/// Throws Error(Write) unless a file can be created at `path`: its folder exists and is writable,
/// and it is no folder itself. Leaves nothing behind.
void requireWritable(const std::string& path);

/// What a limit for the whole process leaves now, in bytes; 0 for no limit. Throws Error(Limit)
/// where the mesh in memory has used it up.
std::size_t memoryLeft(std::size_t limit);

} // namespace tetvdb
