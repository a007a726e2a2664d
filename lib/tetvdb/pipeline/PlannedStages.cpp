// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/PlannedStages.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/ChooseMesher.h"
#include "tetvdb/pipeline/ReadInput.h"

#include <algorithm>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kPreviewShare = 15;

class Plan {
public:
  explicit Plan(bool preview) : preview_(preview) {}

  Plan& add(const char* name, double share) {
    stages_.push_back({name, share});
    return *this;
  }
  // A stage that may come in place of all that follow.
  void addLast(const char* name) { stages_.push_back({name, 1, true}); }
  void preview() {
    if (preview_)
      add("preview", kPreviewShare);
  }
  void tetrahedralize() {
    add("tetrahedralize", 1).add("snap", 1).add("envelope", 1).add("simplify", 10);
    add("background", 3).add("insert", 40).add("improve", 12).add("classify", 15).add("check", 20);
    preview();
  }
  std::vector<PlannedStage> take() { return std::move(stages_); }

private:
  bool preview_;
  std::vector<PlannedStage> stages_;
};

} // namespace

std::vector<PlannedStage> plannedStages(const VoxelizeJob& job) {
  if (job.inputs.empty())
    return {};
  bool triangles = false;
  try {
    triangles = holdsTriangles(job.inputs.front(), job.memory);
  } catch (const Error&) { // the job reports it
    return {};
  }
  const bool tets = job.mesher == Mesher::Envelope || needsTets(job) || job.epsilon.value > 0;
  Plan plan(!job.preview.empty());
  plan.add("read", triangles ? 2 : 25);
  plan.preview();
  if (triangles)
    plan.add("clean", 5);
  if (triangles && tets)
    plan.tetrahedralize();
  if (job.makesVolume()) {
    plan.add("voxelize", 45);
    plan.addLast(kStreamStage);
    if (!madeBy(job.grids, {GridMaker::Distance, GridMaker::Share}).empty() || !job.fields.empty())
      plan.add("fields", triangles ? 40 : 150);
    plan.preview();
  }
  plan.add("write", triangles ? 8 : 30);
  return plan.take();
}

std::vector<PlannedStage> plannedStages(const TetrahedralizeJob& job) {
  Plan plan(!job.preview.empty());
  plan.add("read", 1);
  plan.preview();
  plan.add("clean", 1);
  plan.tetrahedralize();
  plan.add("write", 2);
  return plan.take();
}

std::vector<PlannedStage> plannedStages(const RenderJob& job) {
  const auto pictures = static_cast<double>(std::max<std::size_t>(job.turntable, 1));
  return {{"read", 2}, {"scene", 3}, {"render", 6 * pictures}, {"write", 0.1}};
}

std::vector<PlannedStage> plannedStages(const SliceJob& job) {
  if (job.isVolume)
    return {{"read", 2}, {"extract", 10}, {"cut", 1}, {"layers", 20}};
  return {{"read", 2}, {"clean", 5}, {"cut", 1}, {"layers", 20}};
}

std::vector<PlannedStage> plannedStages(const CheckPrintJob& job) {
  std::vector<PlannedStage> stages = {{"read", 2}, {"clean", 5}, {"cut", 1}, {"check", 20}};
  if (job.slice.isVolume)
    stages[1] = {"extract", 10};
  if (!job.picture.empty())
    stages.push_back({"picture", 3});
  return stages;
}

std::vector<PlannedStage> plannedSequence() {
  return {{"first pass", 1}, {"frames", 6}}; // both read; the second also makes volumes
}

} // namespace tetvdb
