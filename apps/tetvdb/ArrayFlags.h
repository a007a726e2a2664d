// SPDX-License-Identifier: Apache-2.0
//
// Options of commands that write arrays.
#pragma once

#include "tetvdb/io/ArrayFile.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tetvdb::cli {

struct ArrayTexts {
  std::string box;
  bool sparse = false, compress = false;
};

/// --box, --sparse and --compress.
void addArrayFlags(CLI::App& command, ArrayTexts& texts);

/// Checked; throws Error(Usage), also where one is given and `output` is no array file.
ArrayOptions parseArrays(const ArrayTexts& texts, const std::string& output);

} // namespace tetvdb::cli
