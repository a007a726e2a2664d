// SPDX-License-Identifier: Apache-2.0
//
// Options for the arrays of a mesh: --derive, --remap, --clamp, --background, --warp.
#pragma once

#include "tetvdb/fields/FieldRequest.h"
#include "tetvdb/fields/Warp.h"

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace tetvdb::cli {

struct FieldTexts {
  std::vector<std::string> derive, remap, clamp, background;
  std::string warp;
};

void addFieldOptions(CLI::App& command, FieldTexts& texts);

// What was given; each throws Error(Usage) that names the option.

/// "NAME=ARRAY" or "NAME=ARRAY:PART".
FieldRequest parseDerived(const std::string& text);
/// Everything but the arrays that --grid names.
void setFields(const FieldTexts& texts, FieldOptions& options);
/// "ARRAY" or "ARRAY*FACTOR".
Warp parseWarp(const std::string& text);

} // namespace tetvdb::cli
