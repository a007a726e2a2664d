// SPDX-License-Identifier: Apache-2.0
//
// Options of commands that write or read arrays.
#pragma once

#include "tetvdb/io/ArrayFile.h"

#include <CLI/CLI.hpp>
#include <string>

namespace tetvdb::cli {

struct ArrayTexts {
  std::string box;
  bool sparse = false, compress = false;
};

struct ArrayInputTexts {
  std::string voxelSize, origin, axes, background;
};

/// --voxel-size, --origin, --axes and --background.
void addArrayInputOptions(CLI::App& command, ArrayInputTexts& texts);

/// Checked; throws Error(Usage), also where one is given and `input` is no array file.
ArrayInput parseArrayInput(const ArrayInputTexts& texts, const std::string& input);

/// --box, --sparse and --compress.
void addArrayFlags(CLI::App& command, ArrayTexts& texts);

/// Checked; throws Error(Usage), also where one is given and `output` is no array file.
ArrayOptions parseArrays(const ArrayTexts& texts, const std::string& output);

} // namespace tetvdb::cli
