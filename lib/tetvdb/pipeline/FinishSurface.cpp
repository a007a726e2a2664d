// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/FinishSurface.h"

#include "tetvdb/geometry/BoxTree.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/SimplifySurface.h"

#include <fmt/format.h>

namespace tetvdb {
namespace {

constexpr double kFeatureDegrees = 40;

double diagonalOf(const TriangleMesh& mesh) {
  Box box;
  for (const Vec3d& p : mesh.points)
    box.add(p);
  return length(minus(box.high, box.low));
}

void smooth(TriangleMesh& mesh, double distance, FinishResult& result, Report& report,
            Progress& progress) {
  StageTimer timer(report, "smooth");
  progress.stage("smooth");
  SmoothOptions options;
  options.distance = distance;
  result.smoothed = smoothSurface(mesh, options, progress);
}

void simplify(TriangleMesh& mesh, std::size_t faces, double tolerance, FinishResult& result,
              Report& report, Progress& progress) {
  StageTimer timer(report, "simplify");
  progress.stage("simplify");
  SimplifyOptions options;
  options.faces = faces;
  options.tolerance = tolerance;
  options.featureDegrees = kFeatureDegrees;
  result.simplified = true;
  result.facesBefore = mesh.triangleCount();
  simplifySurface(mesh, options, progress);
  if (faces > 0 && mesh.triangleCount() > faces) {
    report.warn("faces-not-reached",
                fmt::format("{} faces remain, more than the {} requested: fewer would {}",
                            mesh.triangleCount(), faces,
                            tolerance > 0 ? "exceed the permitted error, cross or not be a manifold"
                                          : "cross or not be a manifold"));
    report.partial = true;
  }
}

} // namespace

FinishResult finishSurface(TriangleMesh& mesh, const FinishOptions& options, Report& report,
                           Progress& progress) {
  FinishResult result;
  if (!options.isAsked())
    return result;
  const TriangleMesh before = mesh;
  const double diagonal = diagonalOf(mesh);
  if (options.smooth.value > 0)
    smooth(mesh, options.smooth.inWorld(diagonal, 0), result, report, progress);
  if (options.faces > 0 || options.error.value > 0)
    simplify(mesh, options.faces, options.error.inWorld(diagonal, 0), result, report, progress);
  result.distance = compareMeshes(before, mesh, {}, progress).hausdorff;
  return result;
}

} // namespace tetvdb
