// SPDX-License-Identifier: Apache-2.0
//
// One model from arrays to a NanoVDB buffer, on any backend:
// snap -> (orient -> boundary | edges) -> (faces' leaves | tets' leaves) -> lower nodes -> upper
// nodes -> write.
#pragma once

#include "DenseFaces.h"
#include "DenseTree.h"
#include "DeviceVoxelizer.h"
#include "SnapPoints.h"
#include "SoupFaces.h"
#include "WriteGrid.h"
#include "tetvdb/core/Error.h"

#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

namespace tetvdb::nano {

/// Up to here crossings in a dense array, 2 kB a leaf, are faster than sorted ones: about 512^3.
constexpr u64 kMaxDenseLeaves = u64(1) << 18;

inline Kind kindOf(GridType type) {
  return type == GridType::Mask   ? Kind::Mask
         : type == GridType::Bool ? Kind::Boolean
         : type == GridType::Fog  ? Kind::Float
                                  : Kind::Int32;
}

/// Which of how many devices this is, when several share a grid by columns of root tiles.
struct ShareOf {
  int number = 0, of = 1;
};

template <typename Backend>
class Pipeline {
public:
  /// `mesh` lies where the backend computes.
  Pipeline(Backend& backend, const MeshView& mesh, const Job& job, ShareOf shareOf = {})
      : b_(backend), mesh_(mesh), job_(job), shareOf_(shareOf), kind_(kindOf(job.type)) {}

  /// Builds; the buffer is the backend's memory.
  Result run() {
    const NodeCounts nodes = build();
    if (!closed()) {
      b_.stage("");
      Result open;
      open.counts = counts_;
      return open;
    }
    const BufferLayout layout = layoutOf(kind_, nodes);
    u8* buffer = b_.output(layout.size);
    write(buffer, layout);
    writer_->writeHead(buffer, layout, makeHeader(), writer_->roots());
    b_.stage("");
    Result result;
    result.counts = countsOf(nodes, layout.size);
    result.bytes = buffer;
    return result;
  }

  /// First part: everything up to the numbers of nodes (of this share).
  NodeCounts build() {
    placeMesh();
    writer_ = std::make_unique<GridWriter<Backend>>(b_, space_, kind_, valuesOf(job_.type));
    const bool owners = job_.type == GridType::Owner;
    const Method denseMethod = soup() ? Method::Dense : Method::Tets;
    const bool dense =
        !owners && holes() == nullptr &&
        (job_.method == denseMethod ? denseFits() : job_.method == Method::Auto && denseIsFaster());
    if (holes() != nullptr && job_.method == Method::Dense)
      throw Error(Status::Usage, "", "holes are not filled by the dense method",
                  "take the method by the boundary");
    if (!owners && job_.method == denseMethod && !dense)
      throw Error(Status::Limit, "", "the grid is too large for a dense array on the device",
                  "take the method by the boundary");
    counts_.method = dense ? denseMethod : owners ? Method::Tets : Method::Boundary;
    const NodeCounts nodes = !dense   ? buildSparse(owners)
                             : soup() ? buildDenseFaces()
                                      : buildDense();
    checkCount(nodes.leaves);
    return nodes;
  }

  /// Whether the mesh has an inside: after build().
  bool closed() const {
    return job_.rule == FillRule::Odd ? counts_.oddEdges == 0
                                      : counts_.openEdges == 0 || mesh_.holes != nullptr;
  }

  /// Second part: the nodes into `buffer`, of layout.sizeHere bytes.
  void write(u8* buffer, const BufferLayout& layout) {
    b_.stage("tree");
    writer_->writeTree(buffer, layout, leaves_, masks_, table_, summaries_, nodes_);
  }

