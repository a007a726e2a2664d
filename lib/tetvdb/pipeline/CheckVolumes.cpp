// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/CheckVolumes.h"

#include "tetvdb/fields/ShownValues.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/pipeline/NumberedPath.h"
#include "tetvdb/pipeline/SequenceGrids.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using Weight = Finding::Weight;

// VTK's writer does not make smaller voxels, since OpenVDB refuses a volume below 3e-15.
constexpr double kSmallVoxel = 1e-4;
// Metres: smaller or larger models are probably in another unit.
constexpr double kSmallModel = 0.01, kLargeModel = 1000;

// Properties of a frame that are compared or assessed over all frames.
struct FrameFacts {
  std::vector<GridInfo> infos;
  std::string units;                                   ///< of length, as given in the file
  std::set<std::pair<std::string, std::string>> grids; ///< name and type
  std::map<std::string, openvdb::math::Transform::ConstPtr> transforms;
};

// Whether voxels coincide: to a millionth of a voxel's size, since some programs store sizes as
// floats, and a thousandth of it in position.
bool coincide(const openvdb::math::Transform& a, const openvdb::math::Transform& b) {
  if (!a.isLinear() || !b.isLinear())
    return canonicalBytes(a) == canonicalBytes(b);
  const openvdb::Mat4d m = a.baseMap()->getAffineMap()->getConstMat4();
  const openvdb::Mat4d n = b.baseMap()->getAffineMap()->getConstMat4();
  double size = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      size = std::max(size, std::abs(m[i][k]));
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      if (std::abs(m[i][k] - n[i][k]) > (i < 3 ? 1e-6 : 1e-3) * size)
        return false;
  return true;
}

std::string targetName(CheckTarget target) {
  return target == CheckTarget::Blender ? "Blender" : "Houdini";
}

// The background of a scalar grid.
std::optional<double> numberBackground(const openvdb::GridBase& base) {
  std::optional<double> background;
  base.apply<openvdb::TypeList<openvdb::FloatGrid, openvdb::DoubleGrid, openvdb::Int32Grid,
                               openvdb::Int64Grid>>(
      [&](const auto& grid) { background = static_cast<double>(grid.background()); });
  return background;
}

double valueBytes(const std::string& type) {
  if (type == "vec3s" || type == "vec3i")
    return 12; // 16 on most GPUs
  if (type == "vec3d")
    return 24;
  return type == "double" || type == "int64" ? 8 : 4;
}

// Checks the values and the size of grids, in one file or in all frames of a sequence.
class ContentCheck {
public:
  ContentCheck(const std::string& path, const CheckOptions& options, std::vector<Finding>& findings)
      : path_(path), options_(options), findings_(findings) {}

  void checkExtent(const std::vector<GridInfo>& infos, const std::string& units) const {
    double longest = 0;
    for (const GridInfo& info : infos)
      for (std::size_t k = 0; k < 3 && info.activeVoxels > 0; ++k)
        longest = std::max(longest, (static_cast<double>(info.boxMax[k]) - info.boxMin[k] + 1) *
                                        std::abs(info.transform.voxelSize[k]));
    if (longest == 0 || (longest >= kSmallModel && longest <= kLargeModel))
      return;
    add(Weight::Warning, "extent", "",
        fmt::format("is {:.4g} units long{}, and in {} a unit is a metre", longest,
                    units.empty() ? "" : " (" + units + ")", targetName(options_.target)),
        "scale the object after import, or the mesh before");
  }

  void checkValues(const GridInfo& info, const std::string& where = "") const {
    if (info.activeVoxels == 0)
      return add(Weight::Error, "no-voxels", info.name, "has no active voxels" + where,
                 "leave it out");
    const bool number = info.type == "float" || info.type == "double";
    if (number && info.gridClass == "level set" && !(info.minValue < 0))
      add(Weight::Warning, "class", info.name,
          "has the class level set but no negative values" + where + ": nothing is inside",
          "set its class to 'fog volume'");
    const std::string hidden = whyHidden(info);
    if (!hidden.empty())
      add(Weight::Warning, "hidden-values", info.name, hidden + where,
          fmt::format("tetvdb voxelize with `remap={}=0:1`{}", info.name,
                      options_.target == CheckTarget::Blender
                          ? ", or lower the render setting Volume > Clipping"
                          : ""));
  }

  void add(Weight weight, std::string code, std::string grid, std::string text,
           std::string cure) const {
    findings_.push_back(
        {weight, std::move(code), path_, std::move(grid), std::move(text), std::move(cure)});
  }

private:
  const std::string& path_;
  const CheckOptions& options_;
  std::vector<Finding>& findings_;
};

