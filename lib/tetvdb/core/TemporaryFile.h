// SPDX-License-Identifier: Apache-2.0
//
// Temporary files that nobody else can have planted: created exclusively, under names that cannot
// be foretold, closed in child programs.
#pragma once

#include <string>
#include <sys/types.h>

namespace tetvdb {

/// A new file in `folder`, open for reading and writing, whose name is ".BASE.RANDOM.tmp"; the name
/// is put into `path`. Its permissions are `mode` less the process's mask. Follows no link and
/// opens no file that is there. -1 with errno set where that is not possible. Thread-safe.
int createTemporaryFile(const std::string& folder, const std::string& base, mode_t mode,
                        std::string& path);

/// A new file in `folder` without a name, open for reading and writing by this user alone: nothing
/// is left of it however the program ends. -1 with errno set where that is not possible.
/// Thread-safe.
int createUnnamedFile(const std::string& folder);

} // namespace tetvdb
