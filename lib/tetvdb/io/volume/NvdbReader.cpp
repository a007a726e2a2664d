// SPDX-License-Identifier: Apache-2.0
//
// NanoVDB's own reader trusts what a file says. Here the container is parsed against the file's
// size, and every offset of a grid against its buffer, before it is followed.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/text/ZlibBytes.h"
#include "tetvdb/io/volume/NvdbLayout.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <algorithm>
#include <blosc.h>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <tbb/parallel_for.h>
#include <vector>
#include <zlib.h>

namespace tetvdb {
namespace {

struct FreeAligned {
  void operator()(unsigned char* bytes) const { std::free(bytes); }
};
using Buffer = std::unique_ptr<unsigned char[], FreeAligned>;

constexpr std::size_t kAlignment = 32;

Buffer allocate(std::uint64_t size) {
  const std::uint64_t rounded = (size + kAlignment - 1) / kAlignment * kAlignment;
  Buffer buffer(static_cast<unsigned char*>(std::aligned_alloc(kAlignment, rounded)));
  if (!buffer)
    throw std::bad_alloc();
  return buffer;
}

/// A cursor over the file's bytes.
class Cursor {
public:
  Cursor(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}
  bool atEnd() const { return position_ == bytes_.size(); }
  std::size_t left() const { return bytes_.size() - position_; }
  const char* take(std::uint64_t size, const char* what) {
    if (size > left())
      fail(std::string("ends within ") + what);
    const char* at = bytes_.data() + position_;
    position_ += static_cast<std::size_t>(size);
    return at;
  }
  template <class T>
  T value(const char* what) {
    T result;
    std::memcpy(&result, take(sizeof result, what), sizeof result);
    return result;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(Status::Invalid, path_, what + " (byte " + std::to_string(position_) + ")",
                "the file is cut or damaged; write it again");
  }

private:
  std::string_view bytes_;
  const std::string& path_;
  std::size_t position_ = 0;
};

Buffer readBuffer(Cursor& cursor, std::uint64_t size, NvdbCodec codec) {
  // The largest ratios that the compressors can reach. A file that states more is damaged.
  const std::uint64_t ratio = codec == NvdbCodec::Zip ? 1100 : codec == NvdbCodec::Blosc ? 300 : 1;
  if (size < sizeof(NvdbGrid) || size / ratio > cursor.left())
    cursor.fail("a grid's size is impossible");
  Buffer buffer = allocate(size);
  switch (codec) {
  case NvdbCodec::None:
    std::memcpy(buffer.get(), cursor.take(size, "a grid"), size);
    break;
  case NvdbCodec::Zip: {
    const auto packed = cursor.value<std::uint64_t>("a grid");
    const char* from = cursor.take(packed, "a grid");
    uLongf unpacked = size;
    if (::uncompress(buffer.get(), &unpacked, reinterpret_cast<const Bytef*>(from), packed) !=
            Z_OK ||
        unpacked != size)
      cursor.fail("a compressed grid is damaged");
    break;
  }
  case NvdbCodec::Blosc:
    for (std::uint64_t done = 0; done < size;) {
      const std::uint64_t chunk = std::min(size - done, kNvdbChunk);
      const auto packed = cursor.value<std::uint64_t>("a grid");
      const char* from = cursor.take(packed, "a grid");
      std::size_t claimed = 0;
      if (blosc_cbuffer_validate(from, packed, &claimed) < 0 || claimed != chunk ||
          blosc_decompress_ctx(from, buffer.get() + done, chunk, 1) != static_cast<int>(chunk))
        cursor.fail("a compressed grid is damaged");
      done += chunk;
    }
    break;
  default:
    cursor.fail("unknown compression");
  }
  return buffer;
}

template <class BuildT>
struct OpenValue { // the source of OpenVDB's tree
  using Type = BuildT;
};
template <>
struct OpenValue<nanovdb::Vec3f> {
  using Type = openvdb::Vec3s;
};
template <>
struct OpenValue<nanovdb::ValueMask> {
  using Type = openvdb::ValueMask;
};

/// NanoVDB's checksum: one CRC-32 of grid, tree and root (`headSize` bytes), one of the CRC-32 of
/// every node, top level first. The second may be missing, or both. `nodes` are offsets by level.
bool checksumMatches(const unsigned char* bytes, std::uint64_t headSize,
                     const std::vector<std::uint64_t> (&nodes)[3],
                     const std::uint64_t (&sizes)[3]) {
  constexpr std::uint32_t absent = 0xFFFFFFFF;
  NvdbGrid header;
  std::memcpy(&header, bytes, sizeof header);
  // Newer minor versions of NanoVDB may compute it in another way.
  if ((header.version >> 10 & 0x7FF) != NANOVDB_MINOR_VERSION_NUMBER)
    return true;
  const auto head = static_cast<std::uint32_t>(header.checksum);
  const auto tail = static_cast<std::uint32_t>(header.checksum >> 32);
  if (head == absent && tail == absent)
    return true;
  constexpr std::uint64_t skipped = 16; // magic and checksum
  if (crc32Of(bytes + skipped, headSize - skipped) != head)
    return false;
  if (tail == absent)
    return true;
  std::vector<std::uint64_t> sums(nodes[0].size() + nodes[1].size() + nodes[2].size());
  std::size_t first = 0;
  for (int level = 2; level >= 0; --level) {
    tbb::parallel_for(std::size_t(0), nodes[level].size(), [&](std::size_t i) {
      sums[first + i] = crc32Of(bytes + nodes[level][i], sizes[level]);
    });
    first += nodes[level].size();
  }
  return sums.empty() || crc32Of(sums.data(), sums.size() * sizeof sums[0]) == tail;
}

/// One grid's buffer, checked and turned into OpenVDB's nodes.
template <class BuildT>
class NanoReader {
  using NanoGrid = nanovdb::NanoGrid<BuildT>;
  using NanoRoot = nanovdb::NanoRoot<BuildT>;
  using NanoUpper = nanovdb::NanoUpper<BuildT>;
  using NanoLower = nanovdb::NanoLower<BuildT>;
  using NanoLeaf = nanovdb::NanoLeaf<BuildT>;

