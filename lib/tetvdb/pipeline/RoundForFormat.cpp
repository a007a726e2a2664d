// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/RoundForFormat.h"

#include "tetvdb/io/Formats.h"
#include "tetvdb/surface/LocalRepair.h"

#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr int kMoreRoundings = 3;

} // namespace

std::optional<FloatRounding> roundForFormat(TriangleMesh& mesh, const std::string& path,
                                            Report& report, Progress& progress) {
  const Format* format = formatForEnding(path, FormatUse::WriteTriangles);
  if (format == nullptr || !format->hasFloatCoordinates)
    return std::nullopt;
  StageTimer timer(report, "round");
  progress.stage("round");
  FloatRounding rounded = roundToFloats(mesh, progress);
  // The sides of a wall that is thinner than floats resolve may still cross.
  for (int i = 0; i < kMoreRoundings && rounded.crossings > 0; ++i) {
    TriangleMesh cut = mesh;
    if (!repairLocally(cut, progress).succeeded)
      break;
    const FloatRounding again = roundToFloats(cut, progress);
    if (again.crossings >= rounded.crossings)
      break;
    mesh = std::move(cut);
    rounded.crossings = again.crossings;
  }
  if (!rounded.complete || rounded.crossings > 0) {
    report.warn("float-crossings",
                (rounded.complete ? fmt::format("{} pairs of faces cross, or faces have no area",
                                                rounded.crossings)
                                  : "vertices are equal, and faces may cross there") +
                    ", since the coordinates of the output's format are 32-bit floats; .ply and "
                    ".obj have doubles");
    report.partial = true;
  }
  return rounded;
}

} // namespace tetvdb
