// SPDX-License-Identifier: Apache-2.0
//
// The tets of a prepared mesh, a bucket at a time.
#pragma once

#include "tetvdb/pipeline/TetSource.h"
#include "tetvdb/pipeline/prepared/PreparedFiles.h"
#include "tetvdb/pipeline/prepared/PreparedIndex.h"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetvdb {

class PreparedTets : public TetSource {
public:
  /// `index` must outlive it. Throws Error(Invalid) for nodes.bin.
  PreparedTets(const std::string& folder, const PreparedIndex& index);

  /// Resolves `options` in the mesh's arrays: the fields have the ranges of the whole mesh, which
  /// the index holds, or all buckets are read for. To be called before within() where fields are
  /// asked for. Throws as resolveFields().
  const std::vector<Field>& resolve(const FieldOptions& options,
                                    const std::vector<ValueRange>* ranges, Report& report,
                                    Progress& progress);
  /// Throws Error(Limit) where a bucket needs more than so many bytes.
  void requireRoom(std::size_t bytes) const;

  std::size_t size() const override { return nodes_.size(); }
  NodeIndex node(std::size_t i) const override { return nodes_[i].node; }
  std::size_t mostLeaves(std::size_t i) const override { return mostLeavesOf(nodes_[i].slabs); }
  std::vector<SplitBox> boxes(const NodeBox& cube) const override;
  const OwnerTets& within(const NodeBox& box, Progress& progress) override;

private:
  static constexpr std::size_t kNone = ~std::size_t(0);

  std::size_t bucketOf(const NodeBox& box) const;
  BucketTets read(std::size_t bucket) const;
  void load(std::size_t bucket, Progress& progress);

  std::string folder_;
  const PreparedIndex& index_;
  std::vector<MetNode> nodes_;
  std::map<Vec3i, std::pair<std::size_t, std::size_t>> ofCube_; ///< its buckets
  std::optional<FieldOptions> options_;
  std::vector<ValueRange> ranges_;
  BucketTets empty_; ///< for fields_
  std::vector<Field> fields_;
  std::size_t loaded_ = kNone; ///< number of the bucket, or of buckets: none of them
  bool isLoaded_ = false;
  BucketTets bucket_;
  std::vector<Field> own_; ///< of bucket_
  SnappedMesh snapped_;
  std::unique_ptr<TetNodes> bins_;
  OwnerTets tets_;
};

} // namespace tetvdb
