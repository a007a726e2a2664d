// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "CompareMeshFiles.h"
#include "JsonReport.h"
#include "ProcessLimits.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/visualize/ComparePicture.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArguments {
  std::string a, b, output;
  double tolerance = 0;
  JobOptions limits;
};

const char* const kCompareExamples = R"(Examples:
  tetvdb compare a.vdb b.vdb                     exit status 0 if they are the same, 8 if not
  tetvdb compare a.vdb b.nvdb --tolerance 1e-3   values may differ by as much
  tetvdb compare broken.stl whole.stl --tolerance 0.2
      8 if a point of one surface is farther than 0.2 units from the other

  tetvdb compare before.vdb after.vdb -o difference.png
      a picture as well: both, and where they differ; of meshes both in colours of their distance

Grids are paired by name and compared voxel by voxel; a voxel that is inactive counts with the
grid's background. IoU: voxels active in both over voxels active in either.
Meshes are measured both ways, from points spread evenly over their area and from their vertices to
the other mesh; tets count by their surface. Without --tolerance, meshes are the same where they
are within 1e-9 of the diagonal.)";

bool isVolume(const std::string& path) {
  const MappedFile readable(path); // a missing file is told apart from one that is no volume
  return isVolumeFile(path);
}

// With a tolerance only values decide; without one everything but metadata does.
bool within(const VolumeComparison& comparison, double tolerance) {
  if (tolerance == 0)
    return comparison.same();
  const bool paired = comparison.onlyA.empty() && comparison.onlyB.empty() &&
                      comparison.incomparable.empty() && comparison.sameTransform;
  return paired && std::all_of(comparison.grids.begin(), comparison.grids.end(),
                               [&](const GridComparison& grid) {
                                 return grid.largestDifference <= tolerance;
                               });
}

Json comparisonSection(const VolumeComparison& comparison, bool same) {
  Json grids = Json::array();
  for (const GridComparison& grid : comparison.grids)
    grids.push_back({{"name", grid.name},
                     {"iou", grid.iou()},
                     {"active_a", grid.activeA},
                     {"active_b", grid.activeB},
                     {"active_both", grid.activeBoth},
                     {"state_differs", grid.stateDiffers},
                     {"value_differs", grid.valueDiffers},
                     {"largest_difference", grid.largestDifference}});
  return {{"same", same},
          {"same_hash", comparison.sameHash},
          {"same_transform", comparison.sameTransform},
          {"grids", std::move(grids)},
          {"only_a", comparison.onlyA},
          {"only_b", comparison.onlyB},
          {"incomparable", comparison.incomparable}};
}

std::string comparisonText(const VolumeComparison& comparison, const CompareArguments& options,
                           bool same) {
  std::string text;
  for (const GridComparison& grid : comparison.grids)
    text += fmt::format("{}: IoU {:.9g}, {} voxels active in only one, {} with other values, "
                        "largest difference {:.6g}\n",
                        oneLine(grid.name), grid.iou(), grid.stateDiffers, grid.valueDiffers,
                        grid.largestDifference);
  for (const std::string& name : comparison.onlyA)
    text += fmt::format("{}: only in {}\n", oneLine(name), oneLine(options.a));
  for (const std::string& name : comparison.onlyB)
    text += fmt::format("{}: only in {}\n", oneLine(name), oneLine(options.b));
  for (const std::string& name : comparison.incomparable)
    text += fmt::format("{}: of another type in each\n", oneLine(name));
  if (!comparison.sameTransform)
    text += "the transforms differ\n";
  return text + (same ? "same\n" : "different\n");
}

void report(const VolumeComparison& comparison, const CompareArguments& options, Session& session) {
  const bool same = within(comparison, options.tolerance);
  session.sections["compare"] = comparisonSection(comparison, same);
  session.text = comparisonText(comparison, options, same);
  session.textIsSummary = true;
  if (!same)
    session.status = Status::Found;
}

void runCompare(const CompareArguments& options, Session& session) {
  limitProcess(options.limits, session.progress);
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw Error(Status::Usage, "--tolerance", "must be zero or more");
  session.sections["input"] = {{{"path", options.a}}, {{"path", options.b}}};
  const bool volumes = isVolume(options.a);
  if (isVolume(options.b) != volumes)
    throw Error(Status::Usage, options.b,
                std::string("is a ") + (volumes ? "mesh" : "volume") + ", but " + options.a +
                    " is a " + (volumes ? "volume" : "mesh"),
                "compare two volumes or two meshes; 'tetvdb repair' makes a mesh of a volume");
  if (!options.output.empty()) {
    requireExtension(options.output, {".png"}, "name it .png");
    requireWritable(options.output);
  }
  if (!volumes) {
    compareMeshFiles(options.a, options.b, options.tolerance, options.output, session);
    return;
  }
  if (options.output.empty() && isLargeVolume(options.a) && isLargeVolume(options.b)) {
    session.progress.stage("compare");
    return report(compareVolumeFiles(options.a, options.b, session.progress), options, session);
  }
  session.progress.stage("read");
  const Volume a = readVolume(options.a, session.progress);
  const Volume b = readVolume(options.b, session.progress);
  warnOfReading(a, options.a, session.report);
  warnOfReading(b, options.b, session.report);
  session.progress.stage("compare");
  const VolumeComparison comparison = compareVolumes(a, b);
  report(comparison, options, session);
  if (!options.output.empty()) {
    session.progress.stage("draw");
    writeComparison(
        comparePicture(a, b, comparison, namesOf(options.a, options.b), session.progress),
        options.output, session);
  }
}

} // namespace

Command addCompare(CLI::App& program) {
  CLI::App* command =
      program.add_subcommand("compare", "Say how two volumes, or two meshes, differ");
  auto options = std::make_shared<CompareArguments>();
  command->add_option("A", options->a, "A volume or a mesh")->required()->type_name("");
  command->add_option("B", options->b, "Another of the same kind")->required()->type_name("");
  command->add_option("-o,--output", options->output, "Draw both and their difference: .png")
      ->check(notEmpty())
      ->type_name("FILE");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Largest difference of values to accept; of meshes, largest distance")
      ->type_name("T");
  addProcessLimitOptions(*command, options->limits);
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kCompareExamples);
  result.run = [options](Session& session) { runCompare(*options, session); };
  result.files = [options] { return FileNames{{options->a, options->b}, {options->output}}; };
  return result;
}

} // namespace tetvdb::cli