  using Grid = openvdb::Grid<typename openvdb::tree::Tree4<typename OpenValue<BuildT>::Type>::Type>;
  using Tree = typename Grid::TreeType;
  using T = typename Tree::ValueType;
  using Upper = typename Tree::RootNodeType::ChildNodeType;
  using Lower = typename Upper::ChildNodeType;
  using Leaf = typename Tree::LeafNodeType;

public:
  NanoReader(const unsigned char* bytes, std::uint64_t size, const Cursor& cursor)
      : bytes_(bytes), size_(size), cursor_(cursor) {
    std::memcpy(&header_, bytes, sizeof header_);
  }

  openvdb::GridBase::Ptr read() {
    check();
    const auto* root = at<NanoRoot>(rootAt_);
    auto grid = Grid::create(value(root->background()));
    auto& table = grid->tree().root();

    struct Job {
      const NanoUpper* from;
      Upper* to;
      openvdb::Index entry;
    };
    std::vector<Job> jobs;
    const auto* data = rootData();
    for (std::uint32_t i = 0; i < data->mTableSize; ++i) {
      const auto* tile = data->tile(i);
      const nanovdb::Coord key = std::decay_t<decltype(*data)>::KeyToCoord(tile->key);
      const openvdb::Coord origin(key[0] & ~0xFFF, key[1] & ~0xFFF, key[2] & ~0xFFF);
      if (table.getValueDepth(origin) >= 0)
        cursor_.fail("two root entries have the same place");
      if (tile->child == 0) {
        table.addTile(origin, value(tile->value), tile->state != 0);
        continue;
      }
      const auto* from = at<NanoUpper>(rootAt_ + static_cast<std::uint64_t>(tile->child));
      auto* to = new Upper(origin, grid->background(), false);
      table.addChild(to);
      const auto* node = dataOf(from);
      for (openvdb::Index n = 0; n < Upper::NUM_VALUES; ++n) {
        if (node->mChildMask.isOn(n))
          jobs.push_back({from, to, n});
        else
          to->addTile(n, value(node->mTable[n].value), node->mValueMask.isOn(n));
      }
    }
    std::vector<std::unique_ptr<Lower>> lowers(jobs.size());
    tbb::parallel_for(std::size_t(0), jobs.size(), [&](std::size_t i) {
      const Job& job = jobs[i];
      lowers[i] = makeLower(*dataOf(dataOf(job.from)->getChild(job.entry)),
                            job.to->offsetToGlobalCoord(job.entry), grid->background());
    });
    for (std::size_t i = 0; i < jobs.size(); ++i)
      jobs[i].to->addChild(lowers[i].release());
    setHeader(*grid);
    return grid;
  }

private:
  template <class Node>
  const Node* at(std::uint64_t offset) const {
    return reinterpret_cast<const Node*>(bytes_ + offset);
  }
  template <class Node>
  static const typename Node::DataType* dataOf(const Node* node) {
    return reinterpret_cast<const typename Node::DataType*>(node);
  }
  const typename NanoRoot::DataType* rootData() const {
    return at<typename NanoRoot::DataType>(rootAt_);
  }
  template <class V>
  static T value(const V& nano) {
    if constexpr (std::is_same<V, nanovdb::Vec3f>::value)
      return T(nano[0], nano[1], nano[2]);
    else if constexpr (std::is_same<V, bool>::value)
      return *reinterpret_cast<const unsigned char*>(&nano) != 0; // any byte of the file
    else
      return T(nano);
  }