class FileCheck {
public:
  /// `alone`: the file is not a frame of a sequence, whose values and size are assessed together.
  FileCheck(const std::string& path, bool alone, const CheckOptions& options,
            std::vector<Finding>& findings)
      : path_(path), alone_(alone), options_(options), content_(path, options, findings) {}

  /// `infos`: of the volume's grids, whose voxels may be missing.
  FrameFacts run(const Volume& volume, const std::vector<GridInfo>& infos) {
    const openvdb::GridPtrVec& grids = volume.grids().all;
    checkFile(volume, infos);
    FrameFacts facts;
    std::set<std::string> names;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      grid_ = infos[i].name;
      if (infos[i].name.empty())
        add(Weight::Error, "name", "has no name, so that no material can refer to it",
            "give it a name");
      else if (!names.insert(infos[i].name).second)
        add(Weight::Error, "name", "is the name of two grids: one of them hides the other",
            "give each a unique name");
      checkTransform(grids[i]->transform(), grids.front()->transform());
      mask_ = grids[i]->isType<openvdb::MaskGrid>();
      background_ = numberBackground(*grids[i]).value_or(0);
      checkGrid(infos[i]);
      facts.grids.insert({infos[i].name, infos[i].type});
      facts.transforms[infos[i].name] = grids[i]->transform().copy();
    }
    for (const UnreadGrid& grid : volume.unread) {
      grid_ = grid.name;
      add(Weight::Note, "unread", "is of type " + grid.type + ", which is not checked",
          "check it in the program that made it");
    }
    if (forBlender())
      checkVelocity(names);
    facts.infos = infos;
    const auto units = volume.metadata.find("units");
    facts.units = units == volume.metadata.end() ? "" : units->second;
    if (alone_)
      content_.checkExtent(infos, facts.units);
    return facts;
  }

