// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/TwoSidedCheck.h"

#include "tetvdb/core/AtomicBounds.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/mesh/MeshMeasures.h"
#include "tetvdb/surface/TriangleScene.h"
#include "tetvdb/tetrahedralize/inside/ChainWinding.h"
#include "tetvdb/tetrahedralize/inside/RegionSurface.h"
#include "tetvdb/tetrahedralize/inside/Regions.h"
#include "tetvdb/tetrahedralize/soup/SurfaceSamples.h"
#include "tetvdb/tetrahedralize/soup/WorkingLattice.h"
#include "tetvdb/voxelize/SoupBoundary.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kSamples = 100000; // of one surface, or half as many and all centroids
constexpr double kMaxCentroids = 50000;
constexpr double kMaxCorners = 50000; // of the inputs: corners are lost first
constexpr std::size_t kPointsInBox = 65536;
constexpr double kSamplesPerSquare = 4; // of side epsilon
constexpr double kMinSamples = 1000;
// A boundary with as many edges halves the number of samples; more than that many times fewer is
// never asked for.
constexpr double kBoundaryEdges = 1000, kMaxFewer = 4;
// Where winding numbers are this near to whole numbers, the tets' surface has to be near the input.
constexpr double kWhole = 0.2;
// A winding number this far from 0.5 is clearly inside or outside.
constexpr double kClear = 0.2;
// Sides of a triangle are sampled at this share of epsilon from its edges, where other
// faces begin: next to a box's corner one of them would lie on the next face.
constexpr double kFromEdge = 1.0 / 64;
// Distances are compared with epsilon up to rounding.
constexpr double kRounding = 1e-9;

using Points = std::vector<Vec3d>;

class InputWindings {
public:
  InputWindings(const std::vector<TriangleMesh>& inputs, const WorkingLattice& lattice,
                Progress& progress);

  struct Place {
    std::uint16_t mask = 0; ///< bit k: within input k
    bool clear = true;      ///< no winding number is near 0.5
  };
  std::vector<Place> placesOf(const PointGroups& points, Progress& progress) const;
  /// Leaves those samples at which every input's winding number is near a whole number.
  void keepWhole(std::vector<SurfaceSample>& samples, Progress& progress) const;
  PointGroups groupsOf(const Points& points) const;
  bool isAnyOpen() const {
    return std::find(isOpen_.begin(), isOpen_.end(), true) != isOpen_.end();
  }
  double fewer() const { return fewer_; } ///< the factor by which the number of samples is divided

private:
  const WorkingLattice& lattice_;
  std::vector<std::unique_ptr<ChainWinding>> windings_;
  std::vector<bool> isOpen_;
  double fewer_ = 1;
};

LatticePoint latticePoint(const WorkingLattice& lattice, const Vec3d& world) {
  const Vec3d p = lattice.toLattice(world);
  return {p[0], p[1], p[2]};
}

std::vector<ChainWinding::Face> facesOf(const TriangleMesh& mesh, std::size_t count,
                                        const WorkingLattice& lattice) {
  std::vector<ChainWinding::Face> faces(count);
  const auto at = [&](std::size_t corner) {
    return latticePoint(lattice, mesh.points[mesh.triangles[corner]]);
  };
  forEachIndex(count, [&](std::size_t i) {
    faces[i] = {at(3 * i), at(3 * i + 1), at(3 * i + 2), 1};
  });
  return faces;
}

InputWindings::InputWindings(const std::vector<TriangleMesh>& inputs, const WorkingLattice& lattice,
                             Progress& progress)
    : lattice_(lattice) {
  for (const TriangleMesh& mesh : inputs) {
    std::vector<BoundaryEdge> boundary;
    for (const IndexedBoundaryEdge& edge : soupBoundary(mesh, progress).edges)
      boundary.push_back({latticePoint(lattice, mesh.points[edge.a]),
                          latticePoint(lattice, mesh.points[edge.b]), edge.weight});
    isOpen_.push_back(!boundary.empty());
    fewer_ += static_cast<double>(boundary.size()) / kBoundaryEdges;
    windings_.push_back(std::make_unique<ChainWinding>(facesOf(mesh, mesh.triangleCount(), lattice),
                                                       std::move(boundary)));
    progress.check();
  }
  fewer_ = std::min(fewer_, kMaxFewer);
}

