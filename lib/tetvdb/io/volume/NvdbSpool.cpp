// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/GridSpool.h"
#include "tetvdb/io/volume/JoinedParts.h"
#include "tetvdb/io/volume/NvdbNodes.h"

namespace tetvdb {
namespace {

template <class GridT>
class TypedNvdbSpool : public JoinedParts<GridT, NvdbSpool> {
  using Joined = JoinedParts<GridT, NvdbSpool>;
  using typename Joined::ChildMask;
  using typename Joined::Lists;
  using typename Joined::T;
  using typename Joined::TreeT;
  using typename Joined::Upper;

public:
  TypedNvdbSpool(const openvdb::GridBase::Ptr& empty, const SpoolOptions& options)
      : Joined(empty, options), grid_(openvdb::gridPtrCast<GridT>(empty)),
        nodes_(options.folder, options.inMemory) {}

  void writeTo(AtomicFile& file, const ProgressShare& share) override {
    nodes_.writeTo(file, *grid_, share);
  }

private:
  void takeNodes(const TreeT&, const Lists& nodes) override { nodes_.addLowers(nodes.lowers); }
  void takeUpper(const Upper& upper, const ChildMask& children) override {
    nodes_.addUpper(upper, children);
  }
  void takeTile(const openvdb::Coord& origin, const T& value, bool active) override {
    nodes_.addTile(origin, value, active);
  }

  typename GridT::Ptr grid_; ///< empty
  NvdbNodes<TreeT> nodes_;
};

} // namespace

std::unique_ptr<NvdbSpool> makeNvdbSpool(const openvdb::GridBase::Ptr& empty,
                                         const SpoolOptions& options) {
  requireNvdbForm(*empty, "");
  std::unique_ptr<NvdbSpool> spool;
  empty->apply<NvdbGrids>([&](const auto& typed) {
    spool = std::make_unique<TypedNvdbSpool<std::decay_t<decltype(typed)>>>(empty, options);
  });
  return spool;
}

} // namespace tetvdb
