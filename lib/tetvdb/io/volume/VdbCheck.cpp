// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/VdbCheck.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VdbHeader.h"
#include "tetvdb/io/volume/VolumeCursor.h"

#include <array>
#include <blosc.h>
#include <cstdint>
#include <cstring>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace tetvdb {
namespace {

using Origin = std::array<std::int32_t, 3>;

constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;

/// The form of a grid's values in the file.
struct ValueType {
  std::uint64_t bytes = 0;   ///< of a value in memory, and of tiles and backgrounds in the file
  std::uint64_t element = 0; ///< of a value in a compressed array: less for half floats
  bool boolean = false, mask = false;
  bool half = false; ///< as the type's suffix says
  bool known() const { return bytes != 0; }
};

ValueType valueTypeOf(std::string type) {
  const std::string suffix = "_HalfFloat";
  const bool half = type.size() > suffix.size() &&
                    type.compare(type.size() - suffix.size(), suffix.size(), suffix) == 0;
  if (half)
    type.resize(type.size() - suffix.size());
  struct Known {
    const char* name;
    std::uint64_t bytes, half;
  };
  for (const Known& known : {Known{"Tree_float_5_4_3", 4, 2}, Known{"Tree_double_5_4_3", 8, 2},
                             Known{"Tree_int32_5_4_3", 4, 4}, Known{"Tree_int64_5_4_3", 8, 8},
                             Known{"Tree_bool_5_4_3", 1, 1}, Known{"Tree_mask_5_4_3", 1, 1},
                             Known{"Tree_vec3s_5_4_3", 12, 6}, Known{"Tree_vec3d_5_4_3", 24, 6},
                             Known{"Tree_vec3i_5_4_3", 12, 12}}) {
    if (type == known.name)
      return {known.bytes, half ? known.half : known.bytes, type == "Tree_bool_5_4_3",
              type == "Tree_mask_5_4_3", half};
  }
  return {};
}

/// Bytes of a metadata value of a fixed size; 0 where the size is free.
std::uint32_t metadataSize(const std::string& type) {
  struct Known {
    const char* name;
    std::uint32_t bytes;
  };
  for (const Known& known :
       {Known{"bool", 1}, Known{"int32", 4}, Known{"int64", 8}, Known{"float", 4},
        Known{"double", 8}, Known{"vec2i", 8}, Known{"vec2s", 8}, Known{"vec2d", 16},
        Known{"vec3i", 12}, Known{"vec3s", 12}, Known{"vec3d", 24}, Known{"vec4i", 16},
        Known{"vec4s", 16}, Known{"vec4d", 32}, Known{"mat4s", 64}, Known{"mat4d", 128}})
    if (type == known.name)
      return known.bytes;
  return 0;
}

/// Bytes of a linear map; 0 where the map is not linear.
std::uint64_t mapSize(const std::string& type) {
  if (type == "ScaleMap" || type == "UniformScaleMap")
    return 5 * 24;
  if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap")
    return 6 * 24;
  if (type == "TranslationMap")
    return 24;
  if (type == "UnitaryMap" || type == "AffineMap")
    return 128;
  return 0;
}

class VdbChecker : VolumeCursor {
public:
  explicit VdbChecker(const Source& file) : VolumeCursor(file), path_(file.path) {}

  std::vector<VdbGridEntry> run() {
    take(8, "the header");
    requireVersion(value<std::uint32_t>("the header"));
    take(8, "the header");
    hasOffsets_ = *take(1, "the header") != 0;
    take(36, "the header");
    metadata();
    const auto count = value<std::int32_t>("the number of grids");
    if (count < 0)
      fail("the number of grids is negative");
    if (count == 0)
      fail("holds no grid");
    std::vector<VdbGridEntry> grids;
    for (std::int32_t i = 0; i < count; ++i)
      grids.push_back(grid());
    return grids;
  }

private:
  void requireVersion(std::uint32_t version) const {
    if (version < kFirstVdbVersion)
      throw Error(Status::Invalid, path_,
                  fmt::format("has file version {}, that of a program before OpenVDB 3", version),
                  "write it again by a newer program, such as Houdini or Blender");
    if (version > kLastVdbVersion)
      throw Error(Status::Invalid, path_,
                  fmt::format("has file version {}, newer than {}, the last one that this program "
                              "reads",
                              version, kLastVdbVersion),
                  "write it again by a program with OpenVDB 10, or convert it to .nvdb");
  }

  std::string text(const char* what) {
    const auto size = value<std::uint32_t>(what);
    return {take(size, what), size};
  }

