// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/Preview.h"

#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/visualize/PictureMaker.h"
#include "tetvdb/visualize/WritePng.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <unistd.h>
#include <utility>

namespace tetvdb {
namespace {

// Low cost: panels are small, few of their pixels are refined, and each uses two samples of the
// sky.
constexpr int kWidth = 256, kHeight = 192; ///< of a panel
constexpr double kRefinedShare = 0.06;
constexpr std::uint32_t kSkyRays = 2;
constexpr int kMaxArrays = 6; ///< panels of arrays

PictureOptions optionsFor(bool yUp) {
  PictureOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.captions = true;
  options.render.refinedShare = kRefinedShare;
  options.render.skyRays = kSkyRays;
  if (yUp)
    options.worldUp = {0, 1, 0};
  return options;
}

Image pictureOf(std::unique_ptr<Subject> subject, const std::string& caption,
                const PictureOptions& options, Report& report, Progress& progress) {
  StageTimer timer(report, "preview");
  progress.stage("preview");
  std::vector<PictureMaker::CaptionedSubject> subjects;
  subjects.push_back({std::move(subject), caption});
  return PictureMaker(std::move(subjects), options, progress).take(0, progress);
}

} // namespace

void checkPreviewPath(const std::string& path) {
  if (path.empty())
    return;
  requireExtension(path, {".png"}, "name it .png");
  requireWritable(path);
}

void Preview::input(const TriangleMesh& mesh, Report& report, Progress& progress) {
  surface(mesh, "input", report, progress);
}

void Preview::surface(const TriangleMesh& mesh, const std::string& panel, Report& report,
                      Progress& progress) {
  MeshLook look;
  look.defects = true;
  panels_.push_back({panel, pictureOf(subjectOf(TriangleMesh(mesh), look), panel, optionsFor(yUp_),
                                      report, progress)});
}

void Preview::tets(const TetMesh& mesh, Report& report, Progress& progress) {
  MeshLook look;
  look.color = "quality";
  PictureOptions options = optionsFor(yUp_);
  options.cut = Cut{};
  panels_.push_back({"tets", pictureOf(subjectOf(TetMesh(mesh), look), "tets, cut by quality",
                                       options, report, progress)});
}

void Preview::volume(const Volume& volume, Report& report, Progress& progress) {
  VolumeShow show;
  panels_.push_back(
      {"volume", pictureOf(subjectOf(volume, show), "volume", optionsFor(yUp_), report, progress)});
  show.style = VolumeStyle::Slice;
  show.slice.axis = yUp_ ? 1 : 2;
  PictureOptions options = optionsFor(yUp_);
  options.view = "top";
  panels_.push_back({"slice", pictureOf(subjectOf(volume, show), yUp_ ? "slice y" : "slice z",
                                        options, report, progress)});
  arrays(volume, show, options, report, progress);
}

void Preview::arrays(const Volume& volume, VolumeShow show, const PictureOptions& options,
                     Report& report, Progress& progress) {
  const auto isShape = [](const openvdb::GridBase::Ptr& grid) {
    const std::optional<GridKind> kind = gridKindOf(grid->getName());
    return kind && infoOf(*kind).drawsSolid;
  };
  const auto& grids = volume.grids().all;
  const bool anyShape = std::any_of(grids.begin(), grids.end(), isShape);
  int shown = 0;
  for (std::size_t i = anyShape ? 0 : 1; i < grids.size();
       ++i) { // without a shape, 0 is the main one
    if (isShape(grids[i]) || grids[i]->empty())
      continue;
    if (++shown > kMaxArrays) {
      report.warn("preview-arrays",
                  fmt::format("the preview shows the first {} arrays", kMaxArrays));
      return;
    }
    show.grid = show.color = grids[i]->getName();
    panels_.push_back({show.grid, pictureOf(subjectOf(volume, show),
                                            show.grid + (yUp_ ? ", slice y" : ", slice z"), options,
                                            report, progress)});
  }
}

PreviewInfo Preview::info() const {
  PreviewInfo info;
  for (const Panel& panel : panels_) {
    info.panels.push_back(panel.name);
    info.width += panel.image.width;
    info.height = std::max(info.height, panel.image.height);
  }
  return info;
}

void Preview::write(const std::string& path) const {
  if (panels_.empty())
    return;
  const PreviewInfo size = info();
  Image strip(size.width, size.height);
  int x = 0;
  for (const Panel& panel : panels_) {
    strip.paste(panel.image, x, 0);
    x += panel.image.width;
  }
  writePng(path, strip);
}

std::optional<PreviewInfo> Preview::writeBeside(const std::string& output,
                                                const std::string& path) const {
  if (panels_.empty())
    return std::nullopt;
  try {
    write(path);
  } catch (...) {
    ::unlink(output.c_str());
    throw;
  }
  return info();
}

} // namespace tetvdb
