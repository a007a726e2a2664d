// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/TileFolder.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/geometry/NodeIndex.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/volume/AddCounts.h"
#include "tetvdb/io/volume/StoredNodes.h"
#include "tetvdb/io/volume/TileSpools.h"
#include "tetvdb/io/volume/TileTree.h"
#include "tetvdb/io/volume/VdbOutput.h"
#include "tetvdb/volume/BitLevels.h"
#include "tetvdb/volume/GridLevels.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>
#include <unistd.h>
#include <utility>
#include <xxhash.h>

namespace tetvdb {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kIndex = "tiles.json";
constexpr std::string_view kStem = "tile_";
constexpr std::string_view kEnding = ".vdb";
constexpr std::size_t kInMemory = std::size_t(32) << 20;

bool isTileFile(const std::string& name) {
  const std::size_t around = kStem.size() + kEnding.size();
  return name.size() > around && name.compare(0, kStem.size(), kStem) == 0 &&
         name.compare(name.size() - kEnding.size(), kEnding.size(), kEnding) == 0 &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(kStem.size()),
                     name.end() - static_cast<std::ptrdiff_t>(kEnding.size()),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

AtomicFolder::Contents contents() {
  return {"volume tiles", kIndex, isTileFile};
}

void checkSize(int size) {
  if (size != 512 && size != 1024 && size != 2048 && size != kRootChildSize)
    throw Error(Status::Usage, "`tile_size`", fmt::format("is {}", size),
                "choose 512, 1024, 2048 or 4096");
}

void checkSize(int size, const LevelRange& levels) {
  if (!levels.isEmpty() && (1 << levels.last) > size)
    throw Error(Status::Usage, "`lod`",
                fmt::format("a voxel of level {} is {} voxels long, and tiles are cubes of {}",
                            levels.last, 1 << levels.last, size),
                "end with a finer level, or choose a larger `tile_size`");
}

/// The grid without voxels; the tree's statistics are those of another one.
openvdb::GridBase::Ptr emptied(const openvdb::GridBase& grid) {
  openvdb::GridBase::Ptr copy;
  if (!withKnownGrid(grid, [&](const auto& typed) { copy = emptyLike(typed); }))
    throw Error(Status::Usage, grid.getName(),
                "grids of type " + grid.type() + " are not supported");
  return copy;
}

/// 32 digits, as the program xxh128sum prints them, and the size.
std::pair<std::string, std::uint64_t> hashOfFile(const std::string& path) {
  const auto fail = [&] {
    throw Error(Status::Write, path, std::string("cannot be read back: ") + std::strerror(errno));
  };
  struct File {
    int descriptor;
    ~File() { ::close(descriptor); }
  };
  const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.descriptor < 0)
    fail();
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  if (!state)
    throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  std::vector<char> bytes(std::size_t(1) << 20);
  std::uint64_t size = 0;
  for (;;) {
    const ssize_t n = ::read(file.descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0)
      fail();
    if (n == 0)
      break;
    XXH3_128bits_update(state.get(), bytes.data(), static_cast<std::size_t>(n));
    size += static_cast<std::uint64_t>(n);
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return {fmt::format("{:016x}{:016x}", hash.high64, hash.low64), size};
}

std::vector<GridInfo> describeAll(const openvdb::GridPtrVec& grids) {
  Volume volume;
  volume.grids().all = grids;
  return describe(volume);
}

Json boxOf(const Vec3i& min, const Vec3i& max) {
  return {{"min", min}, {"max", max}};
}

Json activeOf(const GridInfo& grid) {
  Json json{{"active_voxels", grid.activeVoxels}};
  const bool any = grid.activeVoxels > 0;
  json["min"] = any ? Json(grid.minValue) : Json();
  json["max"] = any ? Json(grid.maxValue) : Json();
  json["box"] = any ? boxOf(grid.boxMin, grid.boxMax) : Json();
  return json;
}

/// Takes index space to world space: rows of a 4x4 matrix for columns; OpenVDB's is for rows. -0
/// becomes 0.
Json matrixOf(const openvdb::math::Transform& transform) {
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getConstMat4();
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({m(0, row) + 0.0, m(1, row) + 0.0, m(2, row) + 0.0, m(3, row) + 0.0});
  return rows;
}

/// Runs work(); errors name the folder that was asked for, not the temporary one.
template <class Work>
void naming(const AtomicFolder& folder, const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    std::string text = error.what();
    const std::size_t at = text.find(folder.temporary());
    if (at == std::string::npos)
      throw;
    throw Error(error.status(), "", text.replace(at, folder.temporary().size(), folder.target()));
  }
}

/// One child of the root node of another source.
class OneCube : public BitSource {
public:
  OneCube(BitSource& source, std::size_t cube)
      : source_(source), cube_(cube), cubes_{source.cubes()[cube]} {}
  const std::vector<RootCube>& cubes() const override { return cubes_; }
  std::vector<int> begin(std::size_t) override { return source_.begin(cube_); }
  void fill(int stack, BitStack& out) override { source_.fill(stack, out); }

private:
  BitSource& source_;
  std::size_t cube_;
  std::vector<RootCube> cubes_;
};

/// The boxes, each cut where a layer of `nodes` nodes ends.
std::vector<NodeBox> inLayers(const std::vector<NodeBox>& boxes, std::int32_t nodes) {
  std::vector<NodeBox> cut;
  for (NodeBox rest : boxes)
    while (rest.low[0] < rest.high[0]) {
      NodeBox own = rest;
      own.high[0] = std::min(rest.high[0], (rest.low[0] & ~(nodes - 1)) + nodes);
      cut.push_back(own);
      rest.low[0] = own.high[0];
    }
  return cut;
}

/// Calls work(origin) for the cubes of a child of the root node, by x, then y, then z.
template <class Work>
void forCubes(const openvdb::Coord& origin, std::int32_t size, const Work& work) {
  for (std::int32_t x = 0; x < kRootChildSize; x += size)
    for (std::int32_t y = 0; y < kRootChildSize; y += size)
      for (std::int32_t z = 0; z < kRootChildSize; z += size)
        work(openvdb::Coord(origin.x() + x, origin.y() + y, origin.z() + z));
}

} // namespace

