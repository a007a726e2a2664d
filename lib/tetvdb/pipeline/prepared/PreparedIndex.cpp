// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/prepared/PreparedIndex.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>
#include <variant>
#include <xxhash.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kVersion = 2;
constexpr std::string_view kStem = "tets_";
constexpr std::string_view kEnding = ".bin";
constexpr const char* kTypes[] = {"float", "double", "int32", "int64"};
static_assert(std::size(kTypes) == std::variant_size_v<Attribute::Values>);

bool isBucketName(const std::string& name) {
  const std::size_t around = kStem.size() + kEnding.size();
  return name.size() > around && name.size() < around + 12 &&
         name.compare(0, kStem.size(), kStem) == 0 &&
         name.compare(name.size() - kEnding.size(), kEnding.size(), kEnding) == 0 &&
         std::all_of(name.begin() + static_cast<std::ptrdiff_t>(kStem.size()),
                     name.end() - static_cast<std::ptrdiff_t>(kEnding.size()),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

Json toJson(const PreparedFile& file) {
  return {{"file", file.name}, {"bytes", file.bytes}, {"xxh128", file.hash}};
}

Json toJson(const InputInfo& input) {
  const TetStatistics& s = input.statistics;
  return {{"path", input.path},         {"format", std::string(formatName(input.format))},
          {"vertices", input.vertices}, {"tets", input.tets},
          {"cells", input.cells},       {"volume", s.volume},
          {"box_volume", s.boxVolume},  {"box", {{"min", s.boxMin}, {"max", s.boxMax}}},
          {"inverted", s.inverted},     {"flat", s.flat}};
}

// Reads `json` or throws what nlohmann throws.
InputInfo inputOf(const Json& json) {
  InputInfo input;
  json.at("path").get_to(input.path);
  const auto format = json.at("format").get<std::string>();
  for (const Format& row : formats())
    if (row.name == format)
      input.format = row.id;
  json.at("vertices").get_to(input.vertices);
  json.at("tets").get_to(input.tets);
  json.at("cells").get_to(input.cells);
  TetStatistics& s = input.statistics;
  json.at("volume").get_to(s.volume);
  json.at("box_volume").get_to(s.boxVolume);
  json.at("box").at("min").get_to(s.boxMin);
  json.at("box").at("max").get_to(s.boxMax);
  json.at("inverted").get_to(s.inverted);
  json.at("flat").get_to(s.flat);
  return input;
}

template <class T>
Json arrayName(const T& array) {
  return {{"name", array.name},
          {"on", array.on == Attribute::On::Points ? "points" : "cells"},
          {"components", array.components}};
}

Attribute::On onOf(const Json& json) {
  return json.at("on").get<std::string>() == "points" ? Attribute::On::Points
                                                      : Attribute::On::Cells;
}

Json toJson(const PreparedIndex& index) {
  Json arrays = Json::array(), unread = Json::array(), ranges = Json::array(),
       buckets = Json::array();
  for (const PreparedArray& array : index.arrays) {
    Json& one = arrays.emplace_back(arrayName(array));
    one["type"] = kTypes[array.type];
    one["beyond_int32"] = array.beyondInt32;
  }
  for (const UnreadArray& array : index.unread)
    unread.push_back(arrayName(array));
  for (const PreparedRange& range : index.ranges)
    ranges.push_back({{"of", range.key},
                      {"min", range.range.empty() ? Json() : Json(range.range.low)},
                      {"max", range.range.empty() ? Json() : Json(range.range.high)},
                      {"not_finite", range.notFinite}});
  for (const TetBucket& bucket : index.buckets) {
    Json& one = buckets.emplace_back(toJson(bucket.file));
    one["tets"] = bucket.tets;
    one["points"] = bucket.points;
    one["cells"] = bucket.cells;
    one["cell_nodes"] = bucket.cellNodes;
    one["nodes"] = {
        {"min", bucket.box.box.low}, {"end", bucket.box.box.high}, {"axis", bucket.box.axis}};
  }
  return {{"prepared_version", kVersion},
          {"creator", std::string("TetVDB ") + version()},
          {"source", index.source},
          {"input", toJson(index.input)},
          {"up_axis", index.up == UpAxis::Y ? "y" : "z"},
          {"voxel_size", index.transform.voxelSize},
          {"origin", index.transform.origin},
          {"flipped", index.counts.flipped},
          {"dropped", index.counts.dropped},
          {"boundary_faces", index.counts.boundaryFaces},
          {"boundary_points", index.boundaryPoints},
          {"boundary", toJson(index.boundary)},
          {"has_tets", index.hasTets},
          {"has_regions", index.hasRegions},
          {"has_shapes", index.hasShapes},
          {"node_count", index.nodeCount},
          {"nodes", toJson(index.nodes)},
          {"arrays", arrays},
          {"unread_arrays", unread},
          {"ranges", ranges},
          {"buckets", buckets}};
}

class IndexReader {
public:
  explicit IndexReader(const std::string& folder) : folder_(folder) {}

  PreparedIndex read() {
    const std::string path = (fs::path(folder_) / kPreparedIndex).string();
    const MappedFile file(path);
    try {
      return parse(Json::parse(file.bytes()));
    } catch (const nlohmann::json::exception& error) {
      throw Error(Status::Invalid, path,
                  std::string("is no index of a prepared mesh: ") + error.what(),
                  "prepare the mesh again");
    }
  }

private:
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw Error(Status::Invalid, (fs::path(folder_) / name).string(), what,
                "prepare the mesh again");
  }

  PreparedFile fileOf(const Json& json) const {
    PreparedFile file;
    json.at("file").get_to(file.name);
    json.at("bytes").get_to(file.bytes);
    json.at("xxh128").get_to(file.hash);
    return file;
  }

  // `bytes`: what follows from the counts.
  void check(const PreparedFile& file, bool named, std::uint64_t bytes) const {
    if (!named)
      fail(kPreparedIndex, "names a file that it does not make: '" + file.name + "'");
    if (file.bytes != bytes)
      fail(kPreparedIndex, "does not agree with itself about '" + file.name + "'");
    std::error_code error;
    const auto size = fs::file_size(fs::path(folder_) / file.name, error);
    if (error)
      fail(file.name, "is missing");
    if (size != bytes)
      fail(file.name, fmt::format("has {} bytes in place of {}", size, bytes));
  }

  PreparedIndex parse(const Json& json) const {
    if (json.at("prepared_version").get<int>() != kVersion)
      fail(kPreparedIndex, "is of another version");
    PreparedIndex index;
    json.at("source").get_to(index.source);
    index.input = inputOf(json.at("input"));
    index.up = json.at("up_axis").get<std::string>() == "y" ? UpAxis::Y : UpAxis::Z;
    json.at("voxel_size").get_to(index.transform.voxelSize);
    json.at("origin").get_to(index.transform.origin);
    for (std::size_t k = 0; k < 3; ++k)
      if (!(index.transform.voxelSize[k] > 0) || !std::isfinite(index.transform.voxelSize[k]) ||
          !std::isfinite(index.transform.origin[k]))
        fail(kPreparedIndex, "has no voxel size and origin");
    json.at("flipped").get_to(index.counts.flipped);
    json.at("dropped").get_to(index.counts.dropped);
    json.at("boundary_faces").get_to(index.counts.boundaryFaces);
    json.at("boundary_points").get_to(index.boundaryPoints);
    index.boundary = fileOf(json.at("boundary"));
    requireCount(index.counts.boundaryFaces);
    requireCount(index.boundaryPoints);
    check(index.boundary, index.boundary.name == kPreparedBoundary,
          boundaryFileBytes(index.counts.boundaryFaces, index.boundaryPoints));
    json.at("has_tets").get_to(index.hasTets);
    json.at("has_regions").get_to(index.hasRegions);
    json.at("has_shapes").get_to(index.hasShapes);
    for (const Json& array : json.at("arrays"))
      index.arrays.push_back(arrayOf(array));
    for (const Json& array : json.at("unread_arrays"))
      index.unread.push_back({array.at("name").get<std::string>(), onOf(array),
                              array.at("components").get<std::uint32_t>()});
    for (const Json& range : json.at("ranges"))
      index.ranges.push_back(rangeOf(range));
    json.at("node_count").get_to(index.nodeCount);
    requireCount(index.nodeCount);
    if (index.hasTets) {
      index.nodes = fileOf(json.at("nodes"));
      check(index.nodes, index.nodes.name == kPreparedNodes, nodesFileBytes(index.nodeCount));
    }
    for (const Json& bucket : json.at("buckets"))
      index.buckets.push_back(bucketOf(bucket, index));
    checkOrder(index.buckets);
    return index;
  }

  void requireCount(std::uint64_t count) const {
    if (count > std::uint64_t(1) << 40)
      fail(kPreparedIndex, "has a count that no mesh has");
  }

  PreparedArray arrayOf(const Json& json) const {
    PreparedArray array;
    json.at("name").get_to(array.name);
    array.on = onOf(json);
    json.at("components").get_to(array.components);
    const auto type = json.at("type").get<std::string>();
    array.type = static_cast<std::size_t>(std::find(std::begin(kTypes), std::end(kTypes), type) -
                                          std::begin(kTypes));
    json.at("beyond_int32").get_to(array.beyondInt32);
    if (array.type == std::size(kTypes) || array.components == 0 || array.components > 1u << 16)
      fail(kPreparedIndex, "has an array of no known kind, '" + array.name + "'");
    return array;
  }

  static PreparedRange rangeOf(const Json& json) {
    PreparedRange range;
    json.at("of").get_to(range.key);
    if (!json.at("min").is_null()) {
      json.at("min").get_to(range.range.low);
      json.at("max").get_to(range.range.high);
    }
    json.at("not_finite").get_to(range.notFinite);
    return range;
  }

  TetBucket bucketOf(const Json& json, const PreparedIndex& index) const {
    TetBucket bucket;
    bucket.file = fileOf(json);
    json.at("tets").get_to(bucket.tets);
    json.at("points").get_to(bucket.points);
    requireCount(bucket.tets);
    requireCount(bucket.points);
    json.at("cells").get_to(bucket.cells);
    json.at("cell_nodes").get_to(bucket.cellNodes);
    requireCount(bucket.cells);
    requireCount(bucket.cellNodes);
    if (!index.hasShapes && bucket.cells + bucket.cellNodes > 0)
      fail(kPreparedIndex, "has cells of shapes that it says it has none of");
    const Json& nodes = json.at("nodes");
    nodes.at("min").get_to(bucket.box.box.low);
    nodes.at("end").get_to(bucket.box.box.high);
    nodes.at("axis").get_to(bucket.box.axis);
    const NodeBox& box = bucket.box.box;
    for (std::size_t k = 0; k < 3; ++k)
      if (box.low[k] < -kMaxNode || box.low[k] >= kMaxNode || box.high[k] <= box.low[k] ||
          box.high[k] > (box.low[k] & ~(kNodesInCube - 1)) + kNodesInCube)
        fail(kPreparedIndex, "has a box that is in no child of the root node");
    if (bucket.box.axis > 2)
      fail(kPreparedIndex, "has a box that is cut along no axis");
    for (std::size_t k = 0; k < bucket.box.axis; ++k)
      if (box.high[k] - box.low[k] != 1)
        fail(kPreparedIndex, "has a box whose parts would be in no order");
    if (bucket.tets > 0)
      check(bucket.file, isBucketName(bucket.file.name), bucketFileBytes(index, bucket));
    return bucket;
  }

  // The buckets of a cube fill it, each node of one before each of the next.
  void checkOrder(const std::vector<TetBucket>& buckets) const {
    Vec3i cube{};
    std::int64_t nodes = 0;
    constexpr std::int64_t kAll = std::int64_t(kNodesInCube) * kNodesInCube * kNodesInCube;
    for (std::size_t i = 0; i < buckets.size(); ++i) {
      const NodeBox& box = buckets[i].box.box;
      const Vec3i own{box.low[0] >> 5, box.low[1] >> 5, box.low[2] >> 5};
      if (nodes == 0 ? i > 0 && !(cube < own) : own != cube)
        fail(kPreparedIndex, "has its boxes in no order");
      cube = own;
      if (nodes > 0 && !isBefore(buckets[i - 1].box.box, box))
        fail(kPreparedIndex, "has its boxes in no order");
      nodes += std::int64_t(box.high[0] - box.low[0]) * (box.high[1] - box.low[1]) *
               (box.high[2] - box.low[2]);
      if (nodes == kAll)
        nodes = 0;
    }
    if (nodes != 0)
      fail(kPreparedIndex, "has boxes that do not fill the children of the root node");
  }

  // Whether every node of `a` comes before every one of `b`.
  static bool isBefore(const NodeBox& a, const NodeBox& b) {
    return NodeIndex{a.high[0] - 1, a.high[1] - 1, a.high[2] - 1} < b.low;
  }

  const std::string& folder_;
};

} // namespace

