// SPDX-License-Identifier: Apache-2.0
//
// A level set of a closed mesh, or its fog, as a NanoVDB buffer, on any backend: a mask of what is
// inside -> faces near 128^3 nodes -> distances, leaf by leaf -> leaves with signs -> the nodes
// above them. As fields/LevelSet.h and FogVolume.h on the CPU.
#pragma once

#include "LevelSetJob.h"
#include "LevelSetLeaves.h"
#include "Pipeline.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace tetvdb::nano {

/// The job that makes the mask.
inline Job maskJobOf(const LevelSetJob& job) {
  Job mask;
  mask.type = GridType::Mask;
  mask.rule = job.rule;
  mask.resident = job.resident;
  for (int k = 0; k < 3; ++k) {
    mask.voxelSize[k] = job.voxelSize;
    mask.origin[k] = job.origin[k];
  }
  mask.name = job.name;
  return mask;
}

template <typename Backend>
class LevelSetGrid {
public:
  /// `mesh` and the faces of `job` lie where the backend computes; `maskJob`: maskJobOf(job).
  LevelSetGrid(Backend& backend, const MeshView& mesh, const LevelSetJob& job, const Job& maskJob)
      : b_(backend), mesh_(mesh), job_(job), mask_(backend, mesh, maskJob),
        band_(job.halfWidth, 0, job.voxelSize), leaves_(backend, band_) {}

  /// The buffer is the backend's memory. Of meshes that do not close nothing is made. awaitFaces():
  /// called before those of the job are read.
  template <typename AwaitFaces>
  Result run(const AwaitFaces& awaitFaces) {
    checkJob();
    const NodeCounts inside = mask_.build();
    Result result;
    if (mask_.closed()) {
      awaitFaces();
      result.bytes = make(inside, result.counts);
    } else {
      result.counts = mask_.countsOf({}, 0);
    }
    b_.stage("");
    return result;
  }

  // Public only because of nvcc, as in LevelBuilder.

  const u8* make(const NodeCounts& inside, Counts& counts) {
    maskLayout_ = layoutOf(Kind::Mask, inside);
    maskBytes_ = b_.template alloc<u8>(maskLayout_.size);
    mask_.write(maskBytes_, maskLayout_);
    mask_.writer().writeHead(maskBytes_, maskLayout_, mask_.makeHeader(), mask_.writer().roots());
    b_.dropTemporaries();
    placeFaces();
    placeNodes();
    addLeaves();
    listNodes();
    const u8* bytes = write();
    const auto& tree = *reinterpret_cast<const TreeData*>(maskBytes_ + sizeof(nanovdb::GridData));
    counts = mask_.countsOf(nodes_, layout_.size);
    counts.insideVoxels = b_.read(reinterpret_cast<const u64*>(&tree.mVoxelCount));
    return bytes;
  }

  // The faces that distances are measured to.
  void placeFaces() {
    b_.stage("faces");
    if (job_.faces.points != nullptr) {
      points_ = job_.faces.points;
      faces_ = reinterpret_cast<const Face*>(job_.faces.faces);
      faceCount_ = job_.faces.faceCount;
      return;
    }
    points_ = mask_.points();
    if (mesh_.triangles != nullptr) {
      faceCount_ = mesh_.triangleCount;
      faces_ = soupFaces(b_, mesh_.triangles, faceCount_);
      return;
    }
    std::int8_t* signs = b_.template alloc<std::int8_t>(mesh_.tetCount);
    u64* unused = b_.template temp<u64>(2);
    u32* errors = b_.template temp<u32>(1);
    b_.zero(unused, 2 * sizeof *unused);
    b_.zero(errors, sizeof *errors);
    orientTets(b_, points_, mesh_.pointCount, mesh_.tets, 0, mesh_.tetCount, signs, unused, errors);
    faces_ = boundaryFaces(b_, mesh_.tets, mesh_.tetCount, signs, faceCount_);
    b_.dropTemporaries();
  }

