// SPDX-License-Identifier: Apache-2.0
//
// The options by which the models of a data set are processed.
#pragma once

#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/DeviceChoice.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

/// The length that becomes 1 when a model is normalised; the centre of its box becomes 0.
enum class NormalLength : std::uint8_t {
  None,     ///< coordinates stay; the grid is the cube around the model
  Longest,  ///< the longest side of the box
  Diagonal, ///< the diagonal of the box
  Sphere    ///< twice the largest distance of a vertex from the centre of the box
};

/// The arrays that are made of a model.
struct DatasetContent {
  bool occupancy = true;    ///< voxels whose centre is inside
  bool distance = false;    ///< signed distances at voxel centres
  bool surface = false;     ///< voxels through whose cube a face passes
  bool coordinates = false; ///< numbers of the voxels that are occupied, and of the surface's
  bool points = false;      ///< query points with occupancy and signed distance
  bool samples = false;     ///< points of the surface with normals
};

/// The files that hold them.
enum class DatasetFormat : std::uint8_t {
  Npz,               ///< ID.npz: everything
  Npy,               ///< ID.ARRAY.npy: an array a file
  Binvox,            ///< ID_N.binvox: occupancy
  Vdb,               ///< ID_N.vdb: grids mask, surface and shell
  Nvdb,              ///< ID_N.nvdb: the same
  Hdf5,              ///< ID.h5: everything; joined, a group a model in each archive
  Zarr,              ///< ID.zarr: everything; joined, the folder is one group
  OccupancyNetworks, ///< ID/points.npz, ID/pointcloud.npz
  DeepSdf            ///< ID.sdf.npz: pos, neg
};

struct DatasetOptions {
  std::vector<int> resolutions{64}; ///< voxels along each side of the cube
  NormalLength normalize = NormalLength::Longest;
  /// Free space around the model, as a share of its length, both sides together: the cube of the
  /// grid has the side 1 + padding. DeepSDF's is 0.03, Occupancy Networks' 0.1.
  double padding = 0.1;
  bool yUp = false; ///< models' y becomes z, -z becomes y
  DatasetContent content;
  std::vector<DatasetFormat> formats{DatasetFormat::Npz};
  bool packBits = true;               ///< of booleans in .npz and .npy, as numpy.packbits()
  double bandVoxels = 3;              ///< of distances; infinity: in the whole cube
  std::size_t uniformPoints = 100000; ///< query points, uniform in the cube
  std::size_t nearPoints = 0;         ///< near the surface
  double nearDistance = 0.01;         ///< standard deviation from it, lengths as normalised
  std::size_t sharpPoints = 0;        ///< as near as these to edges of more than 30 degrees
  std::size_t samples = 100000;       ///< on the surface
  bool halfFloats = false;            ///< points and distances of them as 16-bit floats
  int variants = 0;                   ///< further versions of every model, turned, scaled and moved
  bool turnAny = false;   ///< variants are turned about any axis; false: about the vertical
  double scaleJitter = 0; ///< scaled by 1 - this to 1
  double moveJitter = 0;  ///< moved by up to this along each axis, lengths as normalised
  /// Variants' surface is that of tets within epsilon of the model (tetrahedralize()): a share of
  /// the diagonal, chosen at random in this range by its logarithm; 0: the model's own surface.
  double epsilonLow = 0, epsilonHigh = 0;
  std::uint64_t seed = 0;
  CleanOptions clean;
  /// Where closed models become voxels and distances near the surface are found; the data are the
  /// same. What the GPU cannot do the CPU does, with the warning "device-unused".
  DeviceChoice device{DeviceKind::Cpu, {0}};
  std::size_t maxMemory = 0; ///< bytes for one model; 0: what the machine has available
};

} // namespace tetvdb