  /// In place of build(): the leaves that tets own voxels of, in tree order, and the number of the
  /// owner (of mesh.tets) of each of their voxels.
  void buildOwners() {
    placeMesh();
    orient();
    rasterizeOwners();
    checkCount(leaves_.count);
  }
  /// After buildOwners(): the numbers of nodes of a grid of these leaves, `table` and `summaries`
  /// by slot, for write(). `classes`: see LevelBuilder.
  NodeCounts buildValues(Kind kind, const GridValues& values, const Entries& leaves, u64* masks,
                         const u32* table, const LeafSummary* summaries, const u32* classes) {
    kind_ = kind;
    writer_ = std::make_unique<GridWriter<Backend>>(b_, space_, kind, values);
    leaves_ = leaves;
    masks_.mask = masks;
    table_ = table;
    summaries_ = summaries;
    return buildLevels(true, classes);
  }
  const Entries& leaves() const { return leaves_; }
  const LatticePoint* points() const { return points_; }
  /// Lattice units; an empty one has a point at the origin.
  void boxOfPoints(i64 (&low)[3], i64 (&high)[3]) const {
    for (int k = 0; k < 3; ++k) {
      const bool none = found_.low[k] > found_.high[k];
      low[k] = none ? 0 : found_.low[k];
      high[k] = none ? 0 : found_.high[k];
    }
  }
  const u64* ownerMasks() const { return masks_.mask; } ///< by leaf
  const u32* ownerTable() const { return table_; }      ///< 512 a leaf, kNoTet: none

  GridWriter<Backend>& writer() { return *writer_; }
  const KeySpace& space() const { return space_; }
  Kind kind() const { return kind_; }
  GridValues values() const { return valuesOf(job_.type); }

  Counts countsOf(const NodeCounts& nodes, u64 bytes) const {
    Counts counts = counts_;
    counts.leaves = nodes.leaves;
    counts.lowerNodes = nodes.lowers;
    counts.upperNodes = nodes.uppers;
    counts.rootTiles = nodes.rootTiles - nodes.uppers;
    counts.bufferBytes = bytes;
    return counts;
  }

  // Public for nvcc alone, as in LevelBuilder.

  /// The points on the lattice, what was found of them, and the space of nodes around them.
  void placeMesh() {
    checkJob();
    b_.stage("snap");
    begin();
    b_.awaitPoints();
    points_ = snapPoints(b_, mesh_, job_, findings_);
    found_ = b_.read(findings_);
    chooseSpace();
  }

  void begin() {
    findings_ = b_.template alloc<Findings>(1);
    errors_ = &findings_->errors;
    Findings* findings = findings_;
    b_.forEach(
        1, TETVDB_KERNEL(u64) {
          for (int k = 0; k < 3; ++k) {
            findings->low[k] = i64(1) << 62;
            findings->high[k] = -(i64(1) << 62);
          }
          findings->flipped = findings->flat = 0;
          findings->openEdges = findings->oddEdges = 0;
          findings->errors = findings->unused = 0;
        });
  }

  // Calls f(begin, end) for the tets as they arrive.
  template <typename F>
  void forArriving(const F& f) {
    const u64 parts = static_cast<u64>(b_.parts());
    for (u64 part = 0; part < parts; ++part) {
      b_.awaitCells(static_cast<int>(part));
      f(mesh_.tetCount * part / parts, mesh_.tetCount * (part + 1) / parts);
    }
  }
  // Once all triangles are there.
  void awaitTriangles() {
    for (int part = 0; part < b_.parts(); ++part)
      b_.awaitCells(part);
  }

  DenseBox denseBox() const {
    DenseBox box{};
    for (int k = 0; k < 3; ++k) {
      box.first[k] = nodeMin_[k];
      box.size[k] = nodeMax_[k] - nodeMin_[k] + 1;
      box.voxel[k] = (space_.base[k] + static_cast<i64>(nodeMin_[k]) * 16) * 8;
    }
    return box;
  }

  NodeCounts buildDense() {
    b_.stage("rasterize");
    DenseRasterizer<Backend> tets(b_, denseBox(), points_, mesh_.pointCount, mesh_.tets,
                                  mesh_.tetCount);
    tets.begin();
    forArriving([&](u64 begin, u64 end) { tets.add(begin, end, errors_); });
    tets.addMany();
    u64 tallies[2];
    const NodeCounts nodes = takeDense(tets.box(), tets.tallies(), tallies);
    counts_.flipped = tallies[0];
    counts_.dropped = tallies[1];
    return nodes;
  }

