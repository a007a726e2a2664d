// SPDX-License-Identifier: Apache-2.0
//
// The frames of a sequence: a .pvd collection, a pattern of names, the time steps of a file.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct Frame {
  std::vector<std::string> inputs; ///< files of the frame, which are combined
  int timeStep = -1;               ///< of a file with several: counted from 0; -1: the last
  std::optional<double> time;      ///< as given in the input
};

/// A selection of frames, counted from 1.
struct FrameRange {
  std::size_t first = 1;
  std::size_t last = 0; ///< 0: the last frame
  std::size_t stride = 1;
};

/// Whether individually named files are the frames of a sequence: two or more in one folder, with
/// one extension, whose names differ only in their last number ("run_08.vtu", "run_10.vtu").
bool isNumbered(const std::vector<std::string>& paths);

/// Finds the frames that `inputs` represent, in order of time:
/// - one .pvd file: one frame per time, with all its parts;
/// - one name with '*' or '?' that is not an existing file: one frame per matching file, ordered by
///   the last number in its name. Missing numbers are an error unless `allowGaps`;
/// - files for which isNumbered() holds: likewise;
/// - with `range`, one file of a format with steps: its time steps.
/// Returns none if the inputs are plain meshes. Throws Error(Invalid) for a collection that cannot
/// be read, a missing file, a pattern without matches, and gaps; Error(Usage) for a range beyond
/// the last frame, a range of inputs that are not a sequence, and for a sequence combined with
/// other inputs. Cost: that of reading the collection, or the folder's names.
std::vector<Frame> findFrames(const std::vector<std::string>& inputs,
                              const std::optional<FrameRange>& range, bool allowGaps,
                              Report& report, Progress& progress);

/// Whether a path contains '*' or '?' and is not an existing file.
bool isPattern(const std::string& path);
/// The files that `inputs` name, with patterns replaced by their matches, ordered by the last
/// number in their names and then by name. Throws Error(Invalid) for a pattern without matches,
/// Error(Usage) for a .pvd collection, whose times are not parts of one volume.
std::vector<std::string> filesOf(const std::vector<std::string>& inputs);

/// "out/a.vdb" and 7 of 12 give "out/a.0007.vdb": the number is last, with four digits or more.
std::string frameName(const std::string& output, std::size_t number, std::size_t count);

} // namespace tetvdb
