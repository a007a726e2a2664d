// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/visualize/GridValues.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/volume/GridTypes.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>

namespace tetvdb {
namespace {

template <class T>
double number(const T& value) {
  if constexpr (openvdb::VecTraits<T>::IsVec)
    return std::sqrt(double(value[0]) * double(value[0]) + double(value[1]) * double(value[1]) +
                     double(value[2]) * double(value[2]));
  else
    return static_cast<double>(value);
}

template <class TreeT>
class TypedValues : public GridValues {
public:
  explicit TypedValues(const TreeT& tree) : tree_(tree) {}

  bool at(const Vec3i& voxel, double& value) const override {
    typename TreeT::ValueType typed;
    const bool on = tree_.probeValue({voxel[0], voxel[1], voxel[2]}, typed);
    value = number(typed);
    return on;
  }

  std::unique_ptr<Reader> reader() const override { return std::make_unique<Near>(tree_); }

private:
  class Near : public Reader {
  public:
    explicit Near(const TreeT& tree) : values_(tree) {}
    bool at(const Vec3i& voxel, double& value) override {
      typename TreeT::ValueType typed;
      const bool on = values_.probeValue({voxel[0], voxel[1], voxel[2]}, typed);
      value = number(typed);
      return on;
    }

  private:
    openvdb::tree::ValueAccessor<const TreeT, false> values_;
  };

  const TreeT& tree_;
};

} // namespace

std::unique_ptr<GridValues> valuesOf(const openvdb::GridBase& grid) {
  std::unique_ptr<GridValues> result;
  const bool known = withKnownGrid(grid, [&](const auto& typed) {
    using TreeT = typename std::decay_t<decltype(typed)>::TreeType;
    result = std::make_unique<TypedValues<TreeT>>(typed.constTree());
  });
  if (!known)
    throw Error(Status::Usage, grid.getName(),
                "a grid of type " + grid.valueType() + " is unknown");
  return result;
}

} // namespace tetvdb
