// SPDX-License-Identifier: Apache-2.0
//
// Compares the tets with the input, in both directions.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <tbb/task_group.h>
#include <vector>

namespace tetvdb {

/// What InputSurface::lost() finds.
struct LostSurface {
  double inToOut = 0;            ///< largest distance of owed points from the tets' surface, world
  std::size_t boundaryFaces = 0; ///< of the tets, with the outside
  /// Owed input points that are farther than epsilon from the tets' surface, world, with the
  /// triangle (input, number) each lies on.
  struct Point {
    Vec3d at;
    std::uint32_t input, triangle;
  };
  std::vector<Point> points;
};

/// Samples the inputs, with their corners, and the surface of tets (faces of one tet, or between
/// two regions; tets of region -1 are none). The inputs are sampled once for any number of meshes.
///   A point of an input is owed where its two sides, half an epsilon off the triangle, belong to
/// different regions by the winding numbers of the inputs (regionOf()): interior walls, sheets,
/// doubled shells and walls thinner than half an epsilon are not owed. Nor are points where the
/// winding number of an open input is within 0.2 of 0.5 on either side, as it is next to a hole
/// boundary: the surface that closes the hole begins near there, not at the boundary itself. An
/// owed point farther than epsilon from the tets' surface is lost.
///   outToIn is the largest distance of samples of the tets' surface at which all winding numbers
/// are within 0.2 of whole numbers, that is of all of them where the inputs are closed. Elsewhere
/// the tets' surface closes a hole, and is far from the input by design.
///   windingVolume is the tets' volume, corrected by the winding number at points spread evenly
/// over the box. volumeError is a standard error, that of random points.
///   Inputs are cleaned, not without triangles, and outlive this; meshes lie no farther outside
/// their box than half its longest side. Parallel, deterministic; at most about 100 000 samples of
/// each surface and 50 000 of the inputs' corners, fewer where inputs have many boundary edges
/// (their winding numbers are slow), and 65 536 points in space: a tenth of a second to find what
/// is owed, as much for compare() and less for lost(); with many boundary edges a second or two.
class InputSurface {
public:
  InputSurface(const std::vector<TriangleMesh>& inputs, Boolean boolean, double epsilon,
               Progress& progress);
  ~InputSurface();
  InputSurface(const InputSurface&) = delete;
  InputSurface& operator=(const InputSurface&) = delete;

  std::size_t owedPoints() const;
  LostSurface lost(const TetMesh& mesh, Progress& progress) const;

  /// What lost() does not find.
  struct Comparison {
    double outToIn = 0, volume = 0, windingVolume = 0; ///< as in TwoSidedCheck
    /// Of windingVolume, world units cubed; the tets' own volume is exact.
    double volumeError = 0;
  };
  Comparison compare(const TetMesh& mesh, Progress& progress) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// An InputSurface that can be made beside other work: much of meshing is serial, and what is owed
/// does not depend on the mesh. Arguments are InputSurface's and outlive this. begin() and get()
/// are called by one thread, which holds no lock meanwhile: it may run a part of the work whenever
/// it waits for other threads. Where there is one thread the work is done in get().
class InputSurfaceTask {
public:
  InputSurfaceTask(const std::vector<TriangleMesh>& inputs, Boolean boolean, double epsilon,
                   Progress& progress);
  ~InputSurfaceTask(); ///< waits
  InputSurfaceTask(const InputSurfaceTask&) = delete;
  InputSurfaceTask& operator=(const InputSurfaceTask&) = delete;

  void begin();              ///< returns at once; does nothing where it has begun
  const InputSurface& get(); ///< begins and waits; throws what making it throws

private:
  const std::vector<TriangleMesh>& inputs_;
  const Boolean boolean_;
  const double epsilon_;
  Progress& progress_;
  std::unique_ptr<const InputSurface> made_;
  bool hasBegun_ = false;
  tbb::task_group group_;
};

} // namespace tetvdb