private:
  void add(Weight weight, std::string code, std::string text, std::string cure) {
    content_.add(weight, std::move(code), grid_, std::move(text), std::move(cure));
  }
  bool forBlender() const { return options_.target == CheckTarget::Blender; }

  void checkFile(const Volume& volume, const std::vector<GridInfo>& infos) {
    if (fs::path(path_).extension() != ".vdb")
      add(Weight::Error, "file-type",
          targetName(options_.target) + " reads .vdb files, not " +
              fs::path(path_).extension().string(),
          "write a .vdb file");
    const bool usual = std::any_of(infos.begin(), infos.end(), [&](const GridInfo& info) {
      return info.name == "density" || info.gridClass == "level set" ||
             (!forBlender() && info.name == "surface");
    });
    if (!usual)
      add(Weight::Note, "usual-name", "no grid is named 'density', which default materials expect",
          "name the grid in the material (Blender: Principled Volume, Density Attribute)");
    const auto up = volume.metadata.find("up_axis");
    const bool yUp = up != volume.metadata.end() && up->second == "y";
    if (forBlender() && yUp)
      add(Weight::Warning, "up-axis", "was made with y up, but in Blender z is up",
          "voxelize without `up_axis=y`, or rotate the object by 90 degrees about x");
    if (!forBlender() && !yUp)
      add(Weight::Note, "up-axis",
          "in Houdini y is up; the file does not state that it was "
          "made so",
          "if the model lies on its side, voxelize with `up_axis=y`");
  }

  void checkTransform(const openvdb::math::Transform& transform,
                      const openvdb::math::Transform& first) {
    const std::string frustum = "has a transform that is not affine (a frustum), ";
    if (!transform.isLinear())
      add(forBlender() ? Weight::Error : Weight::Warning, "transform",
          frustum + (forBlender() ? "which Blender's Cycles does not draw"
                                  : "which not every program supports"),
          "resample it to a linear transform");
    else if (!coincide(transform, first))
      add(Weight::Warning, "transform",
          "has a different transform from the file's first grid: their voxels do not "
          "coincide, "
          "and combining the grids requires resampling",
          "make all grids in one run of tetvdb voxelize");
  }

  // Blender recognises the volume's velocity by these names; shaders then know that grid only by
  // the first of them.
  void checkVelocity(const std::set<std::string>& names) {
    for (const char* name : {"velocity", "vel", "v"}) {
      if (names.count(name) == 0)
        continue;
      grid_ = name;
      if (grid_ != "velocity")
        add(Weight::Note, "velocity-name",
            "is used by Blender as the velocity: shaders find it as 'velocity', not by its "
            "name",
            "use 'velocity' in the material, or voxelize with `derive=NAME=" + grid_ + "`");
      return;
    }
  }

  void checkGrid(const GridInfo& info) {
    if (alone_)
      content_.checkValues(info);
    if (info.activeVoxels == 0)
      return;
    if (forBlender() && info.leaves == 0)
      add(Weight::Error, "tiles-alone", "has only tiles, which Blender 3.4 and older do not draw",
          "make it with tetvdb voxelize, which opens one tile, or voxelize its tiles");
    checkType(info);
    checkClass(info);
    if (forBlender() && background_ != 0 && info.gridClass != "level set")
      add(background_ > 0 ? Weight::Warning : Weight::Note, "background",
          fmt::format("has a background of {:.6g}, which Blender also draws around the voxels",
                      background_),
          background_ > 0 ? "give it the background 0, or multiply it by 'density' in the material"
                          : "where it is drawn as light, multiply it by 'density' in the material");
    double box = 1;
    for (std::size_t k = 0; k < 3; ++k)
      box *= static_cast<double>(info.boxMax[k]) - info.boxMin[k] + 1;
    const double bytes = box * valueBytes(info.type);
    if (bytes > options_.denseBytes)
      add(Weight::Warning, "memory",
          fmt::format("takes {:.1f} GB when uploaded as a dense array, as by Blender without "
                      "NanoVDB and by real-time renderers",
                      bytes / 1e9),
          "use larger voxels, or cut it in parts with `bbox`");
    const Vec3d& size = info.transform.voxelSize;
    const double side = std::min({std::abs(size[0]), std::abs(size[1]), std::abs(size[2])});
    if (side < kSmallVoxel)
      add(Weight::Warning, "voxel-size",
          fmt::format("has voxels of {:.3g} units, near the minimum of programs (1.45e-5, or "
                      "1e-4 for some)",
                      side),
          "use a smaller unit of length, such as millimetres for metres");
  }

  void checkType(const GridInfo& info) {
    static const std::set<std::string> kDrawn = {"float", "double", "int32", "int64",
                                                 "bool",  "vec3s",  "vec3d", "vec3i"};
    if (mask_) // its value type is bool
      add(Weight::Error, "type",
          forBlender() ? "is a mask grid, which Blender builds with NanoVDB do not draw"
                       : "is a mask grid, which Houdini's translation does not support",
          "store it as bool, as voxelize does with `grid=mask`");
    else if (kDrawn.count(info.type) == 0)
      add(Weight::Error, "type", "is of type '" + info.type + "', which is not drawn as a volume",
          "convert it to float");
    else if (info.type == "double" || info.type == "int64" || info.type == "vec3d")
      add(Weight::Note, "type",
          "is of type " + info.type + ", with twice the memory and no visible difference",
          "store it as float, int32 or vec3s");
  }

  void checkClass(const GridInfo& info) {
    const bool number = info.type == "float" || info.type == "double";
    if (number && info.gridClass == "unknown")
      add(Weight::Warning, "class",
          "has no class: surfaces made of a level set without it are inside out",
          "set it to 'fog volume' or 'level set'");
  }

  const std::string& path_;
  const bool alone_;
  const CheckOptions& options_;
  const ContentCheck content_;
  std::string grid_;
  bool mask_ = false;     ///< the grid is a MaskGrid
  double background_ = 0; ///< of a scalar grid
};

void checkNames(const std::vector<std::string>& paths, CheckTarget target,
                std::vector<Finding>& findings) {
  const std::string rename = "name frames NAME.0001.vdb, NAME.0002.vdb and so on";
  const NumberedPath first(paths.front());
  std::vector<std::pair<unsigned long long, std::string>> numbers;
  for (const std::string& path : paths) {
    const NumberedPath name(path);
    if (!name.number || name.before != first.before || name.after != first.after) {
      findings.push_back({Weight::Error, "sequence-name", path, "",
                          name.number
                              ? "is not named like the first frame"
                              : "has no number in its name: it is not a frame of a sequence",
                          rename});
      continue;
    }
    if (!name.after.empty() && target == CheckTarget::Blender)
      findings.push_back(
          {Weight::Error, "sequence-name", path, "",
           "has '" + name.after + "' after its number: Blender shows the first file in all frames",
           rename});
    if (name.digits != fmt::format("{:0{}}", *name.number, first.digits.size()))
      findings.push_back(
          {Weight::Error, "sequence-name", path, "",
           fmt::format("has a different number of zeros from '{}': players look for a "
                       "file that does not exist",
                       first.digits),
           rename});
    numbers.emplace_back(*name.number, path);
  }
  std::sort(numbers.begin(), numbers.end());
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const auto [before, ignored] = numbers[i - 1];
    const auto& [number, path] = numbers[i];
    if (number == before)
      findings.push_back({Weight::Error, "sequence-name", path, "",
                          fmt::format("repeats the number {}", number), rename});
    else if (number != before + 1)
      findings.push_back(
          {Weight::Error, "sequence-gap", path, "",
           fmt::format("follows frame {}: {}", before,
                       target == CheckTarget::Blender ? "Blender drops all frames after a gap"
                                                      : "there is no file for the frames between"),
           "number the frames without gaps"});
  }
}

