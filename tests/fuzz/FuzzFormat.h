// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/FileFormat.h"

namespace tetvdb {

/// Whose reader a program attacks: in a file that CMake writes for each.
extern const FileFormat kFuzzedFormat;

} // namespace tetvdb
