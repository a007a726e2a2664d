// SPDX-License-Identifier: Apache-2.0
//
// Handles standard streams that are closed, full, or a pipe without a reader.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb::cli {

/// Opens /dev/null for standard streams that are closed, so that no file that is opened later
/// becomes one of them. Printing to a closed standard output still fails. Must be called first.
void openClosedStreams();

/// Prints "tetvdb: TEXT" on standard error, as one line for any `text`. Text that cannot be printed
/// is lost: a job does not fail because of it.
void printMessage(std::string_view text);

/// The message that there is no memory, which takes none.
void printOutOfMemory();

/// Writes `text` to standard error as it is. Where it cannot be written it is lost.
void writeToStandardError(std::string_view text);

/// Writes a result to standard output. Throws Error(Write) where that is not possible, but for a
/// pipe that nobody reads any more: whoever read it has what was wanted.
void printResult(std::string_view text);

} // namespace tetvdb::cli
