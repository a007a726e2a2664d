// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FrameMark.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/HashText.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/volume/Grids.h"

#include <filesystem>
#include <fmt/format.h>
#include <openvdb/io/File.h>

namespace tetvdb {
namespace {

// The text of all options, each with an end mark, so that different jobs have different texts.
class Text {
public:
  template <typename T>
  Text& operator<<(const T& value) {
    text_ += fmt::format("{}\x1f", value);
    return *this;
  }
  Text& operator<<(const Vec3d& v) { return *this << v[0] << v[1] << v[2]; }
  Text& operator<<(const std::vector<std::string>& words) {
    *this << words.size();
    for (const std::string& word : words)
      *this << word;
    return *this;
  }
  Text& operator<<(const std::vector<NamedRange>& ranges) {
    *this << ranges.size();
    for (const NamedRange& range : ranges)
      *this << range.grid << range.low << range.high;
    return *this;
  }
  const std::string& text() const { return text_; }

private:
  std::string text_;
};

void addInput(Text& text, const std::string& path) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(path, ignored);
  const auto time = std::filesystem::last_write_time(path, ignored);
  text << path << (ignored ? 0 : size) << (ignored ? 0 : time.time_since_epoch().count());
}

// The files that are read with it.
void addOthers(Text& text, const std::string& path, int step) {
  try {
    const MappedFile file(path);
    const auto filesOfStep = formatOf(sniffFormat(file.bytes(), path)).filesOfStep;
    if (filesOfStep != nullptr)
      for (const std::string& other : filesOfStep(file.source(), step))
        addInput(text, other);
  } catch (const Error&) { // told when it is read
  }
}

void addFields(Text& text, const VoxelizeJob& job) {
  const FieldOptions& fields = job.fields;
  text << fields.requests.size() << fields.all;
  for (const FieldRequest& request : fields.requests)
    text << request.grid << request.array << static_cast<int>(request.part) << request.component;
  text << fields.clamp << fields.remap << fields.background.size();
  for (const NamedNumber& number : fields.background)
    text << number.grid << number.value;
  // The range of all frames is relevant if values are mapped by it.
  if (!fields.remap.empty())
    for (const ValueRange& range : job.fieldRanges)
      text << range.low << range.high;
  text << job.warp.array << job.warp.factor << job.smooth;
}

} // namespace

std::string frameMark(const VoxelizeJob& job) {
  Text text;
  text << version();
  for (const std::string& input : job.inputs) {
    addInput(text, input);
    addOthers(text, input, job.read.timeStep);
  }
  text << job.read.regionArray << job.read.timeStep << job.filter.regions << job.filter.exclude
       << job.filter.boxMin << job.filter.boxMax;
  text << job.clean.weldDistance.value_or(-1) << job.clean.orient
       << static_cast<int>(job.solid.inside) << job.solid.shell << static_cast<int>(job.solid.side)
       << static_cast<int>(job.mesher) << job.epsilon.value << static_cast<int>(job.epsilon.unit)
       << static_cast<int>(job.up);
  text << job.voxelize.voxelSize << job.voxelize.origin << static_cast<int>(job.voxelize.rule)
       << job.voxelize.fit.voxels << job.voxelize.fit.padding << job.grids.size()
       << job.shapes.halfWidth;
  for (const GridKind kind : job.grids)
    text << static_cast<int>(kind);
  addFields(text, job);
  text << job.units << job.half << (job.maskType == MaskType::Mask ? " MaskGrid" : "");
  if (!job.levels.isEmpty())
    text << " levels" << job.levels.first << job.levels.last;
  for (const auto& [key, value] : job.metadata)
    text << key << value;
  return textOf(XXH3_128bits(text.text().data(), text.text().size()));
}

bool isFinished(const std::string& path, const std::string& mark) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) ||
      std::filesystem::path(path).extension() != ".vdb")
    return false;
  initializeOpenVDB();
  try {
    openvdb::io::File file(path);
    file.open(false);
    const auto metadata = file.getMetadata();
    return metadata && (*metadata)["job"] && (*metadata)["job"]->str() == mark;
  } catch (const std::exception&) {
    return false;
  }
}

} // namespace tetvdb