void checkTileFiles(const std::string& folder, int size, const LevelRange& levels) {
  checkSize(size);
  checkSize(size, levels);
  const AtomicFolder probe(folder, contents());
}

TileFolder::TileFolder(const std::string& folder, int size,
                       std::map<std::string, std::string> metadata,
                       const openvdb::GridPtrVec& grids, const TileLevels& levels)
    : size_(size), metadata_(std::move(metadata)), levels_(levels), own_(grids.size()),
      folder_(folder, contents()) {
  initializeOpenVDB();
  checkSize(size);
  checkSize(size, levels.range);
  for (const auto& grid : grids) {
    if (!grid->transform().isLinear() ||
        canonicalBytes(grid->transform()) != canonicalBytes(grids.front()->transform()))
      throw Error(Status::Usage, grid->getName(),
                  "has another transform than the first grid, or one that is not linear: tiles "
                  "are cubes of one index space",
                  "choose grids of one transform with `grid`");
    empty_.push_back(emptied(*grid));
  }
  if (!levels.range.isEmpty()) {
    if (levels.maxMemory == 0)
      levels_.maxMemory = availableBytes();
    Volume volume;
    volume.grids().all = empty_;
    Progress none;
    addLevels(volume, levels.range, levels_.maxMemory, none);
    empty_ = volume.grids().all;
  }
  std::set<std::string> names;
  for (const auto& grid : empty_)
    if (grid->getName().empty() || !names.insert(grid->getName()).second)
      throw Error(Status::Usage, folder,
                  "grid names must be unique and not empty: '" + grid->getName() + "'");
  grids_ = describeAll(empty_);
}

void TileFolder::requireRoom(std::size_t files) const {
  if (files > kMaxTileFiles)
    throw Error(Status::Limit, folder_.target(),
                fmt::format("would hold more than {} files", kMaxTileFiles),
                "choose a larger `tile_size`");
}

std::string TileFolder::nextPath() const {
  requireRoom(files_.size() + 1);
  return fmt::format("{}/{}{}{}", folder_.temporary(), kStem, files_.size(), kEnding);
}

void TileFolder::finish(const Vec3i& origin, std::vector<GridInfo> infos) {
  const std::string path = nextPath();
  File& file = files_.emplace_back();
  file.name = path.substr(path.rfind('/') + 1);
  file.origin = origin;
  std::tie(file.hash, file.bytes) = hashOfFile(path);
  const std::vector<GridInfo> bases = describeAll(empty_);
  for (std::size_t g = 0; g < infos.size(); ++g)
    addCounts(infos[g], bases[g], grids_[g]);
  file.grids = std::move(infos);
}

void TileFolder::add(BitSource& source, const BitVdbOptions& options, Progress& progress) {
  const std::size_t cubes = source.cubes().size();
  const auto across = static_cast<std::size_t>(kRootChildSize / size_);
  std::size_t full = 0;
  for (const RootCube& cube : source.cubes())
    full += cube.full ? across * across * across : 0;
  requireRoom(full);
  for (std::size_t c = 0; c < cubes; ++c) {
    progress.update(double(c) / double(cubes));
    const Vec3i origin = source.cubes()[c].origin;
    if (size_ == kRootChildSize) {
      OneCube one(source, c);
      naming(folder_, [&] { addCube(one, origin, options, progress); });
      continue;
    }
    const StoredNodes nodes(source, c, folder_.temporary(), kInMemory, progress);
    forCubes(openvdb::Coord(origin.data()), size_, [&](const openvdb::Coord& corner) {
      const Vec3i at{corner.x(), corner.y(), corner.z()};
      StoredNodes::Part part(nodes, at, size_);
      if (!part.isEmpty())
        naming(folder_, [&] { addCube(part, at, options, progress); });
    });
  }
}