  // Calls visit(place) for the nodes that a face comes near to, as DistanceBand does.
  template <typename Visit>
  TETVDB_HD static void forNodesNear(const KeySpace& space, const LatticePoint* points,
                                     const Face& f, double radius, const Visit& visit) {
    const LatticePoint &a = points[f.a], &b = points[f.b], &c = points[f.c];
    const double min[3] = {minOf(a.x, b.x, c.x), minOf(a.y, b.y, c.y), minOf(a.z, b.z, c.z)};
    const double max[3] = {maxOf(a.x, b.x, c.x), maxOf(a.y, b.y, c.y), maxOf(a.z, b.z, c.z)};
    i64 low[3], high[3];
    for (int k = 0; k < 3; ++k) {
      low[k] = static_cast<i64>(std::ceil(min[k] * kVoxelsPerUnit - radius)) >> 7;
      high[k] = static_cast<i64>(std::floor(max[k] * kVoxelsPerUnit + radius)) >> 7;
    }
    const bool one = low[0] == high[0] && low[1] == high[1] && low[2] == high[2];
    FaceFrame frame;
    if (!one)
      frame = faceFrame(a, b, c,
                        firstVoxelOf({static_cast<i32>(low[0]), static_cast<i32>(low[1]),
                                      static_cast<i32>(low[2])}));
    const auto midpoint = [&](i64 node, i64 first) {
      return static_cast<double>(node - first) * kNodeSize + kHalfNode;
    };
    for (i64 x = low[0]; x <= high[0]; ++x)
      for (i64 y = low[1]; y <= high[1]; ++y)
        for (i64 z = low[2]; z <= high[2]; ++z)
          if (one ||
              mayReach(frame, {midpoint(x, low[0]), midpoint(y, low[1]), midpoint(z, low[2])},
                       kHalfNode, radius))
            visit(Place{static_cast<u64>(x - space.base[0] / 16),
                        static_cast<u64>(y - space.base[1] / 16),
                        static_cast<u64>(z - space.base[2] / 16)});
  }

  // (face, node) pairs, by node in tree order.
  void placeNodes() {
    b_.stage("nodes");
    i64 low[3], high[3];
    mask_.boxOfPoints(low, high);
    for (int k = 0; k < 3; ++k) { // leaves
      const double reach = job_.halfWidth + 1;
      low[k] = static_cast<i64>(std::floor(double(low[k]) * kVoxelsPerUnit - reach)) >> 3;
      high[k] = static_cast<i64>(std::ceil(double(high[k]) * kVoxelsPerUnit + reach)) >> 3;
    }
    space_ = spaceAround(low, high);
    const KeySpace space = space_;
    const LatticePoint* points = points_;
    const Face* faces = faces_;
    const double radius = job_.halfWidth;
    u32* count = b_.template temp<u32>(faceCount_ + 1);
    u64* before = b_.template temp<u64>(faceCount_ + 1);
    b_.forEach(
        faceCount_, TETVDB_KERNEL(u64 i) {
          u32 n = 0;
          forNodesNear(space, points, faces[i], radius, [&](const Place&) { ++n; });
          count[i] = n;
        });
    b_.scan(count, before, faceCount_);
    const u64 pairs = b_.read(before + faceCount_);
    b_.require(pairs * (2 * (sizeof(u64) + sizeof(u32)) + sizeof(NodeFace)));
    u64* keys = b_.template temp<u64>(pairs);
    u32* ofPair = b_.template temp<u32>(pairs);
    b_.forEach(
        faceCount_, TETVDB_KERNEL(u64 i) {
          u64 at = before[i];
          forNodesNear(space, points, faces[i], radius, [&](const Place& node) {
            keys[at] = treeKey(space, 1, node);
            ofPair[at++] = static_cast<u32>(i);
          });
        });
    b_.sort(keys, ofPair, pairs, space_.total() - 3 * levelShift(1));
    NodeFace* nodeFaces = b_.template alloc<NodeFace>(pairs);
    b_.forEach(
        pairs, TETVDB_KERNEL(u64 i) {
          const Place p = placeOfTreeKey(space, 1, keys[i]);
          nodeFaces[i] = {{static_cast<i32>(space.base[0] / 16 + static_cast<i64>(p.x)),
                           static_cast<i32>(space.base[1] / 16 + static_cast<i64>(p.y)),
                           static_cast<i32>(space.base[2] / 16 + static_cast<i64>(p.z))},
                          ofPair[i]};
        });
    const Groups groups = groupsOf(b_, keys, pairs, 0);
    u64* starts = b_.template alloc<u64>(groups.count + 1);
    u64* nodeKeys = b_.template alloc<u64>(groups.count);
    forGroups(
        b_, groups, starts, TETVDB_KERNEL(u64 node, u64 i) { nodeKeys[node] = keys[i]; });
    starts_.resize(groups.count + 1);
    b_.download(starts_.data(), starts, groups.count + 1);
    placed_.points = points_;
    placed_.faces = reinterpret_cast<const u32*>(faces_);
    placed_.nodeFaces = nodeFaces;
    placed_.starts = starts;
    placed_.radius = radius;
    nodeKeys_ = nodeKeys;
    b_.dropTemporaries();
  }

