// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/DelayedLoad.h"

#include <memory>
#include <ostream>

namespace tetvdb {
namespace {

// Writes OpenVDB's entry as OpenVDB does where it has no compression.
class PlainDelayedLoad : public openvdb::io::DelayedLoadMetadata {
public:
  PlainDelayedLoad(const openvdb::io::DelayedLoadMetadata& entries, std::size_t leaves)
      : openvdb::io::DelayedLoadMetadata(entries), leaves_(leaves) {}

  openvdb::Metadata::Ptr copy() const override { return std::make_shared<PlainDelayedLoad>(*this); }
  openvdb::Index32 size() const override {
    return static_cast<openvdb::Index32>(3 * sizeof(openvdb::Index32) +
                                         leaves_ * (sizeof(MaskType) + sizeof(CompressedSizeType)));
  }

protected:
  void writeValue(std::ostream& out) const override {
    const auto write = [&](auto value) {
      out.write(reinterpret_cast<const char*>(&value), sizeof value);
    };
    constexpr openvdb::Index32 kPlain = 0;
    write(static_cast<openvdb::Index32>(leaves_));
    write(kPlain);
    for (std::size_t l = 0; l < leaves_; ++l)
      write(getMask(l));
    write(kPlain);
    for (std::size_t l = 0; l < leaves_; ++l)
      write(getCompressedSize(l));
  }

private:
  std::size_t leaves_;
};

} // namespace

void insertDelayedLoad(openvdb::MetaMap& metadata, const openvdb::io::DelayedLoadMetadata& entries,
                       std::size_t leaves) {
  if (isDelayedLoadPlain(leaves, [&](std::size_t l) { return entries.getCompressedSize(l); }))
    metadata.insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD,
                        PlainDelayedLoad(entries, leaves));
  else
    metadata.insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD, entries);
}

void reserveDelayedLoad(openvdb::MetaMap& metadata, std::size_t leaves) {
  openvdb::io::DelayedLoadMetadata none;
  none.resizeMask(leaves);
  none.resizeCompressedSize(leaves);
  metadata.insertMeta(openvdb::GridBase::META_FILE_DELAYED_LOAD, PlainDelayedLoad(none, leaves));
}

} // namespace tetvdb
