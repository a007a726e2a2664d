// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/DecideFaces.h"

#include "tetvdb/surface/DuplicateFaces.h"
#include "tetvdb/surface/EdgeTable.h"
#include "tetvdb/surface/FaceSides.h"
#include "tetvdb/surface/GroupWinding.h"
#include "tetvdb/surface/SolidField.h"
#include "tetvdb/surface/WindingField.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr std::size_t kMaxSamples = 2048, kMinSamples = 128;
constexpr std::size_t kMaxWork = 4000000;   ///< solid angles, for each field
constexpr std::size_t kMaxValues = 8000000; ///< samples times patches
// Fraction of the samples that are clearly inside.
constexpr double kLost = 0.01;
// A field is closer, or much closer, to that of a solid if its error is below this multiple.
constexpr double kNearer = 0.9, kMuchNearer = 0.5;
// If more than kDiffer of the input's solid is lost, and the field's error exceeds kVague, neither
// orientation is certain.
constexpr double kDiffer = 0.1, kVague = 0.06;

// The mesh without the faces that resolveDuplicates() removes, if any.
struct KeptFaces {
  TriangleMesh mesh;
  std::vector<std::uint32_t> was;        ///< by kept face
  std::vector<std::uint8_t> withoutSide; ///< by kept face; may be empty
};

KeptFaces keepFaces(const TriangleMesh& mesh, const std::vector<FaceFate>& fates) {
  KeptFaces kept;
  kept.mesh.points = mesh.points;
  for (std::uint32_t face = 0; face < mesh.triangleCount(); ++face) {
    if (fates[face] == FaceFate::Goes)
      continue;
    kept.was.push_back(face);
    const std::uint32_t* v = &mesh.triangles[3 * std::size_t(face)];
    kept.mesh.triangles.insert(kept.mesh.triangles.end(), v, v + 3);
    kept.withoutSide.push_back(fates[face] == FaceFate::StaysWithoutSide);
  }
  return kept;
}

bool isTwoSided(const EdgeTable& edges) {
  for (std::uint32_t edge = 0; edge < edges.edgeCount(); ++edge)
    if (edges.sides(edge).size() != 2)
      return false;
  return true;
}

class Decision {
public:
  Decision(const TriangleMesh& mesh, const CleanOptions& options, Progress& progress)
      : mesh_(mesh), progress_(progress), fileEdges_(mesh), keptMesh_(&mesh), edges_(&fileEdges_) {
    std::vector<FaceFate> fates;
    if (options.duplicates) {
      const DuplicateGroups groups = findDuplicates(fileEdges_);
      if (groups.count() > 0)
        fates = resolveDuplicates(mesh.triangles, mesh.points.size(), groups, progress);
    }
    if (std::find(fates.begin(), fates.end(), FaceFate::Goes) != fates.end()) {
      kept_ = keepFaces(mesh, fates);
      keptEdges_.emplace(kept_.mesh);
      keptMesh_ = &kept_.mesh;
      edges_ = &*keptEdges_;
    } else {
      kept_.was.resize(mesh.triangleCount());
      std::iota(kept_.was.begin(), kept_.was.end(), 0u);
      for (const FaceFate fate : fates)
        kept_.withoutSide.push_back(fate == FaceFate::StaysWithoutSide);
    }
    setDropped();
    if (options.orient)
      orient();
  }

  FaceDecision take() { return std::move(result_); }

private:
  bool dropsFaces() const { return kept_.was.size() < mesh_.triangleCount(); }

  void setDropped() {
    result_.dropped.clear();
    if (!dropsFaces())
      return;
    result_.dropped.assign(mesh_.triangleCount(), 1);
    for (const std::uint32_t face : kept_.was)
      result_.dropped[face] = 0;
  }

