// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/RenderJob.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/InArena.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/visualize/WritePng.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxPictures = 9999;
// Peak memory of drawing, in addition to the mesh (TriangleDrawable.h, Renderer.h).
constexpr std::size_t kBytesPerDrawnFace = 60, kBytesPerPixel = 100;

void requireRoom(std::size_t bytes, std::size_t limit, const char* advice) {
  const std::size_t left = limit > 0 ? memoryLeft(limit) : availableBytes();
  if (left > 0 && bytes > left)
    throw Error(Status::Limit, "",
                "drawing needs about " + std::to_string(bytes / 1000000) + " MB, there are " +
                    std::to_string(left / 1000000),
                advice);
}

class Render {
public:
  Render(const RenderJob& job, Report& report, Progress& progress)
      : job_(job), report_(report), progress_(progress) {}

  RenderResult run() {
    checkFiles();
    std::vector<PictureMaker::CaptionedSubject> subjects;
    {
      StageTimer timer(report_, "read");
      progress_.stage("read");
      for (const RenderInput& input : job_.inputs)
        subjects.push_back({open(input), std::filesystem::path(input.path).filename().string()});
    }
    std::unique_ptr<PictureMaker> maker;
    {
      StageTimer timer(report_, "scene");
      progress_.stage("scene");
      PictureOptions options = job_.picture;
      options.turntable = std::max<std::size_t>(job_.turntable, 1);
      maker = std::make_unique<PictureMaker>(std::move(subjects), options, progress_);
      requireRoom(kBytesPerPixel * static_cast<std::size_t>(maker->width()) *
                      static_cast<std::size_t>(maker->height()),
                  job_.maxMemory, "give a smaller `size`, or raise `max_memory`");
    }
    write(takePictures(*maker));
    result_.width = maker->width();
    result_.height = maker->height();
    result_.scale = maker->scale();
    for (Drawn drawn : maker->drawn()) {
      drawn.drawables.clear();
      drawn.media.clear();
      result_.drawn.push_back(std::move(drawn));
    }
    return std::move(result_);
  }

private:
  void checkFiles() {
    if (!job_.output.empty() || !job_.keep)
      requireExtension(job_.output, {".png"}, "name it .png");
    if (job_.turntable > kMaxPictures)
      throw Error(Status::Usage, "turntable", "more than 9999 pictures are too many");
    std::vector<std::string> inputs;
    for (const RenderInput& input : job_.inputs)
      inputs.push_back(input.path);
    const std::vector<std::string> outputs = pictureNames(job_.output, job_.turntable);
    if (job_.output.empty())
      return;
    requireSeparateFiles(filesAmong(inputs, job_.memory), outputs);
    requireWritable(outputs.front());
  }

  // The content of a file, as a subject.
  std::unique_ptr<Subject> open(const RenderInput& input) try {
    InputInfo& info = result_.inputs.emplace_back();
    info.path = input.path;
    if (input.isVolume) {
      VolumeShow show = job_.volume;
      show.color = job_.look.color;
      return subjectOf(readVolumeInput(input.path, report_, progress_, job_.memory), show);
    }
    if (holdsTriangles(input.path, job_.memory)) {
      TriangleMesh mesh = readSoup(input.path, &info, report_, progress_, job_.memory);
      requireRoom(kBytesPerDrawnFace * mesh.triangleCount(), job_.maxMemory,
                  "raise `max_memory`, or use a machine with more");
      return subjectOf(std::move(mesh), job_.look);
    }
    ReadOptions options;
    options.attributes = !job_.look.color.empty() && job_.look.color != "quality";
    return subjectOf(readTets(input.path, options, {}, &info, report_, progress_, job_.memory),
                     job_.look);
  } catch (const Error& error) {
    const std::string text = error.what();
    if (error.status() == Status::Cancelled || text.find(input.path) != std::string::npos)
      throw;
    throw Error(error.status(), input.path, text);
  }

  std::vector<std::string> takePictures(const PictureMaker& maker) {
    StageTimer timer(report_, "render");
    progress_.stage("render");
    const std::size_t count = std::max<std::size_t>(job_.turntable, 1);
    std::vector<std::string> files;
    for (std::size_t i = 0; i < count; ++i) {
      const double turn = static_cast<double>(i) / static_cast<double>(count);
      Image image = maker.take(turn, progress_);
      if (!job_.output.empty())
        files.push_back(encodePng(image));
      if (job_.keep)
        result_.kept.push_back(std::move(image));
    }
    return files;
  }

  void write(const std::vector<std::string>& files) {
    StageTimer timer(report_, "write");
    progress_.stage("write");
    const std::vector<std::string> names = pictureNames(job_.output, job_.turntable);
    for (std::size_t i = 0; i < files.size(); ++i) {
      AtomicFile file(names[i]);
      file.write(files[i].data(), files[i].size());
      file.commit();
      result_.outputs.push_back(written(names[i]));
    }
  }

  const RenderJob& job_;
  Report& report_;
  Progress& progress_;
  RenderResult result_;
};

} // namespace

std::vector<std::string> pictureNames(const std::string& output, std::size_t turntable) {
  if (turntable == 0)
    return {output};
  const std::size_t dot = output.size() - std::filesystem::path(output).extension().string().size();
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= turntable; ++i) {
    std::string number = std::to_string(i);
    number.insert(0, 4 - std::min<std::size_t>(number.size(), 4), '0');
    names.push_back(output.substr(0, dot) + "." + number + output.substr(dot));
  }
  return names;
}

RenderResult run(const RenderJob& job, Report& report, Progress& progress) {
  return inArena(job.threads, [&] { return Render(job, report, progress).run(); });
}

} // namespace tetvdb