PointGroups InputWindings::groupsOf(const Points& points) const {
  std::vector<LatticePoint> places(points.size());
  forEachIndex(points.size(),
               [&](std::size_t i) { places[i] = latticePoint(lattice_, points[i]); });
  return PointGroups(places, isAnyOpen() ? PointGroups::Shape::Cubes : PointGroups::Shape::Columns);
}

std::vector<InputWindings::Place> InputWindings::placesOf(const PointGroups& points,
                                                          Progress& progress) const {
  std::vector<Place> places(points.pointCount());
  for (std::size_t input = 0; input < windings_.size(); ++input) {
    const std::vector<double> winding = windings_[input]->at(points, progress);
    for (std::size_t i = 0; i < winding.size(); ++i) {
      if (winding[i] > 0.5)
        places[i].mask = static_cast<std::uint16_t>(places[i].mask | 1u << input);
      if (isOpen_[input] && std::abs(winding[i] - 0.5) < kClear)
        places[i].clear = false;
    }
  }
  return places;
}

void InputWindings::keepWhole(std::vector<SurfaceSample>& samples, Progress& progress) const {
  if (!isAnyOpen())
    return;
  Points points;
  for (const SurfaceSample& sample : samples)
    points.push_back(sample.at);
  const PointGroups groups = groupsOf(points);
  std::vector<bool> whole(points.size(), true);
  for (std::size_t input = 0; input < windings_.size(); ++input) {
    if (!isOpen_[input])
      continue;
    const std::vector<double> winding = windings_[input]->at(groups, progress);
    for (std::size_t i = 0; i < winding.size(); ++i)
      if (std::abs(winding[i] - std::nearbyint(winding[i])) > kWhole)
        whole[i] = false;
  }
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (whole[i])
      samples[count++] = samples[i];
  samples.resize(count);
}

// All inputs' triangles, and which input each range of them comes from.
struct JoinedInputs {
  TriangleMesh mesh;
  std::vector<std::size_t> begins; ///< first triangle of each input
};

JoinedInputs joinInputs(const std::vector<TriangleMesh>& inputs) {
  JoinedInputs all;
  for (const TriangleMesh& input : inputs) {
    const auto first = static_cast<std::uint32_t>(all.mesh.points.size());
    all.begins.push_back(all.mesh.triangleCount());
    all.mesh.points.insert(all.mesh.points.end(), input.points.begin(), input.points.end());
    for (const std::uint32_t corner : input.triangles)
      all.mesh.triangles.push_back(first + corner);
  }
  return all;
}

std::vector<SurfaceSample> samplesOf(const TriangleMesh& mesh, double epsilon, double fewer) {
  const double enough = kSamplesPerSquare * areaOf(mesh) / (epsilon * epsilon);
  const bool centroids = static_cast<double>(mesh.triangleCount()) * fewer <= kMaxCentroids;
  double count = (centroids ? kSamples / 2 : kSamples) / fewer;
  if (enough < count)
    count = std::max(enough, kMinSamples);
  return sampleSurface(mesh, static_cast<std::size_t>(count), centroids);
}

// Corners of triangles, each with the largest one that has it.
void addCorners(const TriangleMesh& mesh, double fewer, std::vector<SurfaceSample>& samples) {
  std::vector<double> largest(mesh.points.size(), 0);
  std::vector<std::uint32_t> triangleOf(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::size_t t = i / 3;
    const Vec3d& a = mesh.points[mesh.triangles[3 * t]];
    const Vec3d normal = cross(minus(mesh.points[mesh.triangles[3 * t + 1]], a),
                               minus(mesh.points[mesh.triangles[3 * t + 2]], a));
    const std::uint32_t corner = mesh.triangles[i];
    if (dot(normal, normal) > largest[corner]) {
      largest[corner] = dot(normal, normal);
      triangleOf[corner] = static_cast<std::uint32_t>(t);
    }
  }
  std::vector<std::uint32_t> corners;
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
    if (largest[p] > 0)
      corners.push_back(p);
  const std::size_t count = std::min(corners.size(), static_cast<std::size_t>(kMaxCorners / fewer));
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t corner = corners[i * corners.size() / count];
    samples.push_back({mesh.points[corner], triangleOf[corner]});
  }
}