  void orient() {
    FaceSides sides(*keptMesh_, *edges_, progress_);
    const bool isPlain = !dropsFaces() && isTwoSided(*edges_);
    if (!isPlain && !dropsFaces()) {
      measureFile(sides.patches(), openEdgesOfFile());
      if (file_ && file_->field.isSolid())
        return keepFile(false);
      if (file_)
        sides.setScene(file_->scene);
    }
    sides.alignPatches(kept_.withoutSide);
    sides.alignByVisibility(progress_);
    sides.turnShells(progress_);
    turned_ = sides.turned();
    result_.turnedShells = sides.turnedShells();
    result_.insideOut = sides.insideOut();
    if (!isPlain)
      judge(sides);
    if (result_.turned.empty() && !keepsFile_) {
      result_.turned.assign(mesh_.triangleCount(), 0);
      for (std::size_t face = 0; face < turned_.size(); ++face)
        result_.turned[kept_.was[face]] = turned_[face];
    }
  }

  // The input's own winding numbers, and where.
  struct FileField {
    explicit FileField(const TriangleMesh& mesh) : scene(mesh) {}
    TriangleScene scene;
    std::size_t asked = 0; ///< samples
    WindingSamples samples;
    SolidField field;
  };

  std::size_t openEdgesOfFile() const {
    const std::vector<std::uint32_t> one(mesh_.triangleCount(), 0);
    return GroupWinding::openEdges(fileEdges_, one, std::vector<std::uint8_t>(one.size(), 0));
  }

  // Sets file_, to nothing where boundary edges are too many for a decision by the field.
  void measureFile(const FacePatches& patches, std::size_t openEdges) {
    std::size_t count = std::min(kMaxSamples, kMaxWork / std::max<std::size_t>(openEdges, 1));
    count = std::min(count, kMaxValues / std::max(patches.patchCount(), 1u));
    if (count < kMinSamples)
      return file_.reset();
    if (!file_)
      file_.emplace(mesh_);
    if (file_->asked == count)
      return;
    file_->asked = count;
    file_->samples = windingSamples(*keptMesh_, patches.patchOf, patches.patchCount(), count);
    file_->field = fileField(mesh_, fileEdges_, file_->scene, file_->samples, progress_);
  }

