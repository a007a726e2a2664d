// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/prepared/PreparedTets.h"

#include "tetvdb/core/Error.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace tetvdb {
namespace {

// What a tet and a point of a bucket take with what is found from them, arrays apart.
constexpr std::uint64_t kBytesPerLoadedTet = 120;
constexpr std::uint64_t kBytesPerPoint = 48;
constexpr std::uint64_t kBytesPerCell = sizeof(CurvedCells::Cell);

Vec3i cubeOf(const NodeIndex& node) {
  return {node[0] >> 5, node[1] >> 5, node[2] >> 5};
}

bool isWithin(const NodeBox& inner, const NodeBox& outer) {
  for (std::size_t k = 0; k < 3; ++k)
    if (inner.low[k] < outer.low[k] || inner.high[k] > outer.high[k])
      return false;
  return true;
}

bool isOneNode(const NodeBox& box) {
  return box.high == NodeIndex{box.low[0] + 1, box.low[1] + 1, box.low[2] + 1};
}

} // namespace

PreparedTets::PreparedTets(const std::string& folder, const PreparedIndex& index)
    : folder_(folder), index_(index), nodes_(readNodes(folder, index)), empty_(emptyBucket(index)) {
  for (std::size_t b = 0; b < index.buckets.size(); ++b)
    ofCube_.try_emplace(cubeOf(index.buckets[b].box.box.low), b, b).first->second.second = b + 1;
}

const std::vector<Field>& PreparedTets::resolve(const FieldOptions& options,
                                                const std::vector<ValueRange>* ranges,
                                                Report& report, Progress& progress) {
  if (options.all) {
    auto& arrays = empty_.mesh.attributes;
    for (const PreparedArray& array : index_.arrays) {
      if (!array.beyondInt32)
        continue;
      report.warn(
          "array-left-out",
          fmt::format("the array '{}' has integers beyond 32 bits and is left out", array.name));
      arrays.erase(std::remove_if(arrays.begin(), arrays.end(),
                                  [&](const Attribute& a) {
                                    return a.name == array.name && a.on == array.on;
                                  }),
                   arrays.end());
    }
  }
  options_ = options;
  fields_ = resolveFields(empty_.mesh, options, report, ranges);
  const auto known = [&](const Field& field) {
    return std::find_if(index_.ranges.begin(), index_.ranges.end(),
                        [key = keyOf(field)](const PreparedRange& r) { return r.key == key; });
  };
  std::vector<ValueRange> found(fields_.size());
  std::vector<bool> notFinite(fields_.size());
  const bool all = std::all_of(fields_.begin(), fields_.end(), [&](const Field& field) {
    return known(field) != index_.ranges.end();
  });
  for (std::size_t i = 0; all && i < fields_.size(); ++i) {
    found[i] = known(fields_[i])->range;
    notFinite[i] = known(fields_[i])->notFinite;
  }
  for (std::size_t b = 0; !all && b < index_.buckets.size(); ++b) {
    progress.check();
    const BucketTets bucket = read(b);
    Report told; // as of all
    const std::vector<Field> own = resolveFields(bucket.mesh, options, told);
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      found[i].add(own[i].original);
      notFinite[i] = notFinite[i] || own[i].notFinite > 0;
    }
  }
  ranges_ = ranges != nullptr ? *ranges : found;
  for (std::size_t i = 0; i < fields_.size(); ++i)
    if (notFinite[i])
      report.warn("not-finite",
                  fmt::format("the array '{}' has values that are not finite; voxels that need "
                              "them are left out of '{}'",
                              fields_[i].array, fields_[i].name));
  Report told; // the same again
  fields_ = resolveFields(empty_.mesh, options, told, &ranges_);
  return fields_;
}

void PreparedTets::requireRoom(std::size_t bytes) const {
  for (const TetBucket& bucket : index_.buckets) {
    const std::uint64_t needed = bucket.file.bytes + bucket.tets * kBytesPerLoadedTet +
                                 bucket.points * kBytesPerPoint + bucket.cells * kBytesPerCell;
    if (needed > bytes)
      throw Error(Status::Limit, "",
                  fmt::format("the tets of '{}' need about {} MB, {} MB are left for them",
                              bucket.file.name, (needed >> 20) + 1, bytes >> 20),
                  isOneNode(bucket.box.box)
                      ? "raise `max_memory`: they meet one node of 128^3 voxels"
                      : "raise `max_memory`, or prepare the mesh with a lower one");
  }
}

std::vector<SplitBox> PreparedTets::boxes(const NodeBox& cube) const {
  std::vector<SplitBox> boxes;
  if (const auto found = ofCube_.find(cubeOf(cube.low)); found != ofCube_.end())
    for (std::size_t b = found->second.first; b < found->second.second; ++b)
      boxes.push_back(index_.buckets[b].box);
  if (boxes.empty())
    boxes.push_back({cube, 0});
  return boxes;
}

std::size_t PreparedTets::bucketOf(const NodeBox& box) const {
  if (box.low[0] == box.high[0])
    return kNone;
  const auto found = ofCube_.find(cubeOf(box.low));
  if (found == ofCube_.end())
    return kNone;
  for (std::size_t b = found->second.first; b < found->second.second; ++b)
    if (isWithin(box, index_.buckets[b].box.box))
      return b;
  return kNone;
}

const OwnerTets& PreparedTets::within(const NodeBox& box, Progress& progress) {
  const std::size_t bucket = bucketOf(box);
  // An empty box needs no tets: those that are there serve.
  if (!isLoaded_ || (bucket != loaded_ && box.low[0] != box.high[0]))
    load(bucket, progress);
  return tets_;
}

BucketTets PreparedTets::read(std::size_t bucket) const {
  BucketTets tets =
      bucket == kNone ? emptyBucket(index_) : readBucket(folder_, index_, index_.buckets[bucket]);
  const auto isLeftOut = [&](const Attribute& array) {
    const auto& kept = empty_.mesh.attributes;
    return std::none_of(kept.begin(), kept.end(), [&](const Attribute& one) {
      return one.name == array.name && one.on == array.on;
    });
  };
  auto& arrays = tets.mesh.attributes;
  arrays.erase(std::remove_if(arrays.begin(), arrays.end(), isLeftOut), arrays.end());
  return tets;
}

void PreparedTets::load(std::size_t bucket, Progress& progress) {
  progress.check();
  isLoaded_ = false;
  bins_.reset();
  own_.clear();
  bucket_ = BucketTets(); // its memory first
  bucket_ = read(bucket);
  if (options_) {
    Report told; // as of all
    own_ = resolveFields(bucket_.mesh, *options_, told, &ranges_);
  }
  snapped_ = snapMesh(bucket_.mesh, index_.transform, progress);
  bins_ = std::make_unique<TetNodes>(snapped_, progress);
  tets_ = {&bucket_.mesh, &snapped_, bins_.get(), options_ ? &own_ : nullptr, &bucket_.numbers};
  loaded_ = bucket;
  isLoaded_ = true;
}

} // namespace tetvdb
