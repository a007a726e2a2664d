// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/BitVdbWriter.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/BitTopology.h"
#include "tetvdb/io/volume/OpenedSource.h"
#include "tetvdb/io/volume/Spool.h"
#include "tetvdb/io/volume/VdbPieces.h"
#include "tetvdb/volume/VoxelBounds.h"

#include <algorithm>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace tetvdb {
namespace {

/// Counts of a grid's nodes: the same for all grids of a file.
struct Counts {
  std::uint64_t voxels = 0, tiles = 0, leaves = 0, lowers = 0, uppers = 0;
  VoxelBounds box;
  std::optional<Vec3i> firstTile; ///< by x, then y, then z

  void addTile(const Vec3i& origin, std::int32_t size) {
    ++tiles;
    voxels += static_cast<std::uint64_t>(size) * static_cast<std::uint64_t>(size) *
              static_cast<std::uint64_t>(size);
    box.add(origin, size);
    if (!firstTile || origin < *firstTile)
      firstTile = origin;
  }
  void add(const Counts& o) {
    voxels += o.voxels;
    tiles += o.tiles;
    leaves += o.leaves;
    lowers += o.lowers;
    uppers += o.uppers;
    box.add(o.box);
    if (o.firstTile && (!firstTile || *o.firstTile < *firstTile))
      firstTile = o.firstTile;
  }
};

/// A stack under construction: the state of the box before it, then the result.
struct StackPiece {
  int stack = 0;
  VoxelBounds known;
  std::string bytes;
  std::array<NodeState, kStackNodes> states{};
  Counts counts;
  std::vector<std::uint16_t> leaves; ///< active voxels of each
};

void addNode(const Vec3i& origin, const BitNode& node, StackPiece& piece) {
  Counts& counts = piece.counts;
  ++counts.lowers;
  for (std::size_t w = 0; w < node.tiles.size(); ++w)
    for (std::uint64_t rest = node.tiles[w]; rest != 0; rest &= rest - 1)
      counts.addTile(leafOrigin(origin, 64 * w + static_cast<std::size_t>(__builtin_ctzll(rest))),
                     8);
  const std::size_t first = piece.leaves.size(), leaves = node.leaves.size() / 8;
  piece.leaves.resize(first + leaves);
  counts.leaves += leaves;
  counts.voxels += countLeafBits(node.leaves.data(), leaves, piece.leaves.data() + first);
  if (piece.known.contains(origin, 128))
    return;
  const std::uint64_t* leaf = node.leaves.data();
  for (std::size_t w = 0; w < node.children.size(); ++w)
    for (std::uint64_t rest = node.children[w]; rest != 0; rest &= rest - 1, leaf += 8) {
      const Vec3i corner =
          leafOrigin(origin, 64 * w + static_cast<std::size_t>(__builtin_ctzll(rest)));
      if (!piece.known.contains(corner, 8) && !counts.box.contains(corner, 8))
        counts.box.add(corner, leaf);
    }
}

/// A grid of the file.
struct FileGrid {
  openvdb::GridBase::Ptr asked; ///< empty
  openvdb::GridBase::Ptr grid;  ///< the same, with its creator
  std::unique_ptr<BitCodec> codec;
  std::uint64_t topologyAt = 0;
};

class Writing {
public:
  Writing(VdbOutput& output, const openvdb::GridPtrVec& grids, const BitVdbOptions& options,
          const std::vector<RootCube>& cubes)
      : output_(output), options_(options) {
    for (const RootCube& cube : cubes)
      if (cube.full) {
        rootTiles_.push_back(cube.origin);
        counts_.addTile(cube.origin, 4096);
      }
    for (const auto& grid : grids)
      grids_.push_back({grid, withCreator(grid), makeBitCodec(*grid), 0});
  }

  const Counts& counts() const { return counts_; }

  /// The topology of the first grid.
  void topology(BitSource& source, const ProgressShare& share) {
    FileGrid& grid = grids_.front();
    // The metadata for delayed loading comes before the topology.
    keeps_ = std::any_of(grids_.begin(), grids_.end(),
                         [](const FileGrid& one) { return one.codec->hasDelayedLoad(); });
    if (!grid.codec->hasDelayedLoad())
      begin(grid);
    const std::vector<RootCube>& cubes = source.cubes();
    for (std::size_t c = 0; c < cubes.size(); ++c) {
      if (!cubes[c].full)
        cube(source, c,
             share.part(double(c) / double(cubes.size()), double(c + 1) / double(cubes.size())));
      share.update(double(c + 1) / double(cubes.size()));
    }
  }

  /// Everything else.
  void rest(const ProgressShare& share) {
    for (std::size_t g = 0; g < grids_.size(); ++g) {
      const double count = double(grids_.size());
      const ProgressShare own = share.part(double(g) / count, double(g + 1) / count);
      FileGrid& grid = grids_[g];
      if (grid.topologyAt == 0)
        begin(grid);
      if (g > 0)
        topologyAgain(grid, own.part(0, 0.4));
      output_.file().flush();
      const std::uint64_t buffersAt = output_.position();
      buffers(grid, own.part(0.4, 1));
      output_.finishGrid(headOf(grid), buffersAt);
    }
  }

