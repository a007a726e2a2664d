// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/Source.h"

namespace tetvdb {

/// Throws Error(Invalid) where a classic netCDF file (versions 1, 2 and 5) is shorter than its
/// header says: the library reads what is missing as zeros. Does nothing for other files.
void checkNetCdfSize(const Source& source);

} // namespace tetvdb
