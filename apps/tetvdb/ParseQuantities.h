// SPDX-License-Identifier: Apache-2.0
//
// Parses option values that are numbers and rules. Every function throws Error(Usage) that names
// the option.
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/pipeline/FindFrames.h"
#include "tetvdb/pipeline/Mesher.h"
#include "tetvdb/pipeline/RelativeLength.h"
#include "tetvdb/voxelize/DeviceChoice.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb::cli {

/// Throws Error(Usage): the value `text` of an option cannot be used.
[[noreturn]] void refuse(const std::string& option, const std::string& text,
                         const std::string& advice);

/// "1,2.5,-3e-2": the numbers between the commas. NaN is refused, infinity is not.
std::vector<double> parseNumbers(const std::string& option, const std::string& text);

/// Three numbers, all finite.
Vec3d parsePoint(const std::string& option, const std::string& text);

/// One voxel size for all axes or three, each a finite number above zero.
Vec3d parseVoxelSize(const std::string& option, const std::string& text);

/// "500M", "4G", "1.5T" or a plain number of bytes; K, M, G and T are powers of 1024. Above zero.
std::size_t parseBytes(const std::string& option, const std::string& text);

/// A finite length above zero.
double parseLength(const std::string& option, const std::string& text);

enum class Voxels : bool { None, Known };

/// A finite length above zero: "0.5", "1e-3d" (of the diagonal) or, where voxels are known, "0.5v".
RelativeLength parseRelativeLength(const std::string& option, const std::string& text,
                                   Voxels voxels);

/// "winding", "nonzero", "parity" or "flood"; the parser has checked that it is one of them.
InsideRule parseInsideRule(const std::string& name);

/// "auto", "envelope" or "winding", likewise.
Mesher parseMesher(const std::string& name);

/// Seconds, above zero.
double parseSeconds(const std::string& option, const std::string& text);

/// "auto", "cpu", "cuda", "cuda:1" or "cuda:0,1".
DeviceChoice parseDevice(const std::string& option, const std::string& text);

/// "all", "FIRST:LAST" or "FIRST:LAST:STRIDE", counted from 1; LAST may be left out. Nothing of an
/// empty text.
std::optional<FrameRange> parseFrames(const std::string& option, const std::string& text);

} // namespace tetvdb::cli