  NodeCounts buildDenseFaces() {
    b_.stage("edges");
    u64* tallies = b_.template alloc<u64>(2 * kTallies);
    b_.zero(tallies, 2 * kTallies * sizeof(u64));
    awaitTriangles();
    countSoupEdges(b_, points_, mesh_.pointCount, mesh_.triangles, mesh_.triangleCount, tallies,
                   tallies + kTallies, errors_);
    b_.stage("rasterize");
    const DenseBox box = denseBox();
    u64 first[3], size[3];
    crossedLeaves(first, size);
    DenseFaces<Backend> faces(b_, box, first, size, points_, mesh_.pointCount, mesh_.triangles,
                              mesh_.triangleCount);
    faces.begin();
    faces.add(errors_);
    faces.addMany();
    faces.sum(job_.rule, errors_);
    counts_.boundaryFaces = mesh_.triangleCount;
    u64 edges[2];
    const NodeCounts nodes = takeDense(faces.box(), tallies, edges);
    counts_.openEdges = edges[0];
    counts_.oddEdges = edges[1];
    if (closed())
      refuseLoss();
    return nodes;
  }

  // The leaves that crossings may lie in, counted from the first of the DenseBox.
  void crossedLeaves(u64 (&first)[3], u64 (&size)[3]) const {
    for (int k = 0; k < 3; ++k) {
      first[k] = leafMin_[k] - nodeMin_[k] * 16;
      size[k] = leafMax_[k] - leafMin_[k] + 1;
    }
  }

  // The tree of the masks; `sums` receives those of the tallies.
  NodeCounts takeDense(const DenseBox& box, const u64* tallies, u64 (&sums)[2]) {
    b_.stage("levels");
    DenseTree<Backend> tree(b_, space_, box, evenShare());
    DenseNodes nodes = tree.number(tallies, errors_);
    const DenseCounts found = b_.read(nodes.counts);
    refuseCells(found.errors);
    found_.errors = found.errors;
    sums[0] = found.tallies[0];
    sums[1] = found.tallies[1];
    tree.list(nodes, found.leaves);
    writer_->take(nodes.leaf, nodes.lowers, nodes.uppers, nodes.roots, found.uppers);
    nodes_.lowerMasks = nodes.lower;
    nodes_.upperMasks = nodes.upper;
    masks_.mask = box.mask;
    return {found.uppers, found.uppers, found.lowers, found.leaves};
  }

  // The tets' signs, once all are there.
  void orient() {
    b_.stage("orient");
    signs_ = b_.template alloc<std::int8_t>(mesh_.tetCount);
    forArriving([&](u64 begin, u64 end) {
      orientTets(b_, points_, mesh_.pointCount, mesh_.tets, begin, end, signs_, &findings_->flipped,
                 errors_);
    });
    found_ = b_.read(findings_);
    refuseCells(found_.errors);
    counts_.flipped = found_.flipped;
    counts_.dropped = found_.flat;
  }

  void rasterizeOwners() {
    TetRasterizer<Backend> tets(b_, space_, points_, mesh_.tets, mesh_.tetCount, signs_);
    leaves_ = tets.runOwners(mesh_.values, kNoTet, shareByTets(), masks_, table_, summaries_);
  }

  // What fills the holes of the triangles, where that is asked for.
  const HolesView* holes() const {
    return soup() && job_.rule != FillRule::Odd ? mesh_.holes : nullptr;
  }

  // The faces of a soup; null where it has no inside.
  const Face* closedSoup() {
    b_.stage("edges");
    awaitTriangles();
    countSoupEdges(b_, points_, mesh_.pointCount, mesh_.triangles, mesh_.triangleCount,
                   &findings_->openEdges, &findings_->oddEdges, errors_);
    b_.dropTemporaries();
    found_ = b_.read(findings_);
    refuseCells(found_.errors);
    counts_.openEdges = found_.openEdges;
    counts_.oddEdges = found_.oddEdges;
    return closed() ? soupFaces(b_, mesh_.triangles, mesh_.triangleCount) : nullptr;
  }