struct Farthest {
  double distance = 0;             ///< of the farthest sample
  std::vector<std::uint8_t> isFar; ///< which samples are farther than the limit
};

// Most samples are only shown to be nearer than another one and than the limit, which takes a
// fraction of the time of finding their distance.
Farthest farthest(const TriangleScene& scene, const std::vector<SurfaceSample>& samples,
                  double limit, Progress& progress) {
  Farthest found{0, std::vector<std::uint8_t>(samples.size(), 0)};
  std::atomic<double> largest{0};
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, samples.size(), 256),
                    [&](const auto& range) {
                      progress.check();
                      std::uint32_t near = 0;
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        const double known = largest.load(std::memory_order_relaxed);
                        if (scene.isWithin(samples[i].at, std::min(known, limit), &near))
                          continue;
                        const double distance = scene.closest(samples[i].at).distance;
                        found.isFar[i] = distance > limit;
                        raiseTo(largest, distance);
                      }
                    });
  found.distance = largest;
  return found;
}

// Samples of the input whose sides half an epsilon off clearly belong to different regions.
std::vector<SurfaceSample> owedOf(const TriangleMesh& mesh, std::vector<SurfaceSample> samples,
                                  const InputWindings& windings, std::size_t inputCount,
                                  Boolean boolean, double epsilon, Progress& progress) {
  Points sides(2 * samples.size());
  forEachIndex(samples.size(), [&](std::size_t i) {
    const SurfaceSample& sample = samples[i];
    const std::uint32_t* corners = mesh.triangles.data() + std::size_t(3) * sample.triangle;
    const Vec3d &a = mesh.points[corners[0]], &b = mesh.points[corners[1]],
                &c = mesh.points[corners[2]];
    const Vec3d normal = cross(minus(b, a), minus(c, a));
    const Vec3d off = times(normal, epsilon / 2 / length(normal));
    const Vec3d inward = minus(times(plus(plus(a, b), c), 1.0 / 3), sample.at);
    const double share = kFromEdge * epsilon / std::max(length(inward), kFromEdge * epsilon);
    const Vec3d from = plus(sample.at, times(inward, share));
    sides[2 * i] = plus(from, off);
    sides[2 * i + 1] = minus(from, off);
  });
  const std::vector<InputWindings::Place> places =
      windings.placesOf(windings.groupsOf(sides), progress);
  std::size_t count = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const InputWindings::Place &above = places[2 * i], &below = places[2 * i + 1];
    if (above.clear && below.clear &&
        regionOf(above.mask, inputCount, boolean) != regionOf(below.mask, inputCount, boolean))
      samples[count++] = samples[i];
  }
  samples.resize(count);
  return samples;
}

} // namespace

struct InputSurface::Impl {
  const std::vector<TriangleMesh>& inputs;
  const Boolean boolean;
  const double epsilon;
  const JoinedInputs joined;
  const WorkingLattice lattice;
  const InputWindings windings;
  std::vector<SurfaceSample> owed;

  Impl(const std::vector<TriangleMesh>& meshes, Boolean rule, double distance, Progress& progress)
      : inputs(meshes), boolean(rule), epsilon(distance), joined(joinInputs(meshes)),
        lattice(boxOf(joined.mesh.points, joined.mesh.triangles)),
        windings(meshes, lattice, progress) {
    std::vector<SurfaceSample> samples = samplesOf(joined.mesh, epsilon, windings.fewer());
    addCorners(joined.mesh, windings.fewer(), samples);
    owed = owedOf(joined.mesh, std::move(samples), windings, inputs.size(), boolean, epsilon,
                  progress);
  }

  void compareVolumes(const RegionSurface& surface, Progress& progress, Comparison& found) const;
};