  void addLeaves() {
    BandLeaves<Backend> leaves(b_, placed_, starts_);
    leaves.runHere([&](const typename BandLeaves<Backend>::Batch& batch) {
      leaves_.add(batch, space_, nodeKeys_ + batch.firstNode, insideMask());
    });
    b_.dropTemporaries();
  }

  InsideMask insideMask() const {
    return {reinterpret_cast<const nanovdb::NanoGrid<nanovdb::ValueMask>*>(maskBytes_)};
  }

  // Nodes of a level in tree order, also those of the level set that its fog has not.
  struct Level {
    u64 places = 0;            // nodes of the level set
    const u64* key = nullptr;  // by place
    const u32* kept = nullptr; // by place; null: all
    LevelNodes nodes;          // those kept
    u64 count = 0;             // of these
  };

  // The nodes above the leaves, and the root's entries.
  void listNodes() {
    b_.stage("levels");
    leaf_ = {};
    leaf_.places = leaves_.count();
    checkCount(leaf_.places);
    leaf_.key = leaves_.joined(&MadeLeaves::key);
    if (job_.fog) {
      fog_ = b_.template alloc<FogFindings>(1);
      leaf_.kept = leaves_.withInside(fog_);
      keep(leaf_);
    } else {
      leaf_.count = leaf_.places;
      leaf_.nodes.key = leaf_.key;
      leaf_.nodes.voxels = leaves_.joined(&MadeLeaves::voxels);
      leaf_.nodes.moments = leaves_.joined(&MadeLeaves::moments);
    }
    errors_ = b_.template alloc<u32>(1);
    b_.zero(errors_, sizeof *errors_);
    parents<4>(leaf_, lower_, lowerMasks_);
    parents<5>(lower_, upper_, upperMasks_);
    if (b_.read(errors_) != 0)
      throw std::logic_error("the solid's boundary is away from faces");
    nodes_ = {0, upper_.count, lower_.count, leaf_.count};
    listRoots();
  }

  // Numbers the nodes that are kept.
  void keep(Level& level) {
    u64* index = b_.template alloc<u64>(level.places + 1);
    b_.scan(level.kept, index, level.places);
    level.count = b_.read(index + level.places);
    u32* slots = b_.template alloc<u32>(level.count);
    u64* keys = b_.template alloc<u64>(level.count);
    const u32* kept = level.kept;
    const u64* placeKeys = level.key;
    b_.forEach(
        level.places, TETVDB_KERNEL(u64 i) {
          if (kept[i] == 0)
            return;
          slots[index[i]] = static_cast<u32>(i);
          keys[index[i]] = placeKeys[i];
        });
    level.nodes.index = index;
    level.nodes.nodeSlot = slots;
    level.nodes.key = keys;
    level.nodes.voxels = b_.template alloc<u64>(level.count);
    level.nodes.moments = b_.template alloc<Moments>(level.count);
    b_.dropTemporaries();
  }

