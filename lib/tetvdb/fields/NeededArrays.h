// SPDX-License-Identifier: Apache-2.0
//
// The arrays of a file that are required by the requested grids and the warp.
#pragma once

#include "tetvdb/fields/FieldRequest.h"
#include "tetvdb/fields/Warp.h"

#include <string>
#include <vector>

namespace tetvdb {

/// For ReadOptions::arrays: the names in all requests, with and without "points:", "cells:" and the
/// text after the last colon, since names of arrays may also contain colons. Empty, that is all, if
/// every array is requested.
std::vector<std::string> neededArrays(const FieldOptions& fields, const Warp& warp);

} // namespace tetvdb
