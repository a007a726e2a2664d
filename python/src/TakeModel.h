// SPDX-License-Identifier: Apache-2.0
//
// Settings of functions that cut a model into a printer's layers.
#pragma once

#include "Settings.h"
#include "tetvdb/pipeline/SliceJob.h"

namespace tetvdb::python {

/// The printer, the grid, units, scale and place of the model, and how it is cleaned.
void takeModel(Settings& settings, SliceJob& job);

/// A number of zero or more.
void takeNumber(Settings& settings, const char* name, double& value);

} // namespace tetvdb::python