  // The parents of nodes in tree order. Children that are no nodes are of one kind.
  template <int kLog2>
  void parents(const Level& children, Level& level, NodeMasks<kLog2>& masks) {
    constexpr int kLevel = kLog2 == 4 ? 1 : 2, kChildren = 1 << (3 * kLog2);
    using Masks = NodeMasks<kLog2>;
    const u64 *keys = children.key, count = children.places;
    const u32* kept = children.kept;
    const Groups groups = groupsOf(b_, keys, count, 3 * kLog2);
    u64* begin = b_.template alloc<u64>(groups.count + 1);
    u64* nodeKeys = b_.template alloc<u64>(groups.count);
    u32* slots = b_.template alloc<u32>(groups.count);
    forGroups(
        b_, groups, begin, TETVDB_KERNEL(u64 node, u64 i) {
          nodeKeys[node] = keys[i] >> (3 * kLog2);
          slots[node] = static_cast<u32>(node);
        });
    masks.child = b_.template alloc<u64>(groups.count * Masks::kWords);
    masks.tile = b_.template alloc<u64>(groups.count * Masks::kWords);
    masks.begin = begin;
    masks.made = groups.count;
    b_.zero(masks.child, groups.count * Masks::kWords * sizeof(u64));
    u64 *child = masks.child, *tile = masks.tile;
    const u64* rank = groups.rank;
    const u32* head = groups.head;
    b_.forEach(
        count, TETVDB_KERNEL(u64 i) {
          if (kept != nullptr && kept[i] == 0)
            return;
          const u64 node = rank[i] + head[i] - 1, place = keys[i] & (kChildren - 1);
          orInto(child + node * Masks::kWords + place / 64, u64(1) << (place % 64));
        });
    const KeySpace space = space_;
    const InsideMask mask = insideMask();
    u32* errors = errors_;
    b_.forEach(
        groups.count * Masks::kWords, TETVDB_KERNEL(u64 w) {
          const u64 node = w / Masks::kWords, first = w % Masks::kWords * 64;
          const u64 nodes = child[w];
          u64 tiles = 0;
          for (u64 n = 0; n < 64; ++n) {
            if ((nodes >> n & 1) != 0)
              continue;
            const u64 key = nodeKeys[node] << (3 * kLog2) | (first + n);
            i32 origin[3];
            originOf(space, kLevel - 1, placeOfTreeKey(space, kLevel - 1, key), origin);
            u64 words[8];
            if (kLevel == 1 && mask.leaf(origin, words) && countVoxels(words) % 512 != 0)
              orInto(errors, 1u);
            tiles |= static_cast<u64>(mask.at(origin)) << n;
          }
          tile[w] = tiles;
        });
    level = {};
    level.places = groups.count;
    level.key = nodeKeys;
    if (job_.fog) {
      level.kept = nodesWithin<kLog2>(masks, groups.count);
      keep(level);
      return;
    }
    level.count = groups.count;
    level.nodes.nodeSlot = slots;
    level.nodes.key = nodeKeys;
    level.nodes.voxels = b_.template alloc<u64>(groups.count);
    level.nodes.moments = b_.template alloc<Moments>(groups.count);
    b_.dropTemporaries();
  }

  // Which nodes have children or tiles.
  template <int kLog2>
  const u32* nodesWithin(const NodeMasks<kLog2>& masks, u64 count) {
    using Masks = NodeMasks<kLog2>;
    u32* kept = b_.template alloc<u32>(count + 1);
    b_.zero(kept, (count + 1) * sizeof(u32));
    const u64 *child = masks.child, *tile = masks.tile;
    FogFindings* fog = fog_;
    b_.forEach(
        count * Masks::kWords, TETVDB_KERNEL(u64 w) {
          if ((child[w] | tile[w]) != 0)
            orInto(kept + w / Masks::kWords, 1u);
          if (kLog2 == 4 && tile[w] != 0)
            orInto(&fog->anyTile, 1u);
        });
    return kept;
  }

