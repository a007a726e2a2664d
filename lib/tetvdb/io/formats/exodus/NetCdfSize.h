// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tetvdb/io/source/Source.h"

namespace tetvdb {

/// Throws Error(Invalid) if a classic netCDF file (versions 1, 2 and 5) is shorter than its header
/// declares: the library reads missing data as zeros. Does nothing for other files.
void checkNetCdfSize(const Source& source);

} // namespace tetvdb
