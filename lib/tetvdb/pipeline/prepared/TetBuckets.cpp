// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/prepared/TetBuckets.h"

#include "tetvdb/geometry/Lattice.h"
#include "tetvdb/mesh/SplitByShape.h"
#include "tetvdb/voxelize/TetNodes.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <variant>

namespace tetvdb {
namespace {

struct Counted {
  std::uint32_t slabs = 0, tets = 0;
};

// Corners of a range of tets on the lattice.
class SnappedRange {
public:
  SnappedRange(const SpooledMesh& mesh, const GridTransform& transform, std::size_t begin,
               std::size_t end, Progress& progress)
      : corners_(cornersOf(mesh, begin, end)), snapped_(snapMesh(corners_, transform, progress)) {}

  const SnappedMesh& mesh() const { return snapped_; }

private:
  TetMesh corners_;
  SnappedMesh snapped_;
};

// Elements that are copied before mapped pages may be given back.
constexpr std::size_t kGathered = std::size_t(1) << 14;

} // namespace

TetBuckets::TetBuckets(const SpooledMesh& mesh, const GridTransform& transform,
                       std::uint64_t mostTets, const std::string& folder, std::size_t bytes,
                       std::size_t maxResident, Progress& progress)
    : mesh_(mesh), transform_(transform), maxResident_(maxResident), progress_(progress),
      spool_(folder) {
  findNodes();
  findBoxes(mostTets);
  listTets(bytes);
}

// A tet that meets no voxel is of the node that its first corner lies in.
template <typename Visit>
void TetBuckets::eachNode(const SnappedMesh& mesh, std::size_t tet, const Visit& visit) const {
  constexpr int kBits = kLatticeBits + 7; // of a node of 128^3 voxels
  bool any = false;
  eachNodeOf(mesh, tet, [&](const NodeIndex& node, std::uint32_t slabs) {
    any = true;
    visit(node, slabs);
  });
  if (any || mesh_.arrays.empty())
    return;
  const LatticePoint& p = mesh.points[mesh.tets[4 * tet]];
  const auto along = [](double units) {
    return static_cast<std::int32_t>(static_cast<std::int64_t>(units) >> kBits);
  };
  visit(NodeIndex{along(p.x), along(p.y), along(p.z)}, 0);
}

void TetBuckets::findNodes() {
  std::map<NodeIndex, Counted> all;
  using Found = std::vector<std::pair<NodeIndex, Counted>>;
  eachTetRange(
      mesh_, maxResident_, progress_,
      [&](std::size_t begin, std::size_t end) {
        const SnappedRange range(mesh_, transform_, begin, end, progress_);
        std::map<NodeIndex, Counted> own;
        auto last = own.end();
        for (std::size_t t = 0; t < end - begin; ++t)
          eachNode(range.mesh(), t, [&](const NodeIndex& node, std::uint32_t slabs) {
            if (last == own.end() || last->first != node)
              last = own.try_emplace(node).first;
            last->second.slabs |= slabs;
            ++last->second.tets;
          });
        return Found(own.begin(), own.end());
      },
      [&](const Found& found) {
        for (const auto& [node, counted] : found) {
          Counted& sum = all[node];
          sum.slabs |= counted.slabs;
          sum.tets += counted.tets;
        }
      });
  nodes_.reserve(all.size());
  tetsOf_.reserve(all.size());
  for (const auto& [node, counted] : all) {
    nodes_.push_back({node, counted.slabs});
    tetsOf_.push_back(counted.tets);
  }
}

void TetBuckets::findBoxes(std::uint64_t mostTets) {
  std::set<Vec3i> cubes;
  for (const MetNode& met : nodes_)
    cubes.insert({met.node[0] >> 5, met.node[1] >> 5, met.node[2] >> 5});
  const auto nodeAt = [&](std::size_t i) { return nodes_[i].node; };
  boxOfNode_.resize(nodes_.size());
  for (const Vec3i& cube : cubes) {
    SplitBox whole;
    for (std::size_t k = 0; k < 3; ++k) {
      whole.box.low[k] = cube[k] * kNodesInCube;
      whole.box.high[k] = whole.box.low[k] + kNodesInCube;
    }
    const std::size_t first = boxes_.size();
    splitBox(
        whole, nodes_.size(), nodeAt,
        [&](std::size_t i) { return static_cast<double>(tetsOf_[i]); },
        static_cast<double>(mostTets), boxes_);
    for (std::size_t b = first; b < boxes_.size(); ++b)
      eachRangeIn(boxes_[b].box, nodes_.size(), nodeAt, [&](std::size_t begin, std::size_t end) {
        std::fill(boxOfNode_.begin() + static_cast<std::ptrdiff_t>(begin),
                  boxOfNode_.begin() + static_cast<std::ptrdiff_t>(end),
                  static_cast<std::uint32_t>(b));
      });
  }
}

std::size_t TetBuckets::findNode(const NodeIndex& node) const {
  return static_cast<std::size_t>(
      std::lower_bound(nodes_.begin(), nodes_.end(), node,
                       [](const MetNode& a, const NodeIndex& b) { return a.node < b; }) -
      nodes_.begin());
}

void TetBuckets::listTets(std::size_t bytes) {
  lists_.resize(boxes_.size());
  const std::size_t most = std::clamp<std::size_t>(
      bytes / sizeof(std::uint32_t) / std::max<std::size_t>(boxes_.size(), 1), 256, 1 << 16);
  using Found = std::vector<std::pair<std::uint32_t, std::uint32_t>>; // box, tet
  eachTetRange(
      mesh_, maxResident_, progress_,
      [&](std::size_t begin, std::size_t end) {
        const SnappedRange range(mesh_, transform_, begin, end, progress_);
        Found found;
        NodeIndex last{};
        std::uint32_t lastBox = 0;
        bool any = false;
        for (std::size_t t = 0; t < end - begin; ++t) {
          const std::size_t first = found.size();
          const auto tet = static_cast<std::uint32_t>(begin + t);
          eachNode(range.mesh(), t, [&](const NodeIndex& node, std::uint32_t) {
            if (!any || node != last)
              lastBox = boxOfNode_[findNode(node)];
            last = node;
            any = true;
            const bool known =
                std::any_of(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                            [&](const auto& one) { return one.first == lastBox; });
            if (!known)
              found.emplace_back(lastBox, tet);
          });
        }
        return found;
      },
      [&](const Found& found) {
        for (const auto& [box, tet] : found) {
          List& list = lists_[box];
          list.last.push_back(tet);
          ++list.count;
          if (list.last.size() >= most)
            flush(list);
        }
      });
  for (List& list : lists_) {
    flush(list);
    std::vector<std::uint32_t>().swap(list.last);
  }
  spool_.finish();
}

void TetBuckets::flush(List& list) {
  if (list.last.empty())
    return;
  list.pieces.emplace_back(spool_.count<std::uint32_t>(),
                           static_cast<std::uint32_t>(list.last.size()));
  spool_.append(list.last);
  list.last.clear();
}

// Copies `size` bytes of each of the elements that `places` names.
void TetBuckets::gather(const void* from, std::size_t size,
                        const std::vector<std::uint32_t>& places, void* to) const {
  auto* out = static_cast<char*>(to);
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::memcpy(out + i * size, static_cast<const char*>(from) + places[i] * size, size);
    if (i % kGathered == kGathered - 1)
      mesh_.releaseAbove(maxResident_);
  }
}

