// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/BitCodec.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VdbPieces.h"

#include <array>
#include <tbb/enumerable_thread_specific.h>
#include <type_traits>

namespace tetvdb {
namespace {

template <class TreeT>
class TypedBitCodec : public BitCodec {
  using T = typename TreeT::ValueType;
  using Leaf = typename TreeT::LeafNodeType;
  using Upper = typename NodeLists<TreeT>::Upper;
  using Lower = typename NodeLists<TreeT>::Lower;
  static constexpr bool kBits = hasBitLeaves<TreeT>;

public:
  TypedBitCodec(const T& background, bool asHalf)
      : background_(background), asHalf_(asHalf),
        lowerValues_([] { return std::vector<std::string>(Lower::NUM_VALUES + 1); }) {
    if constexpr (!kBits)
      makeTails();
  }

  std::string root(const std::vector<Vec3i>& tiles, std::uint32_t children) const override {
    std::string out;
    add(out, std::int32_t(1)); // buffers a leaf
    add(out, background_);
    add(out, static_cast<std::uint32_t>(tiles.size()));
    add(out, children);
    for (const Vec3i& tile : tiles) {
      add(out, tile);
      add(out, kInside);
      add(out, true);
    }
    return out;
  }

  std::string upper(const Vec3i& origin, const UpperMasks& masks) const override {
    std::string out;
    add(out, origin);
    add(out, masks.children);
    add(out, masks.tiles);
    out += values<Upper>(countBits(masks.tiles));
    return out;
  }

  void addLower(const BitNode& node, std::string& out) const override {
    add(out, node.children);
    add(out, node.tiles);
    out += valuesOfLower(countBits(node.tiles));
    out.append(reinterpret_cast<const char*>(node.leaves.data()), node.leaves.size() * 8);
  }

  void addBuffers(const Vec3i& origin, const BitNode& node, std::string& out) const override {
    const std::uint64_t* leaf = node.leaves.data();
    for (std::size_t w = 0; w < node.children.size(); ++w)
      for (std::uint64_t rest = node.children[w]; rest != 0; rest &= rest - 1, leaf += 8) {
        const auto* mask = reinterpret_cast<const char*>(leaf);
        out.append(mask, kLeafMaskBytes);
        if constexpr (kBits) {
          const auto entry = static_cast<std::int32_t>(64 * w) + __builtin_ctzll(rest);
          add(out, Vec3i{origin[0] + (entry >> 8) * 8, origin[1] + (entry >> 4 & 15) * 8,
                         origin[2] + (entry & 15) * 8});
          if constexpr (std::is_same_v<TreeT, openvdb::BoolTree>)
            out.append(mask, kLeafMaskBytes); // the values
        } else {
          std::size_t active = 0;
          for (int i = 0; i < 8; ++i)
            active += static_cast<std::size_t>(__builtin_popcountll(leaf[i]));
          out += tails_[active];
        }
      }
  }

  std::size_t upperValues(std::size_t tiles) const override { return values<Upper>(tiles).size(); }
  std::size_t lowerValues(std::size_t tiles) const override { return valuesOfLower(tiles).size(); }

  openvdb::Metadata::Ptr delayedLoad(const std::vector<std::uint16_t>& leaves) const override {
    if constexpr (!kBits) {
      const auto metadata = std::make_shared<openvdb::io::DelayedLoadMetadata>();
      metadata->resizeMask(leaves.size());
      metadata->resizeCompressedSize(leaves.size());
      for (std::size_t l = 0; l < leaves.size(); ++l)
        describeTail<T>(*metadata, l, static_cast<std::int8_t>(tails_[leaves[l]][0]),
                        tails_[leaves[l]].size());
      return metadata;
    }
    return nullptr;
  }
  bool hasDelayedLoad() const override { return !kBits; }

  NodeBytes openvdbBytes() const override { return openvdbNodeBytes<TreeT>(); }
  NodeBytes describedBytes() const override { return describedNodeBytes<TreeT>(); }

private:
  static constexpr T kInside = T(1);

  template <class V>
  static void add(std::string& out, const V& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  // The bytes of a node with so many tiles whose other entries are leaves or background.
  template <class Node>
  std::string values(std::size_t tiles) const {
    NodeStream out(vdbCompression(), &background_);
    typename Node::NodeMaskType active, children;
    const std::unique_ptr<T[]> all(new T[Node::NUM_VALUES]);
    for (openvdb::Index i = 0; i < Node::NUM_VALUES; ++i) {
      all[i] = i < tiles ? kInside : background_;
      active.set(i, i < tiles);
    }
    openvdb::io::writeCompressedValues(out.stream(), all.get(), Node::NUM_VALUES, active, children,
                                       asHalf_);
    return std::move(out.bytes());
  }
  const std::string& valuesOfLower(std::size_t tiles) const {
    std::string& known = lowerValues_.local()[tiles];
    if (known.empty())
      known = values<Lower>(tiles);
    return known;
  }

  void makeTails() {
    for (openvdb::Index active = 0; active <= Leaf::SIZE; ++active) {
      Leaf leaf(openvdb::Coord(0), background_, false);
      for (openvdb::Index i = 0; i < active; ++i)
        leaf.setValueOn(i, kInside);
      NodeStream out(vdbCompression(), &background_);
      leaf.writeBuffers(out.stream(), asHalf_);
      tails_.push_back(out.bytes().substr(kLeafMaskBytes));
    }
  }

  T background_;
  bool asHalf_;
  std::vector<std::string> tails_; ///< by number of active voxels
  mutable tbb::enumerable_thread_specific<std::vector<std::string>> lowerValues_;
};

} // namespace

std::unique_ptr<BitCodec> makeBitCodec(const openvdb::GridBase& grid) {
  if (grid.isType<openvdb::BoolGrid>())
    return std::make_unique<TypedBitCodec<openvdb::BoolTree>>(false, false);
  if (grid.isType<openvdb::MaskGrid>())
    return std::make_unique<TypedBitCodec<openvdb::MaskTree>>(false, false);
  if (grid.isType<openvdb::FloatGrid>())
    return std::make_unique<TypedBitCodec<openvdb::FloatTree>>(0.0F, grid.saveFloatAsHalf());
  throw Error(Status::Usage, grid.getName(),
              "grids of type " + grid.type() + " cannot be streamed");
}

} // namespace tetvdb