  // Upper nodes, and what the mask has besides: all inside.
  void listRoots() {
    std::vector<u64> uppers(nodes_.uppers);
    b_.download(uppers.data(), upper_.nodes.key, nodes_.uppers);
    std::vector<RootTile> tiles(maskLayout_.rootTiles);
    b_.download(tiles.data(),
                reinterpret_cast<const RootTile*>(maskBytes_ + maskLayout_.root + sizeof(RootData)),
                maskLayout_.rootTiles);
    roots_.clear();
    for (u64 i = 0; i < uppers.size(); ++i)
      roots_.push_back({uppers[i], i, 0, 0, kNode});
    for (const RootTile& tile : tiles) {
      const auto origin = RootData::KeyToCoord(tile.key);
      const auto place = [&](u32 k) {
        return static_cast<u64>((i64(origin[k]) >> 3) - space_.base[k]) >> 9;
      };
      const u64 key = treeKey(space_, 2, {place(0), place(1), place(2)});
      if (std::binary_search(uppers.begin(), uppers.end(), key))
        continue;
      if (tile.child != 0)
        throw std::logic_error("the solid's boundary is away from faces");
      roots_.push_back({key, 0, 0, 0, kFull});
    }
    std::sort(roots_.begin(), roots_.end(),
              [](const RootEntry& a, const RootEntry& b) { return a.key < b.key; });
    for (u64 i = 0; i < roots_.size(); ++i)
      roots_[i].rank = i;
    nodes_.rootTiles = roots_.size();
  }

  const u8* write() {
    b_.stage("tree");
    layout_ = layoutOf(Kind::Float, nodes_);
    u8* buffer = b_.output(layout_.size);
    if (job_.fog)
      leaves_.writeFog(buffer + layout_.leafHere, fogDepth(), space_, leaf_.kept, leaf_.nodes);
    else
      leaves_.write(buffer + layout_.leafHere);
    RootEntry* roots = b_.template alloc<RootEntry>(roots_.size());
    b_.upload(roots, roots_.data(), roots_.size() * sizeof(RootEntry));
    const float background = band_.background;
    GridValues values{bitsOf(-background), bitsOf(background), true};
    if (job_.fog) {
      values = {bitsOf(1.0F), 0};
      values.variedLeaves = true;
    }
    GridWriter<Backend> writer(b_, space_, Kind::Float, values);
    writer.take(leaf_.nodes, lower_.nodes, upper_.nodes, roots, roots_.size());
    writer.writeInternal(buffer, layout_, {}, {{}, {}, lowerMasks_, upperMasks_});
    const double size[3] = {job_.voxelSize, job_.voxelSize, job_.voxelSize};
    writer.writeHead(
        buffer, layout_,
        gridHeader(Kind::Float,
                   job_.fog ? nanovdb::GridClass::FogVolume : nanovdb::GridClass::LevelSet,
                   job_.name, size, job_.origin),
        writer.roots());
    return buffer;
  }

  // The value at which the fog is 1: fogDepth() of fields/FogVolume.h.
  float fogDepth() const {
    const FogFindings found = b_.read(fog_);
    return found.anyTile != 0
               ? -band_.background
               : floatFrom(static_cast<u32>(inOrder(static_cast<u32>(found.least), true)));
  }

private:
  void checkJob() const {
    if (!(job_.halfWidth >= kMinHalfWidth && job_.halfWidth <= kMaxHalfWidth))
      throw Error(Status::Usage, "", "the half-width must be between 1 and 100 voxels");
    if (mesh_.holes != nullptr)
      throw Error(Status::Usage, "",
                  "the level set of a mesh with holes is not made on the device");
  }

  Backend& b_;
  const MeshView& mesh_;
  const LevelSetJob& job_;
  Pipeline<Backend> mask_;
  NarrowBand band_;
  BufferLayout maskLayout_{}, layout_{};
  u8* maskBytes_ = nullptr;
  KeySpace space_{};
  const LatticePoint* points_ = nullptr;
  const Face* faces_ = nullptr;
  u64 faceCount_ = 0;
  PlacedBand placed_;
  std::vector<u64> starts_;       // the host's copy of placed_.starts
  const u64* nodeKeys_ = nullptr; // of its nodes
  LevelSetLeaves<Backend> leaves_;
  Level leaf_, lower_, upper_;
  FogFindings* fog_ = nullptr; // the backend's
  NodeMasks<4> lowerMasks_;
  NodeMasks<5> upperMasks_;
  std::vector<RootEntry> roots_;
  NodeCounts nodes_;
  u32* errors_ = nullptr;
};

} // namespace tetvdb::nano
