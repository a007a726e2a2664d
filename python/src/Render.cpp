// SPDX-License-Identifier: Apache-2.0
#include "Functions.h"
#include "Inputs.h"
#include "JobReport.h"
#include "MeshArrays.h"
#include "ParsePictures.h"
#include "Report.h"
#include "Settings.h"
#include "tetvdb/pipeline/RenderJob.h"

#include <memory>
#include <nanobind/stl/string.h>
#include <utility>

namespace tetvdb::python {
namespace {

void takeVolume(Settings& settings, RenderJob& job) {
  settings.takeWord("style",
                    {{"auto", VolumeStyle::Auto},
                     {"voxels", VolumeStyle::Voxels},
                     {"surface", VolumeStyle::Surface},
                     {"fog", VolumeStyle::Fog}},
                    job.volume.style);
  settings.take("grid", job.volume.grid);
  std::string slice;
  settings.take("slice", slice);
  if (slice.empty())
    return;
  if (settings.has("style"))
    Settings::refuse("slice", "is a style of its own", "leave `style` out");
  const Cut plane = cli::parseCut("`slice`", slice);
  job.volume.style = VolumeStyle::Slice;
  job.volume.slice.axis = static_cast<int>(plane.axis);
  job.volume.slice.at = plane.at;
  job.volume.slice.inUnits = plane.inUnits;
}

RenderJob jobOf(Settings& settings) {
  RenderJob job;
  job.keep = true;
  takeVolume(settings, job);
  settings.take("color", job.look.color);
  settings.take("wire", job.look.wire);
  settings.take("smooth", job.look.smooth);
  settings.take("defects", job.look.defects);
  PictureOptions& picture = job.picture;
  settings.take("view", picture.view);
  std::string up = "z", cut, range, background;
  settings.take("up_axis", up);
  if (up != "z" && up != "y")
    Settings::refuse("up_axis", "'" + up + "' is no axis that points up", "choose from z, y");
  if (up == "y")
    picture.worldUp = {0, 1, 0};
  if (!settings.has("view") && job.volume.style == VolumeStyle::Slice)
    picture.view = job.volume.slice.axis == 0                    ? "right"
                   : (job.volume.slice.axis == 2) == (up == "z") ? "top"
                                                                 : "front";
  settings.take("perspective", picture.lens.perspective);
  settings.take("color_map", picture.colorMap);
  settings.take("cut", cut);
  if (!cut.empty())
    picture.cut = cli::parseCut("`cut`", cut);
  settings.take("range", range);
  if (!range.empty())
    picture.range = cli::parseRange("`range`", range);
  std::vector<std::string> size;
  settings.take("size", size);
  if (size.size() == 2)
    size = {size[0] + "x" + size[1]};
  if (!size.empty())
    cli::parseSize("`size`", size.front(), picture.width, picture.height);
  settings.take("background", background);
  if (!background.empty())
    cli::parseBackground("`background`", background, picture.backgroundTop,
                         picture.backgroundBottom);
  int turntable = 0;
  settings.take("turntable", turntable);
  if (turntable < 0)
    Settings::refuse("turntable", "is below 0", "give a number of pictures");
  job.turntable = static_cast<std::size_t>(turntable);
  return job;
}

// Height x width x 3, or 4 where a pixel can be seen through; of a turntable all, one after the
// other.
nb::object arrayOf(const std::vector<Image>& images, bool several) {
  bool withAlpha = false;
  for (const Image& image : images)
    withAlpha = withAlpha || !image.isOpaque();
  auto bytes = std::make_unique<std::vector<std::uint8_t>>();
  for (const Image& image : images) {
    const std::vector<std::uint8_t> one = srgbBytes(image, withAlpha);
    bytes->insert(bytes->end(), one.begin(), one.end());
  }
  std::vector<std::size_t> shape{static_cast<std::size_t>(images.front().height),
                                 static_cast<std::size_t>(images.front().width),
                                 withAlpha ? std::size_t(4) : std::size_t(3)};
  if (several)
    shape.insert(shape.begin(), images.size());
  return arrayObject(std::move(*bytes), shape, nb::dtype<std::uint8_t>());
}

nb::object renderInputs(const nb::list& given, const nb::dict& keywords) {
  Settings settings(keywords);
  RenderJob job = jobOf(settings);
  const JobLimits limits = settings.finish(job);
  Inputs inputs = inputsOf(given);
  for (const std::string& name : inputs.names)
    job.inputs.push_back({name, isVolume(name, inputs.memory)});
  job.memory = std::move(inputs.memory);
  JobRun work(limits);
  const RenderResult result =
      work([&](Report& report, Progress& progress) { return run(job, report, progress); });
  return arrayOf(result.kept, job.turntable > 0);
}

} // namespace

void addRender(nb::module_& module) {
  module.def("render", &renderInputs, nb::arg("inputs"), nb::arg("settings"),
             "Internal: tetvdb.render() with its inputs told apart.");
}

} // namespace tetvdb::python
