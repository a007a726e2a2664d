// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/VdbOutput.h"

#include "tetvdb/core/Version.h"
#include "tetvdb/io/volume/PartMetadata.h"
#include "tetvdb/io/volume/VdbPieces.h"

#include <new>
#include <stdexcept>
#include <type_traits>

namespace tetvdb {
namespace {

constexpr std::uint32_t kFileVersion = 224;
constexpr std::size_t kUuidSize = 36;
constexpr std::size_t kOffsetsSize = 3 * sizeof(std::int64_t);

template <class T>
void addValue(std::string& bytes, const T& x) {
  bytes.append(reinterpret_cast<const char*>(&x), sizeof x);
}

void addText(std::string& bytes, const std::string& x) {
  addValue(bytes, static_cast<std::uint32_t>(x.size()));
  bytes += x;
}

std::string metadataBytes(const openvdb::MetaMap& metadata) {
  NodeStream out(0, nullptr);
  metadata.writeMeta(out.stream());
  return std::move(out.bytes());
}

std::string uuidOf(const XXH128_hash_t& hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  canonical.digest[6] = static_cast<unsigned char>((canonical.digest[6] & 0x0F) | 0x80);
  canonical.digest[8] = static_cast<unsigned char>((canonical.digest[8] & 0x3F) | 0x80);
  std::string text;
  for (int i = 0; i < 16; ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10)
      text += '-';
    text += "0123456789abcdef"[canonical.digest[i] >> 4];
    text += "0123456789abcdef"[canonical.digest[i] & 15];
  }
  return text;
}

} // namespace

VdbHead makeVdbHead(const std::string& name, const std::string& type, const std::string& parent,
                    const openvdb::MetaMap& metadata, const openvdb::math::Transform& transform,
                    const std::string& root) {
  VdbHead head;
  addText(head.bytes, name);
  addText(head.bytes, type);
  addText(head.bytes, parent);
  head.offsetsAt = head.bytes.size();
  head.bytes.append(kOffsetsSize, '\0');
  addValue(head.bytes, vdbCompression());
  head.bytes += metadataBytes(metadata);
  NodeStream out(0, nullptr);
  transform.write(out.stream());
  head.bytes += out.bytes();
  head.bytes += root;
  return head;
}

openvdb::GridBase::Ptr withCounts(const openvdb::GridBase::Ptr& grid, const VdbCounts& counts,
                                  bool part) {
  using Base = openvdb::GridBase;
  const Base::Ptr copy = grid->copyGrid();
  copy->addStatsMetadata();
  copy->insertMeta(Base::META_FILE_COMPRESSION,
                   openvdb::StringMetadata(openvdb::io::compressionToString(vdbCompression())));
  const auto set = [&](const char* name, const auto& value) {
    using Value = std::decay_t<decltype(value)>;
    copy->insertMeta(name, openvdb::TypedMetadata<Value>(value));
  };
  if (counts.activeVoxels > 0) {
    set(Base::META_FILE_BBOX_MIN, openvdb::Vec3i(counts.box.min.data()));
    set(Base::META_FILE_BBOX_MAX, openvdb::Vec3i(counts.box.max.data()));
  }
  set(Base::META_FILE_MEM_BYTES, static_cast<openvdb::Int64>(counts.memoryBytes));
  set(Base::META_FILE_VOXEL_COUNT, static_cast<openvdb::Int64>(counts.activeVoxels));
  if (part)
    set(kPartLeaves, static_cast<openvdb::Int64>(counts.leaves));
  return copy;
}

openvdb::GridBase::Ptr withCreator(const openvdb::GridBase::Ptr& grid) {
  const openvdb::GridBase::Ptr copy = grid->copyGrid(); // shares the tree
  copy->setTransform(grid->transformPtr());             // the copy's was rounded
  if (copy->getCreator().empty())
    copy->setCreator(std::string("TetVDB ") + version());
  return copy;
}

std::string vdbTypeOf(const openvdb::GridBase& grid) {
  return grid.type() + (grid.saveFloatAsHalf() ? "_HalfFloat" : "");
}

VdbOutput::VdbOutput(const std::string& path, const std::map<std::string, std::string>& metadata,
                     std::size_t grids)
    : file_(path), state_(XXH3_createState()) {
  if (!state_)
    throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
  std::string bytes;
  addValue(bytes, std::int64_t(openvdb::OPENVDB_MAGIC));
  addValue(bytes, kFileVersion);
  addValue(bytes, std::uint32_t(openvdb::OPENVDB_LIBRARY_MAJOR_VERSION));
  addValue(bytes, std::uint32_t(openvdb::OPENVDB_LIBRARY_MINOR_VERSION));
  addValue(bytes, char(1)); // grids have offsets
  uuidAt_ = bytes.size();
  bytes.append(kUuidSize, '0');
  openvdb::MetaMap map;
  for (const auto& [key, text] : metadata)
    map.insertMeta(key, openvdb::StringMetadata(text));
  bytes += metadataBytes(map);
  addValue(bytes, static_cast<std::int32_t>(grids));
  write(bytes);
}

void VdbOutput::beginGrid(const VdbHead& head) {
  headAt_ = file_.size();
  headSize_ = head.bytes.size();
  file_.write(head.bytes.data(), head.bytes.size());
}

void VdbOutput::finishGrid(const VdbHead& head, std::uint64_t buffersAt) {
  if (head.bytes.size() != headSize_)
    throw std::logic_error("the head of a grid has changed its size");
  hash(head.bytes);
  std::string bytes = head.bytes;
  const std::uint64_t offsets[3] = {headAt_ + head.offsetsAt + kOffsetsSize, buffersAt,
                                    file_.size()};
  bytes.replace(head.offsetsAt, kOffsetsSize, reinterpret_cast<const char*>(offsets), kOffsetsSize);
  file_.writeAt(headAt_, bytes.data(), bytes.size());
}

void VdbOutput::commit(Progress& progress) {
  const std::string uuid = uuidOf(XXH3_128bits_digest(state_.get()));
  file_.writeAt(uuidAt_, uuid.data(), uuid.size());
  progress.check();
  file_.commit();
}

} // namespace tetvdb