std::string PreparedIndex::mark() const {
  std::string what = boundary.hash + nodes.hash;
  for (const TetBucket& bucket : buckets)
    what += bucket.file.hash;
  const XXH128_hash_t hash = XXH3_128bits(what.data(), what.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

AtomicFolder::Contents preparedContents() {
  return {"parts of a mesh", kPreparedIndex, [](const std::string& name) {
            return name == kPreparedBoundary || name == kPreparedNodes || isBucketName(name);
          }};
}

std::string bucketName(std::size_t number) {
  return fmt::format("{}{}{}", kStem, number, kEnding);
}

std::string keyOf(const Field& field) {
  std::string key = fmt::format("{} {}", int(field.part), field.kind == FieldKind::Vector);
  for (const Field::Source& source : field.sources)
    key += fmt::format(" {}{}:{}", source.array->on == Attribute::On::Points ? 'p' : 'c',
                       source.component, source.array->name);
  return key;
}

void writePreparedIndex(const std::string& folder, const PreparedIndex& index) {
  std::string text;
  try {
    text = toJson(index).dump(1) + "\n";
  } catch (const nlohmann::json::exception&) {
    throw Error(Status::Invalid, index.source,
                "its name, or that of one of its arrays or kinds of cells, is no UTF-8",
                "rename it, or leave the array out");
  }
  AtomicFile file((fs::path(folder) / kPreparedIndex).string());
  file.write(text.data(), text.size());
  file.commit();
}

PreparedIndex readPreparedIndex(const std::string& folder) {
  return IndexReader(folder).read();
}

} // namespace tetvdb