  std::vector<GridInfo> describeGrids() const {
    std::vector<GridInfo> infos;
    for (const FileGrid& grid : grids_) {
      Volume empty;
      empty.grids().all.push_back(grid.asked);
      GridInfo info = describe(empty).front();
      info.activeVoxels = counts_.voxels;
      info.activeTiles = counts_.tiles;
      info.leaves = counts_.leaves;
      info.bytes = bytesOf(grid.codec->describedBytes());
      info.volume = static_cast<double>(counts_.voxels) * grid.grid->transform().voxelVolume();
      if (counts_.voxels > 0) {
        info.boxMin = counts_.box.min;
        info.boxMax = counts_.box.max;
        info.minValue = info.maxValue = 1;
      }
      infos.push_back(std::move(info));
    }
    return infos;
  }

private:
  void cube(BitSource& source, std::size_t index, const ProgressShare& share) {
    const Vec3i origin = source.cubes()[index].origin;
    const std::vector<int> stacks = source.begin(index);
    const BitCodec& codec = *grids_.front().codec;
    UpperMasks masks;
    Spool spool(folder(), options_.spoolBytes);
    Counts sum;
    std::size_t next = 0, done = 0;
    using Piece = std::shared_ptr<StackPiece>;
    makeInOrder<Piece, Piece>(
        [&](Piece& piece) {
          if (next == stacks.size())
            return false;
          piece = std::make_shared<StackPiece>();
          piece->stack = stacks[next++];
          const std::lock_guard lock(knownMutex_); // blocks are taken at the same time
          piece->known = known_;
          return true;
        },
        [&](const Piece& piece) {
          BitStack stack;
          source.fill(piece->stack, stack);
          piece->states = stack.states;
          for (int z = 0; z < kStackNodes; ++z) {
            const auto i = static_cast<std::size_t>(z);
            const Vec3i node{origin[0] + piece->stack / kStackNodes * 128,
                             origin[1] + piece->stack % kStackNodes * 128, origin[2] + z * 128};
            if (stack.states[i] == NodeState::Full)
              piece->counts.addTile(node, 128);
            if (stack.states[i] != NodeState::Mixed)
              continue;
            addNode(node, *stack.nodes[i], *piece);
            codec.addLower(*stack.nodes[i], piece->bytes);
            stack.nodes[i].reset();
          }
          return piece;
        },
        [&](const Piece& piece) {
          for (std::size_t z = 0; z < kStackNodes; ++z) {
            const std::size_t entry = static_cast<std::size_t>(piece->stack) * kStackNodes + z;
            const std::uint64_t bit = std::uint64_t(1) << (entry & 63);
            if (piece->states[z] == NodeState::Full)
              masks.tiles[entry >> 6] |= bit;
            if (piece->states[z] == NodeState::Mixed)
              masks.children[entry >> 6] |= bit;
          }
          sum.add(piece->counts);
          {
            const std::lock_guard lock(knownMutex_);
            known_.add(piece->counts.box);
          }
          spool.add(piece->bytes);
          if (keeps_)
            leafCounts_.insert(leafCounts_.end(), piece->leaves.begin(), piece->leaves.end());
          share.update(double(++done) / double(stacks.size()));
        },
        options_.window);
    if (sum.tiles == 0 && sum.lowers == 0)
      return;
    if (sum.lowers == 0 && sum.tiles == std::uint64_t(kStackNodes) * kStacksPerCube)
      throw std::logic_error("a full cube was not known as one");
    ++sum.uppers;
    counts_.add(sum);
    if (counts_.leaves >= std::numeric_limits<std::uint32_t>::max())
      throw Error(Status::Limit, "", "a grid would have 2^32 leaves or more",
                  "OpenVDB cannot count them: write parts with `shard`");
    if (counts_.leaves > kDelayedLoadLeaves && keeps_) {
      keeps_ = false;
      leafCounts_ = {};
      if (grids_.front().topologyAt == 0)
        begin(grids_.front());
    }
    put(codec.upper(origin, masks));
    spool.drain([&](const std::string& bytes) { put(bytes); });
  }

  void put(const std::string& bytes) {
    if (grids_.front().topologyAt == 0)
      kept_->add(bytes);
    else
      output_.write(bytes);
  }

  /// Writes the known part of the head, and the bytes that were kept to follow it.
  void begin(FileGrid& grid) {
    output_.beginGrid(headOf(grid));
    grid.topologyAt = output_.position();
    if (&grid == &grids_.front() && kept_) {
      kept_->drain([&](const std::string& bytes) { output_.write(bytes); });
      kept_.reset();
    }
  }

