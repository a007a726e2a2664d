// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nanobind/nanobind.h>
#include <string>

namespace tetvdb::python {

namespace nb = nanobind;

/// The report of a job as JSON, made when it is asked for.
using ReportText = std::function<std::string()>;

/// Parsed; an empty dict where there is none.
nb::object reportDict(const ReportText& report);

/// A path as the file system has it, from a str, bytes or os.PathLike object. Throws TypeError.
std::string pathOf(nb::handle object);

} // namespace tetvdb::python