  void metadata() {
    const auto count = value<std::uint32_t>("metadata");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::string name = text("metadata");
      const std::string type = text("metadata");
      const auto size = value<std::uint32_t>("metadata");
      const std::uint32_t expected = metadataSize(type);
      if (expected != 0 && size != expected)
        fail("metadata has an impossible size");
      const char* content = take(size, "metadata");
      if (type == "__delayedload")
        delayedLoad({content, size});
      // OpenVDB copies the byte into a bool; what others than 0 and 1 are then is undefined.
      if (type == "bool" && *content != 0 && *content != 1)
        fail("metadata has an impossible value");
      if (name == "is_saved_as_half_float") {
        if (type != "bool")
          fail("metadata has an impossible type");
        half_ = *content != 0;
      }
    }
  }

  /// OpenVDB allocates memory by these numbers: a count of leaves, which have 64 bytes and more
  /// each, then a byte and a size of 64 bits a leaf, each array after its compressed size, 0 if it
  /// is not compressed. The sizes may be missing.
  void delayedLoad(std::string_view content) const {
    std::uint32_t leaves = 0;
    const auto number = [&](std::uint32_t& value) {
      if (content.size() < sizeof value)
        fail("metadata has an impossible size");
      std::memcpy(&value, content.data(), sizeof value);
      content.remove_prefix(sizeof value);
    };
    if (content.empty())
      return;
    number(leaves);
    if (leaves > size() / 64)
      fail("metadata names more leaves than the file can hold");
    for (const std::uint64_t each : {1u, 8u}) {
      std::uint32_t packed = 0;
      number(packed);
      if (packed == UINT32_MAX)
        return;
      const std::uint64_t size = packed > 0 ? packed : leaves * each;
      std::size_t unpacked = 0;
      if (size > content.size() ||
          (packed > 0 && (blosc_cbuffer_validate(content.data(), size, &unpacked) < 0 ||
                          unpacked > (leaves + 512) * each)))
        fail("metadata of leaves is damaged");
      content.remove_prefix(size);
    }
  }

  VdbGridEntry grid() {
    VdbGridEntry entry;
    entry.name = text("a grid's name");
    entry.type = text("a grid's type");
    const ValueType type = valueTypeOf(entry.type);
    const bool instance = !text("a grid's name").empty();
    entry.known = type.known();
    if (!entry.known && !hasOffsets_)
      fail("holds a grid of type " + entry.type.substr(0, 100) +
           ", which is not read and cannot be skipped");
    const auto gridAt = value<std::uint64_t>("a grid's offsets");
    const auto buffersAt = value<std::uint64_t>("a grid's offsets");
    const auto endAt = value<std::uint64_t>("a grid's offsets");
    if (hasOffsets_ && (gridAt != position() || endAt < gridAt || endAt > size() ||
                        (!instance && (buffersAt < gridAt || buffersAt > endAt))))
      fail("a grid's offsets are not within the file");
    compression_ = value<std::uint32_t>("a grid");
    half_ = false;
    metadata();
    if (entry.known && half_ != type.half) // OpenVDB believes the metadata
      fail("a grid's type and metadata do not agree about half floats");
    if (entry.known) {
      transform();
      if (!instance) {
        type_ = type;
        tree();
        if (hasOffsets_ && position() != buffersAt)
          fail("a grid's buffers are not where they should be");
        buffers();
        for (const Lower& lower : lowers_)
          entry.lowers.push_back(lower.place);
      }
      if (hasOffsets_ && !instance && position() != endAt)
        fail("a grid does not end where it should");
    }
    if (hasOffsets_) {
      if (position() > endAt)
        fail("a grid does not end where it should");
      moveTo(endAt);
    }
    return entry;
  }

  void transform() {
    std::string type = text("a transform");
    if (type == "NonlinearFrustumMap") {
      take(6 * 8 + 2 * 8, "a transform"); // box, taper, depth; the linear map behind follows
      type = text("a transform");
    }
    const std::uint64_t size = mapSize(type);
    if (size == 0)
      fail("a transform is of an unknown type");
    take(size, "a transform");
  }

  static bool isOn(const char* mask, std::uint32_t i) {
    return (static_cast<unsigned char>(mask[i / 8]) >> (i % 8) & 1) != 0;
  }