// The cells of the tets of `mesh`, whose corners are still the whole mesh's.
void TetBuckets::addShapes(const std::vector<std::uint32_t>& cells, TetMesh& mesh) const {
  CurvedCells& curved = mesh.curved;
  const auto* types = mesh_.types.as<CellType>();
  const auto* corners = mesh_.corners.as<std::uint32_t>();
  const auto* first = mesh_.firstCorners.as<std::uint64_t>();
  curved.cellOfTet.assign(cells.size(), CurvedCells::kLinear);
  curved.corners.resize(cells.size());
  for (std::size_t t = 0; t < cells.size();) {
    const std::uint32_t cell = cells[t];
    std::size_t end = t;
    while (end < cells.size() && cells[end] == cell)
      ++end;
    if (const auto shape = cornerShape(types[cell])) {
      const LinearCell nodes(*shape, types[cell], corners + first[cell]);
      const auto number = static_cast<std::uint32_t>(curved.cells.size());
      curved.cells.push_back({curved.nodes.size(), *shape});
      curved.nodes.insert(curved.nodes.end(), nodes.begin(), nodes.end());
      for (std::size_t i = t; i < end; ++i) {
        curved.cellOfTet[i] = number;
        curved.corners[i] = nodes.placesOf(mesh.tets.data() + 4 * i);
      }
    }
    if (t / kGathered != end / kGathered)
      mesh_.releaseAbove(maxResident_);
    t = end;
  }
}

BucketTets TetBuckets::tets(std::size_t box) const {
  BucketTets result;
  std::vector<std::uint32_t> listed;
  listed.reserve(static_cast<std::size_t>(lists_[box].count));
  for (const auto& [first, count] : lists_[box].pieces) {
    const std::uint32_t* from = spool_.as<std::uint32_t>() + first;
    listed.insert(listed.end(), from, from + count);
  }
  spool_.release();
  TetMesh& mesh = result.mesh;
  mesh.cellCount = listed.size();
  mesh.tets.resize(4 * listed.size());
  gather(mesh_.tets.as<char>(), 4 * sizeof(std::uint32_t), listed, mesh.tets.data());
  std::vector<std::uint32_t>& numbers = result.numbers;
  if (mesh_.cellOfTet.size() == 0) {
    numbers = std::move(listed);
  } else {
    numbers.resize(listed.size());
    gather(mesh_.cellOfTet.as<char>(), sizeof(std::uint32_t), listed, numbers.data());
    std::vector<std::uint32_t>().swap(listed);
  }
  if (mesh_.hasShapes())
    addShapes(numbers, mesh);
  std::vector<std::uint32_t> used = mesh.tets;
  used.insert(used.end(), mesh.curved.nodes.begin(), mesh.curved.nodes.end());
  tbb::parallel_sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::vector<std::uint32_t>* points : {&mesh.tets, &mesh.curved.nodes})
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, points->size(), 16384), [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            (*points)[i] = static_cast<std::uint32_t>(
                std::lower_bound(used.begin(), used.end(), (*points)[i]) - used.begin());
        });
  mesh.points.resize(used.size());
  gather(mesh_.points.as<char>(), sizeof(Vec3d), used, mesh.points.data());
  if (mesh_.regions.size() > 0) {
    mesh.regions.resize(numbers.size());
    gather(mesh_.regions.as<char>(), sizeof(std::int32_t), numbers, mesh.regions.data());
  }
  for (const SpooledArray& array : mesh_.arrays) {
    const auto& places = array.on == Attribute::On::Points ? used : numbers;
    Attribute& own = mesh.attributes.emplace_back(emptyAttribute(array));
    std::visit(
        [&](auto& values) {
          values.resize(places.size() * array.components);
          gather(array.values->as<char>(), array.bytesEach(), places, values.data());
        },
        own.values);
  }
  mesh_.releaseAbove(maxResident_);
  return result;
}

} // namespace tetvdb