  NodeCounts buildSparse(bool owners) {
    if (!soup())
      orient();
    if (owners) {
      rasterizeOwners();
    } else {
      u64 faceCount = mesh_.triangleCount;
      const Face* faces = nullptr;
      if (soup()) {
        faces = closedSoup();
        if (faces == nullptr)
          return {};
      } else {
        b_.stage("boundary");
        faces = boundaryFaces(b_, mesh_.tets, mesh_.tetCount, signs_, faceCount);
      }
      counts_.boundaryFaces = faceCount;
      leaves_ = FaceRasterizer<Backend>(b_, space_, job_.rule)
                    .run(points_, faces, faceCount, holes(), shareByFaces(faces, faceCount),
                         nodeSizes(kind_).leaf, masks_);
    }
    return buildLevels(owners);
  }

  // The nodes above leaves_; where values vary there are entries of all that is inside.
  NodeCounts buildLevels(bool varied, const u32* classes = nullptr) {
    b_.stage("levels");
    LevelBuilder<Backend> levels(b_, space_, !varied, kind_ == Kind::Float, errors_, classes);
    levels.template closeGaps<1>(0, leaves_, masks_.top,
                                 GrowLeaves<Backend>{b_, masks_, leaves_.slots});
    nodes_ = levels.nodesAbove(leaves_);
    if (!varied) {
      found_.errors = b_.read(errors_);
      refuseLoss();
    }
    return writer_->number(leaves_, nodes_.lowers, nodes_.uppers);
  }

  void refuseLoss() const {
    if (found_.errors & kNotClosed)
      throw std::logic_error("the boundary does not close: crossings were lost");
  }
  void refuseCells(u32 errors) const {
    const std::string cell = soup() ? "a triangle" : "a tet";
    if (errors & kBadIndex)
      throw Error(Status::Invalid, "", cell + " refers to a point that is not there");
    if (errors & kLongTet)
      throw Error(Status::Limit, "", cell + " is longer than 2^20 voxels", "use larger voxels");
  }

  void chooseSpace() {
    if (found_.errors & kBadPoint)
      throw Error(Status::Limit, "",
                  "a point is not finite, or the mesh leaves 32-bit index space at this voxel size",
                  "repair the mesh or use larger voxels");
    i64 first[3], last[3]; // leaves
    i64 low[3], high[3];
    boxOfPoints(low, high);
    for (int k = 0; k < 3; ++k) {
      // A crossing counts from at most one voxel above the box.
      first[k] = (low[k] >> kLatticeBits) >> 3;
      last[k] = ((high[k] >> kLatticeBits) + 1) >> 3;
      if (holes() != nullptr)
        for (u64 i = 0; i < holes()->leafCount; ++i) {
          const i64 leaf = holes()->leaves[i].first[k] >> 3;
          first[k] = leaf < first[k] ? leaf : first[k];
          last[k] = leaf > last[k] ? leaf : last[k];
        }
    }
    space_ = spaceAround(first, last);
    for (int k = 0; k < 3; ++k) {
      leafMin_[k] = static_cast<u64>(first[k] - space_.base[k]);
      leafMax_[k] = static_cast<u64>(last[k] - space_.base[k]);
      nodeMin_[k] = leafMin_[k] >> 4;
      nodeMax_[k] = leafMax_[k] >> 4;
    }
  }

  bool denseFits() const {
    for (int k = 0; k < 3; ++k)
      if (nodeMax_[k] - nodeMin_[k] >= DenseBox::kMaxNodes)
        return false;
    return true;
  }

  // Seconds on an H200, fitted to the rows of the benchmark "paper" (docs/benchmarks.md); the
  // boundary method has the cost of its many steps and of matching faces.
  bool denseIsFaster() const {
    if (!denseFits())
      return false;
    if (soup()) {
      u64 first[3], size[3];
      crossedLeaves(first, size);
      return size[0] * size[1] * size[2] <= kMaxDenseLeaves;
    }
    double voxels = 1, surface = 0;
    double side[3];
    for (int k = 0; k < 3; ++k) {
      side[k] = static_cast<double>(found_.high[k] - found_.low[k]) * kVoxelsPerUnit + 1;
      voxels *= side[k];
    }
    for (int k = 0; k < 3; ++k)
      surface += 2 * side[k] * side[(k + 1) % 3];
    const auto tets = static_cast<double>(mesh_.tetCount);
    // Six tets of a cell share its box.
    const double columns = tets * std::pow(std::cbrt(6 * voxels / (tets + 1)), 2);
    const double dense = 0.1e-3 + tets * 3e-11 + columns * 9e-12 + voxels * 1e-13;
    const double boundary = 0.65e-3 + tets * 4e-10 + surface * 3e-11;
    return dense < boundary;
  }

