// SPDX-License-Identifier: Apache-2.0
//
// How two things differ, to look at: what `tetvdb compare -o` writes.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/visualize/Image.h"
#include "tetvdb/volume/Volume.h"

#include <string>

namespace tetvdb {

/// Captions.
struct ComparedNames {
  std::string a, b;
};

/// A, coloured by the distance of its points to B, and B, by that to A, on one scale with a legend.
/// Distances are taken at points and linear between. Throws Error(Invalid) for a mesh without
/// faces.
Image comparePicture(const TriangleMesh& a, const TriangleMesh& b, const ComparedNames& names,
                     Progress& progress);

/// A, B, and the voxels in which they differ: red where A alone is active, blue where B alone is;
/// of level sets, where A or B alone is inside. Where no state differs but values do, voxels by
/// the difference of their values, with a legend; nothing where nothing differs. Looks at the first
/// pair of grids that differ, else at the first pair. Throws Error(Invalid) where no grid of the
/// one has a partner in the other, or neither has an active voxel.
/// `comparison` is that of the two.
Image comparePicture(const Volume& a, const Volume& b, const VolumeComparison& comparison,
                     const ComparedNames& names, Progress& progress);

} // namespace tetvdb
