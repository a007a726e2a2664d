// SPDX-License-Identifier: Apache-2.0
//
// Checks whether a volume, or a sequence of volumes, is displayed by another program.
//
//   for (const tetvdb::Finding& f : tetvdb::checkVolumes({"a.vdb"}, {}, progress))
//     std::puts((f.text + "; " + f.cure).c_str());
#pragma once

#include "tetvdb/core/Progress.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

enum class CheckTarget : std::uint8_t { Blender, Houdini };

struct CheckOptions {
  CheckTarget target = CheckTarget::Blender;
  double denseBytes = 2e9; ///< limit of a grid's size when uploaded as a dense array
};

/// One finding.
struct Finding {
  enum class Weight : std::uint8_t {
    Note,    ///< information; nothing is wrong
    Warning, ///< something will not look as intended
    Error    ///< a grid, or the file, will not be displayed
  };
  Weight weight = Weight::Warning;
  std::string code; ///< stable and short: "tiles-alone"
  std::string file;
  std::string grid; ///< empty: the file as a whole
  std::string text; ///< the fault, one sentence without a full stop
  std::string cure; ///< the advice
};

/// Checks every file, then the files as a sequence if there are several: no-voxels, hidden-values,
/// a level set without an inside and extent are then assessed over all frames, and the finding
/// names a frame in which it occurs; a grid that is empty in some frames is a note. Findings are in
/// the files' order, for a file in its grids' order, those of the sequence last:
/// - file-type: the target does not read it
/// - no-voxels, tiles-alone: nothing is drawn
/// - name: empty, or used twice in the file
/// - type: the target does not draw grids of this type
/// - class: not set, so that surfaces made of the grid are inside out
/// - transform: not affine (Blender draws nothing), or not that of the file's other grids
/// - hidden-values: densities below what is drawn, negative ones, or far above 1
/// - background: other than 0, which Blender draws around the voxels (a note if negative)
/// - memory: bytes when the active box is uploaded as a dense array
/// - voxel-size, extent: too small for the target, or a size that indicates another unit
/// - up-axis: the file states that another axis is up (or, for Houdini, states nothing)
/// - velocity-name (a note): Blender's shaders know the grid by another name
/// - usual-name (a note): no grid has the name that the target's default material expects
/// - sequence-name, sequence-gap, sequence-grids, sequence-transform: of several files
/// Facts about Blender are from version 3.4 as run by tests/blender/test_claims.py (docs/dcc.md).
/// Throws Error(Invalid) for a file that cannot be read, Error(Cancelled). Reads one file at a
/// time, of a .vdb file one child of a root node.
std::vector<Finding> checkVolumes(const std::vector<std::string>& paths,
                                  const CheckOptions& options, Progress& progress);

} // namespace tetvdb
