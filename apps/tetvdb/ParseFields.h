// SPDX-License-Identifier: Apache-2.0
//
// Parses settings of fields. Every function throws Error(Usage) that names the option.
#pragma once

#include "tetvdb/fields/FieldRequest.h"
#include "tetvdb/fields/Warp.h"

#include <string>
#include <vector>

namespace tetvdb::cli {

/// One text each; `warp` empty: none.
struct FieldTexts {
  std::vector<std::string> derive, remap, clamp, background;
  std::string warp;
  bool smooth = false;
};

/// How errors name a setting: "--remap", or "`remap`".
using SettingName = std::string (*)(const char* setting);

/// "NAME=ARRAY" or "NAME=ARRAY:PART".
FieldRequest parseDerived(const std::string& option, const std::string& text);
/// Parses everything but `warp` and the arrays that are named, which `options` has already.
void setFields(const FieldTexts& texts, SettingName nameOf, FieldOptions& options);
/// "ARRAY" or "ARRAY*FACTOR".
Warp parseWarp(const std::string& option, const std::string& text);

} // namespace tetvdb::cli