  VdbHead headOf(const FileGrid& grid) const {
    const openvdb::GridBase::Ptr copy = withCounts(
        grid.grid,
        {counts_.box, counts_.voxels, counts_.leaves, bytesOf(grid.codec->openvdbBytes())},
        options_.part);
    if (grid.codec->hasDelayedLoad() && keeps_)
      copy->insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD,
                       *grid.codec->delayedLoad(leafCounts_));
    return makeVdbHead(grid.grid->getName(), vdbTypeOf(*grid.grid), "", *copy,
                       grid.grid->transform(),
                       grid.codec->root(rootTiles_, static_cast<std::uint32_t>(counts_.uppers)));
  }

  std::uint64_t bytesOf(const NodeBytes& bytes) const {
    return bytes.of(counts_.uppers, counts_.lowers, counts_.leaves);
  }

  /// Makes a result of every node of the first grid's topology, in order.
  template <class Make>
  void readTopology(const Make& make, const ProgressShare& share) {
    BitTopology topology(output_.file(), grids_.front().topologyAt, *grids_.front().codec,
                         counts_.uppers);
    std::uint64_t done = 0;
    using Piece = std::shared_ptr<BitTopology::Piece>;
    makeInOrder<Piece, std::string>(
        [&](Piece& piece) {
          piece = std::make_shared<BitTopology::Piece>();
          return topology.next(*piece);
        },
        [&](const Piece& piece) { return make(*piece); },
        [&](const std::string& bytes) {
          output_.write(bytes);
          share.update(double(++done) / double(counts_.uppers + counts_.lowers));
        });
  }

  void topologyAgain(FileGrid& grid, const ProgressShare& share) {
    readTopology(
        [&](const BitTopology::Piece& piece) {
          if (piece.upper)
            return grid.codec->upper(piece.origin, *piece.upper);
          std::string bytes;
          grid.codec->addLower(piece.node, bytes);
          return bytes;
        },
        share);
  }

  void buffers(const FileGrid& grid, const ProgressShare& share) {
    readTopology(
        [&](const BitTopology::Piece& piece) {
          std::string bytes;
          if (!piece.upper)
            grid.codec->addBuffers(piece.origin, piece.node, bytes);
          return bytes;
        },
        share);
  }

  std::string folder() const {
    const std::string& path = output_.file().path();
    const std::size_t slash = path.rfind('/');
    return slash == std::string::npos ? "." : path.substr(0, slash + 1);
  }

  VdbOutput& output_;
  BitVdbOptions options_;
  std::vector<FileGrid> grids_;
  std::vector<Vec3i> rootTiles_;
  Counts counts_;
  std::mutex knownMutex_;
  VoxelBounds known_;  ///< of what was written
  bool keeps_ = false; ///< whether the entries file_delayed_load may come
  std::vector<std::uint16_t> leafCounts_;
  std::unique_ptr<Spool> kept_ = std::make_unique<Spool>(folder(), options_.spoolBytes);
};

} // namespace

BitVdbWriter::BitVdbWriter(std::string path, std::map<std::string, std::string> metadata,
                           openvdb::GridPtrVec grids, const BitVdbOptions& options)
    : path_(std::move(path)), metadata_(std::move(metadata)), grids_(std::move(grids)),
      options_(options) {
  initializeOpenVDB();
  std::set<std::string> names;
  for (const auto& grid : grids_)
    if (!names.insert(grid->getName()).second || grid->getName().empty())
      throw Error(Status::Usage, path_,
                  "grid names must be unique and not empty: '" + grid->getName() + "'");
  output_ = std::make_unique<VdbOutput>(path_, metadata_, grids_.size() + options_.moreGrids);
}

std::vector<GridInfo> BitVdbWriter::write(BitSource& source, Progress& progress,
                                          const std::function<openvdb::GridPtrVec()>& more) {
  const ProgressShare whole(progress, 0, 1);
  std::optional<Writing> writing;
  writing.emplace(*output_, grids_, options_, source.cubes());
  writing->topology(source, whole.part(0, 0.6));
  std::optional<OpenedSource> opened;
  if (const Counts& counts = writing->counts();
      options_.openFirstTile && counts.leaves == 0 && counts.firstTile) {
    opened.emplace(source, *counts.firstTile);
    writing.reset();
    output_.reset(); // what was written goes
    output_ = std::make_unique<VdbOutput>(path_, metadata_, grids_.size() + options_.moreGrids);
    writing.emplace(*output_, grids_, options_, opened->cubes());
    writing->topology(*opened, whole.part(0, 0.6));
  }
  Volume others; // before the rest, which takes long: a limit may be met here
  if (options_.moreGrids > 0)
    others.grids().all = more();
  writing->rest(whole.part(0.6, 1));
  std::vector<GridInfo> infos = writing->describeGrids();
  writeGrids(*output_, others.grids().all, whole.part(1, 1));
  for (GridInfo& info : describe(others))
    infos.push_back(std::move(info));
  return infos;
}

void BitVdbWriter::commit(Progress& progress) {
  output_->commit(progress);
}

} // namespace tetvdb
