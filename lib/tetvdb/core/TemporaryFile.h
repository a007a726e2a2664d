// SPDX-License-Identifier: Apache-2.0
//
// Temporary files that no one else can have created: opened exclusively, under unpredictable names,
// closed in child programs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <sys/types.h>

namespace tetvdb {

/// A new file in `folder`, open for reading and writing, whose name is ".BASE.RANDOM.tmp"; the name
/// is put into `path`. Its permissions are `mode` less the process's mask. Follows no link and
/// opens no file that exists. -1 with errno set where that is not possible. Thread-safe.
int createTemporaryFile(const std::string& folder, const std::string& base, mode_t mode,
                        std::string& path);

/// A new file in `folder` that has no name until nameFile(), open for reading and writing: until
/// then it is gone when the program ends, in whatever way. Its permissions are `mode` less the
/// process's mask. -1 where the file system knows no such files. Thread-safe.
int createFileToName(const std::string& folder, mode_t mode);

/// Gives a file of createFileToName() the name `path`; not where there is a file of that name.
/// Whether that was possible. Thread-safe.
bool nameNewFile(int descriptor, const std::string& path);

/// Gives a file of createFileToName() a name like those of createTemporaryFile(), which is put into
/// `path`. Whether that was possible; errno is set where not. Thread-safe.
bool nameFile(int descriptor, const std::string& folder, const std::string& base,
              std::string& path);

/// A new file in `folder` without a name, open for reading and writing by this user alone: it
/// is gone when the program ends, in whatever way. -1 with errno set where that is not possible.
/// Thread-safe.
int createUnnamedFile(const std::string& folder);

/// Writes all of `size` bytes at `at`. Whether that was possible; errno is set where not.
/// Thread-safe.
bool writeAllAt(int descriptor, std::uint64_t at, const char* data, std::size_t size);

} // namespace tetvdb