  /// Offset of a node that lies `distance` from the one at `from`; throws unless it is within the
  /// buffer.
  std::uint64_t child(std::uint64_t from, std::int64_t distance, std::uint64_t size) const {
    const std::uint64_t to = from + static_cast<std::uint64_t>(distance);
    if (to % kAlignment != 0 || to < first_ || to > size_ || size > size_ - to)
      cursor_.fail("a node lies outside its grid");
    return to;
  }

  /// Checks that all offsets that the conversion and the checksum follow lie within the buffer.
  void check() {
    const std::uint64_t rootOffset = header_.nodeOffset[3];
    const std::uint64_t room = size_ - kNvdbTreeAt;
    if (rootOffset % kAlignment != 0 || rootOffset < 64 || rootOffset > room ||
        sizeof(typename NanoRoot::DataType) > room - rootOffset)
      cursor_.fail("the root node lies outside its grid");
    rootAt_ = kNvdbTreeAt + rootOffset;
    using Tile = std::decay_t<decltype(*rootData()->tile(0))>;
    first_ = rootAt_ + sizeof(typename NanoRoot::DataType);
    const std::uint64_t tiles = rootData()->mTableSize;
    if (tiles > (size_ - first_) / sizeof(Tile))
      cursor_.fail("the root node lies outside its grid");
    first_ += tiles * sizeof(Tile);

    // A node that is used twice would let a small file grow without bound: nodes of a level cannot
    // be more than fit into the file, nor other than the tree says.
    const std::uint64_t sizes[3] = {sizeof(NanoLeaf), sizeof(NanoLower), sizeof(NanoUpper)};
    std::vector<std::uint64_t> nodes[3]; // leaves, lower, upper nodes
    const auto add = [&](int level, std::uint64_t offset) {
      if (nodes[level].size() == header_.nodeCount[level] ||
          nodes[level].size() >= size_ / sizes[level])
        cursor_.fail("there are more nodes than announced");
      nodes[level].push_back(offset);
    };
    for (std::uint32_t i = 0; i < tiles; ++i) {
      const auto* tile = rootData()->tile(i);
      if (tile->child == 0)
        continue;
      const std::uint64_t upperAt = child(rootAt_, tile->child, sizeof(NanoUpper));
      add(2, upperAt);
      const auto* upper = dataOf(at<NanoUpper>(upperAt));
      for (std::uint32_t n = 0; n < NanoUpper::SIZE; ++n) {
        if (!upper->mChildMask.isOn(n))
          continue;
        const std::uint64_t lowerAt = child(upperAt, upper->mTable[n].child, sizeof(NanoLower));
        add(1, lowerAt);
        const auto* lower = dataOf(at<NanoLower>(lowerAt));
        for (std::uint32_t m = 0; m < NanoLower::SIZE; ++m) {
          if (!lower->mChildMask.isOn(m))
            continue;
          add(0, child(lowerAt, lower->mTable[m].child, sizeof(NanoLeaf)));
        }
      }
    }
    for (int level = 0; level < 3; ++level)
      if (nodes[level].size() != header_.nodeCount[level])
        cursor_.fail("nodes are missing");
    if (!checksumMatches(bytes_, first_ - rootOffset + 64, nodes, sizes))
      cursor_.fail("the checksum of grid '" + name() + "' does not match");
  }

  std::unique_ptr<Lower> makeLower(const typename NanoLower::DataType& node,
                                   const openvdb::Coord& origin, const T& background) const {
    auto lower = std::make_unique<Lower>(origin, background, false);
    for (openvdb::Index n = 0; n < Lower::NUM_VALUES; ++n) {
      if (!node.mChildMask.isOn(n)) {
        lower->addTile(n, value(node.mTable[n].value), node.mValueMask.isOn(n));
        continue;
      }
      const NanoLeaf& from = *node.getChild(n);
      auto* leaf = new Leaf(lower->offsetToGlobalCoord(n), background, false);
      lower->addLeaf(leaf);
      for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
        if constexpr (std::is_same<BuildT, nanovdb::ValueMask>::value) {
          if (dataOf(&from)->mValueMask.isOn(i))
            leaf->setValueOn(i);
        } else {
          leaf->setValueOnly(i, value(dataOf(&from)->getValue(i)));
          leaf->setActiveState(i, dataOf(&from)->mValueMask.isOn(i));
        }
      }
    }
    return lower;
  }