  // Of all faces, in the orientation of the file.
  static SolidField fileField(const TriangleMesh& mesh, const EdgeTable& edges,
                              const TriangleScene& scene, const WindingSamples& samples,
                              Progress& progress) {
    const WindingField winding(mesh, edges, scene);
    SolidField field;
    field.values.resize(samples.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, field.values.size(), 16),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        progress.check();
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          field.values[i] = static_cast<float>(winding.at(samples.points[i]));
                      });
    return field;
  }

  void keepFile(bool duplicatesToo) {
    keepsFile_ = true;
    result_.innerFaces = 0;
    setDropped();
    result_.turnedShells = 0;
    result_.insideOut = false;
    if (duplicatesToo)
      result_.dropped.clear();
  }

  // Accepts the decision, improves it, or returns to the orientation of the file.
  void judge(const FaceSides& sides) {
    const FacePatches& patches = sides.patches();
    const std::uint32_t patchCount = patches.patchCount();
    measureFile(patches, std::max(openEdgesOfFile(),
                                  GroupWinding::openEdges(*edges_, patches.patchOf, turned_)));
    if (!file_)
      return;
    const WindingSamples& samples = file_->samples;
    const SolidField& file = file_->field;
    if (file.isSolid() && !dropsFaces())
      return keepFile(false);

    std::optional<TriangleScene> keptScene;
    if (dropsFaces())
      keptScene.emplace(*keptMesh_);
    const TriangleScene& scene = keptScene ? *keptScene : file_->scene;
    const GroupWinding groups(*keptMesh_, *edges_, scene, patches.patchOf, patchCount, turned_,
                              samples.points, progress_);
    SolidField field = sumOf(groups, patchCount);
    dropInnerWalls(patches, groups, field);
    // Copies that cancel enclose nothing: volume gained by removing them is no objection.
    if (file.isSolid() &&
        2 * file.shareInside(samples.spread) > field.shareInside(samples.spread) &&
        (!field.isSolid() || isLost(file, field, samples)))
      return keepFile(isHarmedByDropping(file, scene, samples));
    if (!field.isSolid())
      turnPatches(sides, groups, field);
    const double lost = file.shareLostIn(field, samples.spread);
    if (field.error() > kNearer * file.error() && isLost(file, field, samples)) {
      keepFile(true);
      result_.doubtful = file.differenceFrom(field, samples.spread) > kDiffer;
    } else {
      // Volume by a field that is much farther from that of a solid is no evidence.
      result_.doubtful =
          lost > kDiffer && field.error() > kVague && field.error() > kMuchNearer * file.error();
    }
    if (result_.doubtful) {
      result_.fileVolume = samples.volume * file.shareInside(samples.spread);
      result_.turnedVolume = samples.volume * field.shareInside(samples.spread);
    }
  }

  static bool isLost(const SolidField& file, const SolidField& field,
                     const WindingSamples& samples) {
    return file.shareLostIn(field, samples.points.size()) > kLost;
  }

  // Whether removing duplicates, in the orientation of the file, loses volume.
  bool isHarmedByDropping(const SolidField& file, const TriangleScene& scene,
                          const WindingSamples& samples) const {
    const SolidField kept = fileField(*keptMesh_, *edges_, scene, samples, progress_);
    return isLost(file, kept, samples) || !kept.isSolid();
  }

  // Removes open patches that lie inside the solid of the others, on both sides.
  void dropInnerWalls(const FacePatches& patches, const GroupWinding& groups, SolidField& field) {
    const std::vector<std::uint8_t> inner = innerGroups(groups, patches.patchCount(), field);
    if (std::find(inner.begin(), inner.end(), 1) == inner.end())
      return;
    result_.dropped.resize(mesh_.triangleCount(), 0);
    for (std::size_t face = 0; face < turned_.size(); ++face)
      if (patches.patchOf[face] != EdgeTable::kNone && inner[patches.patchOf[face]]) {
        result_.dropped[kept_.was[face]] = 1;
        ++result_.innerFaces;
      }
  }

  void turnPatches(const FaceSides& sides, const GroupWinding& groups, SolidField& field) {
    const FacePatches& patches = sides.patches();
    const std::uint32_t patchCount = patches.patchCount();
    std::vector<double> area(patchCount, 0);
    for (std::uint32_t face = 0; face < turned_.size(); ++face)
      if (patches.patchOf[face] != EdgeTable::kNone)
        area[patches.patchOf[face]] += sides.area(face);
    // Shells of several patches, then single patches; the largest first.
    std::vector<std::vector<std::uint32_t>> shells(sides.shellCount()), sets;
    for (std::uint32_t patch = 0; patch < patchCount; ++patch)
      shells[sides.shellOfPatch(patch)].push_back(patch);
    for (auto& shell : shells)
      if (shell.size() > 1)
        sets.push_back(std::move(shell));
    std::vector<std::uint32_t> order(patchCount);
    for (std::uint32_t patch = 0; patch < patchCount; ++patch)
      order[patch] = patch;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return area[a] > area[b]; });
    for (const std::uint32_t patch : order)
      sets.push_back({patch});
    SolidField better = field;
    const std::vector<std::uint8_t> turn =
        turnTowardsSolid(groups, patchCount, sets, better, progress_);
    // Reversal must improve the field more than it loses volume.
    if (better.error() > kNearer * field.error() ||
        (field.shareInsideLostIn(better) > kDiffer && better.error() > kMuchNearer * field.error()))
      return;
    field = std::move(better);
    for (std::uint32_t face = 0; face < turned_.size(); ++face)
      if (patches.patchOf[face] != EdgeTable::kNone)
        turned_[face] ^= turn[patches.patchOf[face]];
  }

  const TriangleMesh& mesh_;
  Progress& progress_;
  EdgeTable fileEdges_;
  KeptFaces kept_;
  std::optional<EdgeTable> keptEdges_;
  const TriangleMesh* keptMesh_;     ///< kept_.mesh, or mesh_ if every face is kept
  const EdgeTable* edges_;           ///< of *keptMesh_
  std::vector<std::uint8_t> turned_; ///< by kept face
  std::optional<FileField> file_;
  bool keepsFile_ = false;
  FaceDecision result_;
};

} // namespace

FaceDecision decideFaces(const TriangleMesh& mesh, const CleanOptions& options,
                         Progress& progress) {
  return Decision(mesh, options, progress).take();
}

} // namespace tetvdb