void InputSurface::Impl::compareVolumes(const RegionSurface& surface, Progress& progress,
                                        Comparison& found) const {
  Box box = boxOf(joined.mesh.points, joined.mesh.triangles);
  box.add(boxOf(surface.mesh.points, surface.mesh.triangles));
  Points points(kPointsInBox);
  forEachIndex(kPointsInBox, [&](std::size_t i) { points[i] = pointInBox(box, i); });
  const PointGroups groups = windings.groupsOf(points);
  const std::vector<InputWindings::Place> places = windings.placesOf(groups, progress);
  const ChainWinding tets(facesOf(surface.mesh, surface.outerFaces, lattice), {});
  const std::vector<double> covered = tets.at(groups, progress);
  double more = 0, differ = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool byInputs = regionOf(places[i].mask, inputs.size(), boolean) != kOutsideRegion;
    const bool byTets = covered[i] > 0.5;
    more += (byInputs ? 1 : 0) - (byTets ? 1 : 0);
    differ += byInputs != byTets ? 1 : 0;
  }
  double whole = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
    whole *= box.high[axis] - box.low[axis];
  const double n = static_cast<double>(kPointsInBox);
  found.volume = surface.volume;
  found.windingVolume = surface.volume + whole * more / n;
  found.volumeError = whole * std::sqrt(differ) / n;
}

InputSurface::InputSurface(const std::vector<TriangleMesh>& inputs, Boolean boolean, double epsilon,
                           Progress& progress)
    : impl_(std::make_unique<const Impl>(inputs, boolean, epsilon, progress)) {}

InputSurface::~InputSurface() = default;

std::size_t InputSurface::owedPoints() const {
  return impl_->owed.size();
}

LostSurface InputSurface::lost(const TetMesh& mesh, Progress& progress) const {
  const RegionSurface surface = regionSurface(mesh, progress);
  const std::vector<SurfaceSample>& owed = impl_->owed;
  const std::vector<std::size_t>& begins = impl_->joined.begins;
  const Farthest far =
      farthest(TriangleScene(surface.mesh), owed, impl_->epsilon * (1 + kRounding), progress);
  LostSurface found;
  found.inToOut = far.distance;
  found.boundaryFaces = surface.outerFaces;
  for (std::size_t i = 0; i < owed.size(); ++i) {
    if (!far.isFar[i])
      continue;
    const auto number = static_cast<std::size_t>(
        std::upper_bound(begins.begin(), begins.end(), owed[i].triangle) - begins.begin() - 1);
    found.points.push_back({owed[i].at, static_cast<std::uint32_t>(number),
                            static_cast<std::uint32_t>(owed[i].triangle - begins[number])});
  }
  return found;
}

InputSurface::Comparison InputSurface::compare(const TetMesh& mesh, Progress& progress) const {
  const RegionSurface surface = regionSurface(mesh, progress);
  std::vector<SurfaceSample> samples =
      samplesOf(surface.mesh, impl_->epsilon, impl_->windings.fewer());
  impl_->windings.keepWhole(samples, progress);
  Comparison found;
  found.outToIn = farthest(TriangleScene(impl_->joined.mesh), samples,
                           std::numeric_limits<double>::infinity(), progress)
                      .distance;
  impl_->compareVolumes(surface, progress, found);
  return found;
}

InputSurfaceTask::InputSurfaceTask(const std::vector<TriangleMesh>& inputs, Boolean boolean,
                                   double epsilon, Progress& progress)
    : inputs_(inputs), boolean_(boolean), epsilon_(epsilon), progress_(progress) {}

InputSurfaceTask::~InputSurfaceTask() {
  try {
    group_.wait();
  } catch (...) { // NOLINT(bugprone-empty-catch): whoever did not call get() does not need it
  }
}

void InputSurfaceTask::begin() {
  if (std::exchange(hasBegun_, true))
    return;
  group_.run([this] {
    made_ = std::make_unique<const InputSurface>(inputs_, boolean_, epsilon_, progress_);
  });
}

const InputSurface& InputSurfaceTask::get() {
  begin();
  group_.wait();
  if (!made_) // this runs in a loop of TBB that another iteration has ended
    throw Error(Status::Cancelled, "", "cancelled", "nothing was written");
  return *made_;
}

} // namespace tetvdb