  // All that one device makes.
  RootShare ownShare() const {
    RootShare share;
    if (!job_.oneColumn)
      return share;
    u64 at[2];
    for (int k = 0; k < 2; ++k) {
      at[k] = static_cast<u64>(job_.column[k] - space_.base[k] / 512); // negative: very large
      if (at[k] >= u64(1) << (space_.bits[k] - 9))
        return {0, 0};
    }
    share.begin = at[0] << (space_.bits[1] - 9) | at[1];
    share.end = share.begin + 1;
    return share;
  }

  // Shares of about as many columns of root tiles.
  RootShare evenShare() const {
    if (shareOf_.of == 1)
      return ownShare();
    RootShare share;
    const auto tiles = [&](int k, u64 node) {
      return node >> 5 << (k == 0 ? space_.bits[1] - 9 : 0);
    };
    const u64 first = tiles(0, nodeMin_[0]) + tiles(1, nodeMin_[1]);
    const u64 last = tiles(0, nodeMax_[0]) + tiles(1, nodeMax_[1]);
    const u64 number = static_cast<u64>(shareOf_.number), of = static_cast<u64>(shareOf_.of);
    share.begin = first + (last + 1 - first) * number / of;
    share.end = first + (last + 1 - first) * (number + 1) / of;
    return share;
  }

  // Shares of about the same work: leaves in the boxes of faces seen along z, or of tets.
  RootShare shareByFaces(const Face* faces, u64 faceCount) {
    const LatticePoint* points = points_;
    return shareByWork(
        faceCount, TETVDB_KERNEL(u64 i, i64(&low)[3], i64(&high)[3]) {
          const Face f = faces[i];
          const LatticePoint &a = points[f.a], &b = points[f.b], &c = points[f.c];
          low[0] = ceilVoxel(minOf(a.x, b.x, c.x)) >> 3;
          low[1] = ceilVoxel(minOf(a.y, b.y, c.y)) >> 3;
          high[0] = floorVoxel(maxOf(a.x, b.x, c.x)) >> 3;
          high[1] = floorVoxel(maxOf(a.y, b.y, c.y)) >> 3;
          low[2] = high[2] = 0;
        });
  }
  RootShare shareByTets() {
    const LatticePoint* points = points_;
    const u32* tets = mesh_.tets;
    return shareByWork(
        mesh_.tetCount, TETVDB_KERNEL(u64 t, i64(&low)[3], i64(&high)[3]) {
          LatticePoint v[4];
          for (u64 k = 0; k < 4; ++k)
            v[k] = points[tets[4 * t + k]];
          const TetBox box = voxelBox(boxOf(v[0], v[1], v[2], v[3]));
          for (int k = 0; k < 3; ++k) {
            low[k] = box.min[k] >> 3;
            high[k] = box.max[k] >> 3;
          }
        });
  }

