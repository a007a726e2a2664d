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
  std::vector<std::string> inputs; ///< files that make it up, laid together
  int timeStep = -1;               ///< of a file with several: counted from 0; -1: the last
  std::optional<double> time;      ///< as the input says
};

/// Which frames to take, counted from 1.
struct FrameRange {
  std::size_t first = 1;
  std::size_t last = 0; ///< 0: all that follow
  std::size_t stride = 1;
};

/// Whether files named one by one are the frames of a sequence: two or more in one folder, with one
/// extension, whose names differ in their last number alone ("run_08.vtu", "run_10.vtu").
bool isNumbered(const std::vector<std::string>& paths);

/// Finds the frames that `inputs` represent, in order of time:
/// - one .pvd file: a frame for each of its times, its parts together;
/// - one name with '*' or '?' that is no file itself: a frame for each file that matches, by the
///   last number in its name. Numbers that leave out a step are an error unless `allowGaps`;
/// - files for which isNumbered() holds: likewise;
/// - with `range`, one file of a format that holds steps: its time steps.
/// Empty where the inputs are plain meshes. Throws Error(Invalid) for a collection that cannot be
/// read, a file that is missing, a pattern that nothing matches and for gaps; Error(Usage) for a
/// range beyond the last frame, a range of inputs that are no sequence, and for a sequence beside
/// other inputs. Cost: the collection, or the folder's names.
std::vector<Frame> findFrames(const std::vector<std::string>& inputs,
                              const std::optional<FrameRange>& range, bool allowGaps,
                              Report& report, Progress& progress);

/// Whether a path has '*' or '?' in it and is no file itself.
bool isPattern(const std::string& path);
/// The files that `inputs` name, patterns replaced by those that match, by the last number in their
/// names and then by name. Throws Error(Invalid) for a pattern that nothing matches, Error(Usage)
/// for a .pvd collection, whose times are no parts of one volume.
std::vector<std::string> filesOf(const std::vector<std::string>& inputs);

/// "out/a.vdb" and 7 of 12 as "out/a.0007.vdb": the number last, four digits or more.
std::string frameName(const std::string& output, std::size_t number, std::size_t count);

} // namespace tetvdb
