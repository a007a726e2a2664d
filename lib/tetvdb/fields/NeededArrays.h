// SPDX-License-Identifier: Apache-2.0
//
// Which arrays of a file must be read for the grids and the warp that are asked for.
#pragma once

#include "tetvdb/fields/FieldRequest.h"
#include "tetvdb/fields/Warp.h"

#include <string>
#include <vector>

namespace tetvdb {

/// For ReadOptions::arrays: the names in all requests, with and without "points:", "cells:" and
/// what follows the last colon, since names of arrays may have colons too. Empty, which represents
/// all, where every array is asked for.
std::vector<std::string> neededArrays(const FieldOptions& fields, const Warp& warp);

} // namespace tetvdb