  std::string name() const { return {header_.name, ::strnlen(header_.name, sizeof header_.name)}; }

  void setHeader(Grid& grid) const {
    grid.setName(name());
    switch (header_.gridClass) {
    case 1:
      grid.setGridClass(openvdb::GRID_LEVEL_SET);
      break;
    case 2:
      grid.setGridClass(openvdb::GRID_FOG_VOLUME);
      break;
    case 3:
      grid.setGridClass(openvdb::GRID_STAGGERED);
      break;
    default:
      break;
    }
    // The matrix as the file has it; NanoVDB's converters before 12.0.1 lose rotations.
    const double* m = header_.matrix;
    bool diagonal = true;
    for (int i = 0; i < 9; ++i) {
      if (!std::isfinite(m[i]))
        cursor_.fail("the transform is not finite");
      if (i % 4 != 0 && m[i] != 0)
        diagonal = false;
    }
    const double* t = header_.translation;
    if (diagonal && m[0] > 0 && m[4] > 0 && m[8] > 0) {
      grid.setTransform(makeTransform({{m[0], m[4], m[8]}, {t[0], t[1], t[2]}}));
    } else {
      // OpenVDB multiplies row vectors from the left, NanoVDB column vectors from the right.
      const openvdb::Mat4d matrix(m[0], m[3], m[6], 0., m[1], m[4], m[7], 0., m[2], m[5], m[8], 0.,
                                  t[0], t[1], t[2], 1.);
      grid.setTransform(openvdb::math::Transform::createLinearTransform(matrix));
    }
  }

  const unsigned char* bytes_;
  std::uint64_t size_;
  const Cursor& cursor_;
  NvdbGrid header_;
  std::uint64_t rootAt_ = 0;
  std::uint64_t first_ = 0; ///< where nodes may begin
};

openvdb::GridBase::Ptr readGrid(Cursor& cursor, const NvdbEntry& entry, NvdbCodec codec) {
  const Buffer buffer = readBuffer(cursor, entry.gridSize, codec);
  NvdbGrid header;
  std::memcpy(&header, buffer.get(), sizeof header);
  if ((header.magic != kNvdbMagic && header.magic != kNvdbGridMagic) ||
      header.gridSize != entry.gridSize || header.version >> 21 != NANOVDB_MAJOR_VERSION_NUMBER)
    cursor.fail("is not a grid of NanoVDB " + std::to_string(NANOVDB_MAJOR_VERSION_NUMBER));
  const auto read = [&](auto build) {
    return NanoReader<decltype(build)>(buffer.get(), entry.gridSize, cursor).read();
  };
  switch (header.gridType) {
  case 1:
    return read(float());
  case 2:
    return read(double());
  case 4:
    return read(std::int32_t());
  case 5:
    return read(std::int64_t());
  case 6:
    return read(nanovdb::Vec3f());
  case 8:
    return read(nanovdb::ValueMask());
  case 11:
    return read(bool());
  default:
    cursor.fail("a grid's type (" + std::to_string(header.gridType) + ") is not supported");
  }
}

} // namespace

Volume readNvdb(const std::string& path, Progress& progress) {
  initializeOpenVDB();
  const MappedFile file(path);
  Cursor cursor(file.bytes(), path);
  Volume volume;
  try {
    while (!cursor.atEnd()) {
      const auto header = cursor.value<NvdbHeader>("a header");
      if (header.magic != kNvdbMagic && header.magic != kNvdbFileMagic)
        cursor.fail("is not a .nvdb file");
      std::vector<NvdbEntry> entries;
      for (int i = 0; i < header.gridCount; ++i) {
        entries.push_back(cursor.value<NvdbEntry>("the list of grids"));
        cursor.take(entries.back().nameSize, "a grid's name");
      }
      for (const NvdbEntry& entry : entries) {
        progress.check();
        volume.grids().all.push_back(readGrid(cursor, entry, header.codec));
      }
    }
  } catch (const Error& e) {
    if (e.status() != Status::Usage)
      throw;
    throw Error(Status::Invalid, path, e.what()); // a transform that OpenVDB does not take
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "does not fit in memory, or is damaged");
  } catch (const std::exception& e) {
    throw Error(Status::Invalid, path, std::string("cannot be read: ") + e.what());
  }
  if (volume.grids().all.empty())
    throw Error(Status::Invalid, path, "holds no grid");
  return volume;
}

} // namespace tetvdb