  // boxOf(i, low, high): item i's box in leaves, inclusive. The sums are of integers, so that all
  // devices come to the same shares without a word.
  template <typename BoxOf>
  RootShare shareByWork(u64 items, const BoxOf& boxOf) {
    if (shareOf_.of == 1)
      return ownShare();
    constexpr int kMaxBits = 20;
    const int columnBits = space_.bits[0] + space_.bits[1] - 18;
    if (columnBits > kMaxBits)
      return evenShare();
    const u64 columns = u64(1) << columnBits;
    u64* work = b_.template temp<u64>(columns);
    b_.zero(work, columns * sizeof(u64));
    const KeySpace space = space_;
    b_.forEach(
        items, TETVDB_KERNEL(u64 i) {
          i64 low[3], high[3];
          boxOf(i, low, high);
          if (low[0] > high[0] || low[1] > high[1] || low[2] > high[2])
            return;
          for (int k = 0; k < 2; ++k) {
            low[k] -= space.base[k];
            high[k] -= space.base[k];
          }
          const u64 height = static_cast<u64>(high[2] - low[2] + 1);
          for (i64 x = low[0] >> 9; x <= high[0] >> 9; ++x)
            for (i64 y = low[1] >> 9; y <= high[1] >> 9; ++y) {
              const i64 x0 = x * 512 > low[0] ? x * 512 : low[0];
              const i64 y0 = y * 512 > low[1] ? y * 512 : low[1];
              const i64 x1 = x * 512 + 511 < high[0] ? x * 512 + 511 : high[0];
              const i64 y1 = y * 512 + 511 < high[1] ? y * 512 + 511 : high[1];
              const u64 area = static_cast<u64>((x1 - x0 + 1) * (y1 - y0 + 1));
              addTo(&work[static_cast<u64>(x) << (space.bits[1] - 9) | static_cast<u64>(y)],
                    area * height);
            }
        });
    std::vector<u64> found(columns);
    b_.download(found.data(), work, columns);
    u64 total = 0;
    for (u64 w : found)
      total += w;
    // A share ends with the column whose middle is beyond its part of the work.
    const auto cut = [&](int k) {
      u64 before = 0, column = 0;
      const double part = static_cast<double>(total) * k / shareOf_.of;
      while (column < columns &&
             static_cast<double>(before) + static_cast<double>(found[column]) / 2 < part)
        before += found[column++];
      return column;
    };
    RootShare share;
    if (shareOf_.number > 0)
      share.begin = cut(shareOf_.number);
    if (shareOf_.number + 1 < shareOf_.of)
      share.end = cut(shareOf_.number + 1);
    return share;
  }

  bool soup() const { return mesh_.triangles != nullptr; }

  void checkJob() const {
    if (soup() && job_.type == GridType::Owner)
      throw Error(Status::Usage, "", "triangles own no voxels", "use a mesh of tets");
    for (int k = 0; k < 3; ++k)
      if (!(job_.voxelSize[k] > 0) || !std::isfinite(job_.voxelSize[k]) ||
          !std::isfinite(job_.origin[k]))
        throw Error(Status::Usage, "", "voxel size and origin must be finite, the size positive");
    if (job_.name.size() > 255)
      throw Error(Status::Usage, "", "the grid's name is longer than 255 bytes");
    if (mesh_.tetCount >= u64(1) << 32 || mesh_.pointCount >= u64(1) << 32 ||
        mesh_.triangleCount >= u64(1) << 31)
      throw Error(Status::Limit, "", "the mesh has 2^32 tets or points or 2^31 triangles or more");
  }

  static GridValues valuesOf(GridType type) {
    if (type == GridType::Fog)
      return {0x3F800000u, 0}; // 1 and 0 as floats
    return type == GridType::Owner ? GridValues{0, 0xFFFFFFFFu, false, true} : GridValues{1, 0};
  }

  nanovdb::GridData makeHeader() const {
    return gridHeader(kind_,
                      job_.type == GridType::Fog    ? nanovdb::GridClass::FogVolume
                      : job_.type == GridType::Mask ? nanovdb::GridClass::Topology
                                                    : nanovdb::GridClass::Unknown,
                      job_.name, job_.voxelSize, job_.origin);
  }

private:
  Backend& b_;
  const MeshView& mesh_;
  const Job& job_;
  ShareOf shareOf_;
  Kind kind_;
  KeySpace space_{};
  // In units of leaves and lower nodes from the space's base, inclusive.
  u64 leafMin_[3] = {0, 0, 0}, leafMax_[3] = {0, 0, 0};
  u64 nodeMin_[3] = {0, 0, 0}, nodeMax_[3] = {0, 0, 0};
  const LatticePoint* points_ = nullptr;
  std::int8_t* signs_ = nullptr;
  u32* errors_ = nullptr;
  Findings* findings_ = nullptr; // the backend's
  Findings found_{};
  Counts counts_;
  std::unique_ptr<GridWriter<Backend>> writer_;
  // What was built, to be written.
  Entries leaves_;
  InternalNodes nodes_;
  LeafMasks masks_;
  const u32* table_ = nullptr; // values' bits
  const LeafSummary* summaries_ = nullptr;
};

} // namespace tetvdb::nano
