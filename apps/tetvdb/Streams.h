// SPDX-License-Identifier: Apache-2.0
//
// Standard streams that may be closed, full, or a pipe that nobody reads any more.
#pragma once

#include <string>
#include <string_view>

namespace tetvdb::cli {

/// Opens /dev/null in place of standard streams that are closed, so that no file that is opened
/// later becomes one of them. What is printed to a closed standard output still fails. To be called
/// first.
void openClosedStreams();

/// Prints "tetvdb: TEXT" on standard error, as one line whatever `text` holds. Where it cannot be
/// printed it is lost: a job does not fail for that.
void printMessage(std::string_view text);

/// The message that there is no memory, which takes none.
void printOutOfMemory();

/// Writes `text` to standard error as it is. Where it cannot be written it is lost.
void writeToStandardError(std::string_view text);

/// Writes a result to standard output. Throws Error(Write) where that is not possible.
void printResult(std::string_view text);

} // namespace tetvdb::cli