/// Files of which the cubes have the same x.
class TileFolder::Layer {
public:
  Layer(TileFolder& folder, const openvdb::Coord& corner, std::size_t inMemory, bool exact)
      : folder_(folder), own_(folder.empty_.begin(),
                              folder.empty_.begin() + static_cast<std::ptrdiff_t>(folder.own_)),
        spools_(own_, corner, folder.size_, optionsOf(folder, inMemory, exact)) {
    const TileLevels& levels = folder.levels_;
    for (std::size_t g = 0; g < own_.size() && !levels.range.isEmpty(); ++g)
      levels_.push_back(makeGridLevels(own_[g], levels.range, levels.maxMemory / own_.size()));
  }

  void add(const openvdb::GridPtrVec& parts, const NodeBox& box, Progress& progress) {
    for (std::size_t g = 0; g < levels_.size(); ++g)
      levels_[g]->add(*parts[g], progress);
    spools_.add(parts, box);
  }

  void write(Progress& progress) {
    openvdb::GridPtrVec coarser;
    for (auto& levels : levels_) {
      const openvdb::GridPtrVec made = levels->finish();
      coarser.insert(coarser.end(), made.begin(), made.end());
      levels.reset();
    }
    QuietProgress within(progress);
    const ProgressShare share(within, 0, 1);
    spools_.finish([&](const openvdb::Coord& corner, TileSpools::Spools& spools) {
      progress.check();
      VdbOutput output(folder_.nextPath(), folder_.metadata_, folder_.empty_.size());
      std::vector<GridInfo> infos;
      for (auto& spool : spools) {
        spool->writeTo(output, share);
        infos.push_back(spool->describe());
        spool.reset();
      }
      Volume levels;
      levels.grids().all = cutLevels(coarser, corner);
      writeGrids(output, levels.grids().all, share);
      for (GridInfo& info : describe(levels))
        infos.push_back(std::move(info));
      output.commit(within);
      folder_.finish({corner.x(), corner.y(), corner.z()}, std::move(infos));
    });
  }

private:
  static SpoolOptions optionsOf(const TileFolder& folder, std::size_t inMemory, bool exact) {
    SpoolOptions options;
    options.folder = folder.folder_.temporary();
    options.inMemory = inMemory;
    options.exact = exact;
    return options;
  }

  using LevelGrids = openvdb::TypeList<openvdb::FloatGrid, openvdb::Vec3SGrid>;

  /// What the levels, those of the first grid before those of the next, have in a file's cube.
  openvdb::GridPtrVec cutLevels(const openvdb::GridPtrVec& levels,
                                const openvdb::Coord& corner) const {
    openvdb::GridPtrVec cut;
    const LevelRange& range = folder_.levels_.range;
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const int k = range.first + static_cast<int>(i % range.size());
      std::as_const(*levels[i]).apply<LevelGrids>([&](const auto& level) {
        const auto own = emptyLike(level);
        copyActive(level, corner >> static_cast<std::size_t>(k), folder_.size_ >> k, *own);
        openFirstTile(*own);
        cut.push_back(own);
      });
    }
    return cut;
  }

  TileFolder& folder_;
  openvdb::GridPtrVec own_; ///< without voxels
  TileSpools spools_;
  std::vector<std::unique_ptr<GridLevels>> levels_; ///< by grid
};

void TileFolder::add(const openvdb::GridPtrVec& parts, const openvdb::Coord& origin,
                     Progress& progress) {
  for (std::int32_t x = 0; x < kRootChildSize; x += size_) {
    const openvdb::Coord corner = origin.offsetBy(x, 0, 0);
    const NodeBox box = nodesOf(corner, openvdb::Coord(size_, kRootChildSize, kRootChildSize));
    openvdb::GridPtrVec copies;
    for (std::size_t g = 0; g < parts.size(); ++g)
      withKnownGrid(*empty_[g], [&](const auto& empty) {
        using GridT = std::decay_t<decltype(empty)>;
        const auto copy = emptyLike(empty);
        copyNodes(static_cast<const GridT&>(*parts[g]), box, *copy);
        copies.push_back(copy);
      });
    naming(folder_, [&] {
      Layer layer(*this, corner, kInMemory, /*exact=*/true);
      layer.add(copies, box, progress);
      copies.clear();
      layer.write(progress);
    });
  }
}