void compareFrames(const std::vector<std::string>& paths, const std::vector<FrameFacts>& facts,
                   std::vector<Finding>& findings) {
  for (std::size_t i = 1; i < paths.size(); ++i) {
    std::string differs;
    for (const auto& grid : facts.front().grids)
      if (facts[i].grids.count(grid) == 0)
        differs += (differs.empty() ? "lacks " : ", ") + grid.first + " (" + grid.second + ")";
    std::string more;
    for (const auto& grid : facts[i].grids)
      if (facts.front().grids.count(grid) == 0)
        more += (more.empty() ? "has " : ", ") + grid.first + " (" + grid.second + ")";
    if (!differs.empty() || !more.empty())
      findings.push_back({Weight::Error, "sequence-grids", paths[i], "",
                          "does not hold the grids of the first frame: it " + differs +
                              (differs.empty() || more.empty() ? "" : " and ") + more,
                          "make all frames in one run of tetvdb voxelize"});
    for (const auto& [name, transform] : facts[i].transforms) {
      const auto first = facts.front().transforms.find(name);
      if (first != facts.front().transforms.end() && !coincide(*first->second, *transform)) {
        findings.push_back(
            {Weight::Warning, "sequence-transform", paths[i], name,
             "has a different transform from that in the first frame: voxels flicker",
             "make all frames in one run of tetvdb voxelize"});
        break;
      }
    }
  }
}

// The values of a grid, and the size of the model, are those of all frames: an empty frame is not
// an error.
void checkContent(const std::vector<std::string>& paths, const CheckOptions& options,
                  const std::vector<FrameFacts>& facts, std::vector<Finding>& findings) {
  std::vector<std::vector<GridInfo>> infos;
  for (const FrameFacts& frame : facts)
    infos.push_back(frame.infos);
  std::vector<GridInfo> all;
  for (const SequenceGrid& grid : gridsOfSequence(infos)) {
    all.push_back(grid.all);
    const std::string& path = paths[grid.all.minValue < 0 ? grid.minFrame : grid.maxFrame];
    ContentCheck(path, options, findings)
        .checkValues(grid.all, fmt::format(" over {} frames", paths.size()));
    if (!grid.emptyFrames.empty() && grid.all.activeVoxels > 0)
      ContentCheck(paths[grid.emptyFrames.front()], options, findings)
          .add(Weight::Note, "no-voxels", grid.all.name,
               grid.emptyFrames.size() == 1
                   ? "has no active voxels in this frame"
                   : fmt::format("has no active voxels in this frame and {} others",
                                 grid.emptyFrames.size() - 1),
               "nothing, if the frame is to be empty");
  }
  ContentCheck(paths.front(), options, findings).checkExtent(all, facts.front().units);
}

} // namespace

std::vector<Finding> checkVolumes(const std::vector<std::string>& paths,
                                  const CheckOptions& options, Progress& progress) {
  std::vector<Finding> findings;
  std::vector<FrameFacts> facts;
  progress.stage("check");
  for (std::size_t i = 0; i < paths.size(); ++i) {
    FileCheck check(paths[i], paths.size() == 1, options, findings);
    if (canStreamVolume(paths[i])) {
      const StreamedInfo file = describeVolumeFile(paths[i], false, progress);
      facts.push_back(check.run(file.empty, file.grids));
    } else {
      const Volume volume = readVolume(paths[i], progress);
      facts.push_back(check.run(volume, describe(volume)));
    }
    progress.update(static_cast<double>(i + 1) / static_cast<double>(paths.size()));
  }
  if (paths.size() > 1) {
    checkNames(paths, options.target, findings);
    compareFrames(paths, facts, findings);
    checkContent(paths, options, facts, findings);
  }
  return findings;
}

} // namespace tetvdb