  void tree() {
    lowers_.clear();
    if (value<std::uint32_t>("a tree") != 1)
      fail("a tree has an impossible number of buffers");
    take(type_.bytes, "a tree");
    const auto tiles = value<std::uint32_t>("a tree");
    const auto children = value<std::uint32_t>("a tree");
    std::set<Origin> origins;
    const auto entry = [&] {
      const auto origin = value<Origin>("a root node");
      for (const std::int32_t x : origin)
        if (x % 4096 != 0)
          fail("a root entry's place is impossible");
      if (!origins.insert(origin).second)
        fail("two root entries have the same place");
      return origin;
    };
    for (std::uint32_t i = 0; i < tiles; ++i) {
      entry();
      take(type_.bytes + 1, "a root node");
    }
    for (std::uint32_t i = 0; i < children; ++i) {
      const Origin origin = entry();
      const char* upper = internal(5);
      for (std::uint32_t n = 0; n < 32768; ++n) {
        if (!isOn(upper, n))
          continue;
        VdbLowerPlace place{};
        place.topologyAt = position();
        const char* lower = internal(4);
        for (std::uint32_t m = 0; m < 512; ++m)
          place.leaves +=
              static_cast<std::uint32_t>(__builtin_popcount(static_cast<unsigned char>(lower[m])));
        take(64 * std::uint64_t(place.leaves), "leaves");
        place.topologyBytes = static_cast<std::uint32_t>(position() - place.topologyAt);
        lowers_.push_back({within(origin, n, 5, 128), lower, place});
      }
    }
  }

  /// The place of entry `n` of a node of 2^log entries an axis, each `size` voxels wide.
  static Origin within(const Origin& origin, std::uint32_t n, int log, std::int32_t size) {
    const std::uint32_t mask = (1U << log) - 1;
    return {origin[0] + size * static_cast<std::int32_t>(n >> (2 * log)),
            origin[1] + size * static_cast<std::int32_t>(n >> log & mask),
            origin[2] + size * static_cast<std::int32_t>(n & mask)};
  }

  /// Masks and values of an internal node; returns its child mask.
  const char* internal(int log) {
    const std::uint64_t entries = std::uint64_t(1) << (3 * log), size = entries / 8;
    const char* children = take(size, "an internal node");
    const char* active = take(size, "an internal node");
    for (std::uint64_t i = 0; i < size; ++i)
      if ((children[i] & active[i]) != 0)
        fail("an entry is both a node and a tile");
    values(entries, active);
    return children;
  }

  void values(std::uint64_t entries, const char* active) {
    const auto how = value<std::int8_t>("values");
    if (how < 0 || how > 6)
      fail("values are stored in an unknown way");
    if (how == 2 || how == 4)
      take(type_.bytes, "values");
    if (how == 5)
      take(2 * type_.bytes, "values");
    if (how >= 3 && how <= 5)
      take(entries / 8, "values");
    std::uint64_t count = entries;
    if ((compression_ & kActiveMask) != 0 && how != 6) {
      count = 0;
      for (std::uint64_t i = 0; i < entries / 8; i += 8) {
        std::uint64_t word;
        std::memcpy(&word, active + i, sizeof word);
        count += static_cast<std::uint64_t>(__builtin_popcountll(word));
      }
    }
    if (count == 0 && type_.element != type_.bytes)
      return; // half floats: not even a size
    const std::uint64_t expected = count * type_.element;
    if ((compression_ & (kZip | kBlosc)) == 0) {
      take(expected, "values");
      return;
    }
    const auto packed = value<std::int64_t>("values");
    if (packed <= 0) { // stored as they are
      if (0 - static_cast<std::uint64_t>(packed) != expected)
        fail("values have an impossible size");
      take(expected, "values");
      return;
    }
    const auto size = static_cast<std::uint64_t>(packed);
    const char* from = take(size, "values");
    if ((compression_ & kBlosc) == 0)
      return;
    std::size_t unpacked = 0;
    // OpenVDB pads arrays below 129 bytes.
    if (blosc_cbuffer_validate(from, size, &unpacked) < 0 ||
        (unpacked != expected && !(expected < 129 && unpacked == 129)))
      fail("compressed values are damaged");
  }

  void buffers() {
    for (Lower& lower : lowers_) {
      lower.place.buffersAt = position();
      for (std::uint32_t n = 0; n < 4096; ++n) {
        if (!isOn(lower.children, n))
          continue;
        const char* active = take(64, "a leaf");
        if (!type_.boolean && !type_.mask) {
          values(512, active);
          continue;
        }
        if (value<Origin>("a leaf") != within(lower.origin, n, 4, 8))
          fail("a leaf's place is impossible");
        if (type_.boolean)
          take(64, "a leaf");
      }
      lower.place.buffersBytes = static_cast<std::uint32_t>(position() - lower.place.buffersAt);
    }
  }

  struct Lower {
    Origin origin;
    const char* children; ///< the mask
    VdbLowerPlace place;
  };

  const std::string& path_;
  std::uint32_t compression_ = 0;
  bool hasOffsets_ = false; ///< false: the file was written as a stream
  bool half_ = false;       ///< as the metadata of a grid says
  ValueType type_;
  std::vector<Lower> lowers_;
};

} // namespace

std::vector<VdbGridEntry> checkVdb(const Source& file) {
  return VdbChecker(file).run();
}

} // namespace tetvdb