void TileFolder::add(TreeSource& source, std::size_t inMemory, const ProgressShare& share,
                     Progress& progress) {
  QuietProgress within(progress);
  source.begin();
  const std::size_t cubes = source.cubes().size();
  for (std::size_t c = 0; c < cubes; ++c) {
    const Vec3i& origin = source.cubes()[c];
    std::optional<Layer> layer;
    std::int32_t layerAt = 0;
    const std::vector<NodeBox> parts = inLayers(source.parts(c), size_ / kNodeSize);
    naming(folder_, [&] {
      for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::int32_t x = parts[p].low[0] * kNodeSize & ~(size_ - 1);
        if (layer && layerAt != x) {
          layer->write(progress);
          layer.reset();
        }
        if (!layer)
          layer.emplace(*this, openvdb::Coord(x, origin[1], origin[2]), inMemory, /*exact=*/false);
        layerAt = x;
        layer->add(source.make(parts[p], within), parts[p], within);
        share.update((double(c) + double(p + 1) / double(parts.size())) / double(cubes));
      }
      if (layer)
        layer->write(progress);
    });
  }
}

void TileFolder::addCube(BitSource& source, const Vec3i& origin, const BitVdbOptions& options,
                         Progress& progress) {
  QuietProgress within(progress);
  openvdb::GridPtrVec grids;
  for (std::size_t g = 0; g < own_; ++g)
    grids.push_back(emptied(*empty_[g]));
  BitVdbOptions own = options;
  std::optional<BitLevels> levels;
  if (!levels_.range.isEmpty()) {
    levels.emplace(source, levels_.range, levels_.maxMemory / own_);
    own.moreGrids = empty_.size() - own_;
  }
  BitVdbWriter writer(nextPath(), metadata_, grids, own);
  BitSource& passed = levels ? static_cast<BitSource&>(*levels) : source;
  std::vector<GridInfo> infos = writer.write(passed, within, [&] {
    openvdb::GridPtrVec coarser = levels->finish(grids);
    for (const auto& grid : coarser)
      openFirstTile(*grid);
    return coarser;
  });
  if (infos.front().activeVoxels == 0)
    return;
  writer.commit(within);
  finish(origin, std::move(infos));
}

std::string TileFolder::index() const {
  Json grids = Json::array(), files = Json::array();
  for (std::size_t g = 0; g < grids_.size(); ++g) {
    const GridInfo& grid = grids_[g];
    Json one{{"name", grid.name}, {"type", grid.type}, {"class", grid.gridClass}};
    one["voxel_size"] = grid.transform.voxelSize;
    one["index_to_world"] = matrixOf(empty_[g]->transform());
    one.update(activeOf(grid));
    grids.push_back(std::move(one));
  }
  for (const File& file : files_) {
    Json own = Json::array();
    for (const GridInfo& grid : file.grids) {
      Json one{{"name", grid.name}};
      one.update(activeOf(grid));
      own.push_back(std::move(one));
    }
    const Vec3i last{file.origin[0] + size_ - 1, file.origin[1] + size_ - 1,
                     file.origin[2] + size_ - 1};
    files.push_back({{"file", file.name},
                     {"box", boxOf(file.origin, last)},
                     {"grids", std::move(own)},
                     {"bytes", file.bytes},
                     {"xxh128", file.hash}});
  }
  const Json all{{"tiles_version", 1},
                 {"creator", std::string("TetVDB ") + version()},
                 {"tile_size", size_},
                 {"grids", std::move(grids)},
                 {"tiles", std::move(files)}};
  return all.dump(1) + "\n";
}

TileFilesInfo TileFolder::commit(Progress& progress) {
  progress.check();
  const std::string text = index();
  AtomicFile file(folder_.temporary() + "/" + kIndex);
  file.write(text.data(), text.size());
  file.commit();
  TileFilesInfo info;
  info.grids = grids_;
  info.files = files_.size();
  info.bytes = text.size();
  for (const File& one : files_)
    info.bytes += one.bytes;
  folder_.commit();
  return info;
}

TileFilesInfo writeTileFiles(const std::string& folder, int size, const Volume& volume,
                             Progress& progress, const TileLevels& levels) {
  const openvdb::GridPtrVec& grids = volume.grids().all;
  TileFolder tiles(folder, size, volume.metadata, grids, levels);
  const std::vector<openvdb::Coord> origins = rootOrigins(grids);
  for (std::size_t i = 0; i < origins.size(); ++i) {
    progress.update(double(i) / double(origins.size()));
    tiles.add(grids, origins[i], progress);
  }
  return tiles.commit(progress);
}

} // namespace tetvdb
