// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/OpenSoup.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <atomic>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {

OpenSoup::OpenSoup(const TriangleClusters& fill, const Progress& progress) : band_(fill, progress) {
  // Of a node.
  struct Part {
    std::vector<nano::WindingLeaf> leaves;
    std::vector<Expansion> far;
    std::vector<std::uint32_t> near;
  };
  const std::vector<NodeIndex> nodes = band_.nodes();
  std::vector<Part> parts(nodes.size());
  std::atomic<std::uint64_t> count{0};
  tbb::parallel_for(std::size_t(0), nodes.size(), [&](std::size_t n) {
    Part& part = parts[n];
    const std::vector<WindingBand::Cube> cubes = band_.leavesOf(nodes[n]);
    if ((count += cubes.size()) > nano::kMaxWindingLeaves)
      throw Error(Status::Limit, "device", "the holes of the mesh take too many leaves for the GPU",
                  "use larger voxels or `device=cpu`");
    part.leaves.reserve(cubes.size());
    part.far.reserve(cubes.size());
    for (const WindingBand::Cube& cube : cubes) {
      nano::WindingLeaf leaf{};
      for (std::size_t k = 0; k < 3; ++k)
        leaf.first[k] = static_cast<std::int32_t>(cube.first[k]);
      leaf.clusters = static_cast<std::uint32_t>(cube.clusters.size());
      leaf.triangles = static_cast<std::uint32_t>(cube.triangles.size());
      leaf.near = part.near.size();
      part.near.insert(part.near.end(), cube.clusters.begin(), cube.clusters.end());
      part.near.insert(part.near.end(), cube.triangles.begin(), cube.triangles.end());
      part.leaves.push_back(leaf);
      part.far.push_back(cube.far);
    }
  });
  leaves_.reserve(count);
  far_.reserve(count);
  for (Part& part : parts) {
    for (nano::WindingLeaf& leaf : part.leaves) {
      leaf.near += near_.size();
      leaves_.push_back(leaf);
    }
    far_.insert(far_.end(), part.far.begin(), part.far.end());
    near_.insert(near_.end(), part.near.begin(), part.near.end());
    part = {};
  }
}

nano::HolesView OpenSoup::view() {
  const TriangleClusters& fill = band_.fill();
  nano::HolesView view;
  view.triangles = fill.triangles().data();
  view.areas = fill.areas().data();
  view.triangleCount = fill.triangleCount();
  view.clusters = fill.clusters().data();
  view.clusterCount = fill.clusters().size();
  view.leaves = leaves_.data();
  view.far = far_.data();
  view.leafCount = leaves_.size();
  view.near = near_.data();
  view.nearCount = near_.size();
  view.points = points_.data();
  view.tables = &expansionTables();
  view.tolerance = band_.tolerance();
  view.evaluator = this;
  return view;
}

WindingBand::Cube OpenSoup::cubeOf(std::size_t leaf) const {
  const nano::WindingLeaf& from = leaves_[leaf];
  WindingBand::Cube cube;
  WindingBand::place({from.first[0], from.first[1], from.first[2]}, kLeafSize, cube);
  cube.far = far_[leaf];
  cube.expanded = true; // or all zeros
  const std::uint32_t* near = near_.data() + from.near;
  cube.clusters.assign(near, near + from.clusters);
  cube.triangles.assign(near + from.clusters, near + from.clusters + from.triangles);
  return cube;
}

void OpenSoup::evaluate(const std::uint32_t* octants, std::uint64_t count, bool* needed,
                        double* values) {
  const WindingBand::Octants evaluator(band_);
  tbb::parallel_for(tbb::blocked_range<std::uint64_t>(0, count), [&](const auto& range) {
    WindingBand::Cube scratch;
    VoxelValues own;
    for (std::uint64_t i = range.begin(); i != range.end(); ++i) {
      needed[i] = evaluator.evaluate(cubeOf(octants[i] / 8), octants[i] % 8, scratch, own);
      if (needed[i])
        std::copy(own.begin(), own.end(), values + own.size() * i);
    }
  });
}

} // namespace tetvdb
