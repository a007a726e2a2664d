// SPDX-License-Identifier: Apache-2.0
//
// Options for the arrays of a mesh: --derive, --remap, --clamp, --background, --warp, --smooth.
#pragma once

#include "ParseFields.h"

#include <CLI/CLI.hpp>

namespace tetvdb::cli {

void addFieldOptions(CLI::App& command, FieldTexts& texts);

} // namespace tetvdb::cli
