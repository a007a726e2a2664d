// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/FieldGrids.h"

#include "nanovdb_kernels/FieldJob.h"
#include "tetvdb/fields/LeafSample.h"
#include "tetvdb/fields/LeafShapes.h"
#include "tetvdb/geometry/TetWeights.h"
#include "tetvdb/io/volume/LeafPacker.h"
#include "tetvdb/volume/TreeAssembly.h"
#include "tetvdb/voxelize/LeafRows.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <optional>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <utility>

namespace tetvdb {
namespace {

// The numbers read for one field in one leaf; reused between leaves.
struct Reading {
  // By tet (slot) and number: the value at the first corner, and the differences at the three
  // others.
  std::vector<std::array<double, 4>> corners;
  std::vector<double> cells;
};

void convert(const double* value, float& out) {
  out = static_cast<float>(value[0]);
}
void convert(const double* value, openvdb::Vec3s& out) {
  out = openvdb::Vec3s(static_cast<float>(value[0]), static_cast<float>(value[1]),
                       static_cast<float>(value[2]));
}
void convert(const double* value, std::int32_t& out) {
  out = static_cast<std::int32_t>(value[0]);
}

bool isFinite(float value) {
  return std::isfinite(value);
}
bool isFinite(const openvdb::Vec3s& value) {
  return std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]);
}
bool isFinite(std::int32_t) {
  return true;
}

// The values of a field at the voxels of a leaf.
template <typename Value>
class LeafValues {
public:
  LeafValues(const Field& field, const TetMesh& mesh)
      : field_(field), mesh_(mesh), rule_(field.rule()) {}

  /// `shapes` are those of the sample if the mesh has cells with shape functions.
  void evaluate(const LeafSample& sample, const LeafShapes& shapes, Reading& reading,
                Value* out) const {
    if (field_.on == Attribute::On::Cells)
      return ofCells(sample, reading, out);
    if (field_.kind == FieldKind::Integer)
      return ofNearestCorner(sample, out);
    if (!mesh_.curved.empty())
      return ofShapes(sample, shapes, out);
    gather(sample, reading);
    switch (field_.sources.size()) {
    case 1:
      return ofCorners<1>(sample, reading, out);
    case 3:
      return ofCorners<3>(sample, reading, out);
    default:
      return ofCorners<0>(sample, reading, out);
    }
  }

  Value ofCell(std::uint32_t tet) const {
    double read[9];
    for (std::size_t k = 0; k < field_.sources.size(); ++k)
      read[k] = field_.sources[k].array->number(mesh_.cell(tet), field_.sources[k].component);
    return finished(read);
  }

private:
  Value finished(const double* read) const {
    double made[3];
    Value value;
    convert(rule_.finish(read, made), value);
    return value;
  }

  void ofCells(const LeafSample& sample, Reading& reading, Value* out) const {
    const std::size_t width = field_.sources.size();
    reading.cells.resize(sample.slots() * width);
    for (std::size_t k = 0; k < width; ++k)
      std::visit(
          [&](const auto& values) {
            const std::size_t step = field_.sources[k].array->components;
            const auto* from = values.data() + field_.sources[k].component;
            for (std::size_t s = 0; s < sample.slots(); ++s)
              reading.cells[s * width + k] =
                  static_cast<double>(from[mesh_.cell(sample.tet(s)) * step]);
          },
          field_.sources[k].array->values);
    std::array<Value, LeafSample::kVoxels> ofSlot;
    for (std::size_t s = 0; s < sample.slots(); ++s)
      ofSlot[s] = finished(reading.cells.data() + s * width);
    for (std::size_t v = 0; v < sample.count(); ++v)
      out[v] = ofSlot[sample.slot(v)];
  }

  // Category numbers are not interpolated.
  void ofNearestCorner(const LeafSample& sample, Value* out) const {
    const Field::Source& source = field_.sources.front();
    for (std::size_t v = 0; v < sample.count(); ++v) {
      const std::size_t nearest = nearestCorner(sample.weights(v));
      const double read[1] = {
          source.array->number(sample.point(sample.slot(v), nearest), source.component)};
      out[v] = finished(read);
    }
  }

  // By the shape functions of each voxel's cell, of any type.
  void ofShapes(const LeafSample& sample, const LeafShapes& shapes, Value* out) const {
    for (std::size_t v = 0; v < sample.count(); ++v) {
      const std::uint32_t* points = shapes.points(v);
      const double* weights = shapes.weights(v);
      double read[9];
      for (std::size_t k = 0; k < field_.sources.size(); ++k) {
        const Field::Source& source = field_.sources[k];
        const double base = source.array->number(points[0], source.component);
        double sum = 0; // sum of differences, so that a constant is exact
        for (std::size_t i = 1; i < shapes.count(v); ++i)
          sum += weights[i] * (source.array->number(points[i], source.component) - base);
        read[k] = base + sum;
        if (shapes.beyond(v)) {
          double low = base, high = base;
          for (std::size_t i = 1; i < shapes.count(v); ++i) {
            const double value = source.array->number(points[i], source.component);
            low = value < low ? value : low;
            high = value > high ? value : high;
          }
          read[k] = read[k] < low ? low : read[k] > high ? high : read[k];
        }
      }
      out[v] = finished(read);
    }
  }

  void gather(const LeafSample& sample, Reading& reading) const {
    const std::size_t width = field_.sources.size();
    reading.corners.resize(sample.slots() * width);
    for (std::size_t k = 0; k < width; ++k)
      std::visit(
          [&](const auto& values) {
            const std::size_t step = field_.sources[k].array->components;
            const auto* from = values.data() + field_.sources[k].component;
            for (std::size_t s = 0; s < sample.slots(); ++s) {
              auto& corners = reading.corners[s * width + k];
              for (std::size_t c = 0; c < 4; ++c)
                corners[c] = static_cast<double>(from[sample.point(s, c) * step]);
              for (std::size_t c = 1; c < 4; ++c)
                corners[c] -= corners[0];
            }
          },
          field_.sources[k].array->values);
  }

  // Width 0: that of the field.
  template <int Width>
  void ofCorners(const LeafSample& sample, const Reading& reading, Value* out) const {
    const std::size_t width = Width == 0 ? field_.sources.size() : std::size_t(Width);
    for (std::size_t v = 0; v < sample.count(); ++v) {
      const auto& w = sample.weights(v);
      const auto* corners = reading.corners.data() + sample.slot(v) * width;
      double read[9];
      for (std::size_t k = 0; k < width; ++k)
        read[k] = interpolate(corners[k], w);
      out[v] = finished(read);
    }
  }

  const Field& field_;
  const TetMesh& mesh_;
  FieldRule rule_;
};

template <typename Value>
Value backgroundOf(const Field& field) {
  return Value(static_cast<typename openvdb::VecTraits<Value>::ElementType>(field.background));
}

} // namespace

std::size_t leafBytes(FieldKind kind) {
  constexpr std::size_t allocation = 32;
  return 96 + allocation + LeafSample::kVoxels * (kind == FieldKind::Vector ? 12 : 4);
}

class FieldGrids::GridBuilder {
public:
  explicit GridBuilder(const Field& field) : field_(field) {}
  virtual ~GridBuilder() = default;
  virtual void* begin(const NodeIndex& node) = 0;
  /// Adds the leaf at `offset` in the node, with the voxels of `sample`.
  virtual void leaf(void* node, openvdb::Index offset, const LeafSample& sample,
                    const LeafShapes& shapes, Reading& reading) = 0;
  /// The same for existing values: 512, of which those in `mask` are used.
  virtual void leafOf(void* node, openvdb::Index offset, const std::array<std::int32_t, 3>& origin,
                      const std::uint64_t* mask, const void* values) = 0;
  virtual void end(void* node, const NodeIndex& index) = 0;
  virtual void drop(void* node) = 0;
  virtual void tile(const NodeIndex& index, std::uint32_t owner) = 0;
  virtual openvdb::GridBase::Ptr finish(const GridTransform& transform) = 0;

  bool ofCells() const { return field_.on == Attribute::On::Cells; }
  /// Of a leaf's 512 values.
  std::size_t valueBytes() const {
    return LeafSample::kVoxels * 4 * static_cast<std::size_t>(field_.width());
  }
  std::size_t leftOut() const { return leftOut_; }

protected:
  const Field& field_;
  std::atomic<std::size_t> leftOut_{0};
};

template <typename TreeType>
class FieldGrids::TypedBuilder : public FieldGrids::GridBuilder {
  using Leaf = typename TreeType::LeafNodeType;
  using Lower = typename TreeAssembly<TreeType>::Lower;
  using Value = typename TreeType::ValueType;

public:
  /// `packed`: null, or the destination of leaves, with floats as 16 bits if `asHalf`.
  TypedBuilder(const Field& field, const TetMesh& mesh, bool asHalf, PackedGrid* packed)
      : GridBuilder(field), values_(field, mesh), background_(backgroundOf<Value>(field)),
        half_(asHalf && field.kind != FieldKind::Integer), packed_(packed), assembly_(background_) {
    if (packed != nullptr)
      packer_.emplace(background_, half_, *packed);
  }

  void* begin(const NodeIndex& node) override { return assembly_.begin(node).release(); }

  void leaf(void* node, openvdb::Index offset, const LeafSample& sample, const LeafShapes& shapes,
            Reading& reading) override {
    std::array<Value, LeafSample::kVoxels> values;
    values_.evaluate(sample, shapes, reading, values.data());
    put(*static_cast<Lower*>(node), offset, sample.origin(), sample.count(), sample.offsets(),
        values.data());
  }

  void leafOf(void* node, openvdb::Index offset, const std::array<std::int32_t, 3>& origin,
              const std::uint64_t* mask, const void* values) override {
    std::array<std::uint16_t, LeafSample::kVoxels> offsets;
    std::array<Value, LeafSample::kVoxels> active;
    std::size_t count = 0;
    const auto* all = static_cast<const unsigned char*>(values);
    for (std::uint32_t x = 0; x < 8; ++x)
      for (std::uint64_t word = mask[x]; word != 0; word &= word - 1) {
        const std::uint32_t at = 64 * x + static_cast<std::uint32_t>(__builtin_ctzll(word));
        offsets[count] = static_cast<std::uint16_t>(at);
        std::memcpy(&active[count++], all + at * sizeof(Value), sizeof(Value));
      }
    put(*static_cast<Lower*>(node), offset, origin, count, offsets.data(), active.data());
  }

  void end(void* node, const NodeIndex& index) override {
    assembly_.end(std::unique_ptr<Lower>(static_cast<Lower*>(node)), index);
  }
  void drop(void* node) override { delete static_cast<Lower*>(node); }

  void tile(const NodeIndex& index, std::uint32_t owner) override {
    const Value value = values_.ofCell(owner);
    if (isFinite(value))
      assembly_.tile(index, value);
    else
      leftOut_ += std::size_t(kNodeSize) * kNodeSize * kNodeSize;
  }

  openvdb::GridBase::Ptr finish(const GridTransform& transform) override {
    openvdb::GridBase::Ptr grid = assembly_.finish(
        field_.name,
        field_.kind == FieldKind::Float ? openvdb::GRID_FOG_VOLUME : openvdb::GRID_UNKNOWN,
        transform);
    if (packer_) {
      packer_->finish();
      if (half_)
        grid->setSaveFloatAsHalf(true);
      packed_->grid = grid;
    }
    return grid;
  }

private:
  // Adds the leaf of `count` voxels, at ascending `offsets`.
  void put(Lower& lower, openvdb::Index offset, const std::array<std::int32_t, 3>& origin,
           std::size_t count, const std::uint16_t* offsets, const Value* values) {
    const bool finite =
        std::all_of(values, values + count, [](const Value& value) { return isFinite(value); });
    if (finite && count == LeafSample::kVoxels &&
        std::all_of(values + 1, values + count,
                    [&](const Value& value) { return value == values[0]; })) {
      lower.addTile(offset, values[0], true);
      return;
    }
    auto made =
        std::make_unique<Leaf>(openvdb::PartialCreate(),
                               openvdb::Coord(origin[0], origin[1], origin[2]), background_, false);
    made->allocate();
    Value* data = made->buffer().data();
    std::fill_n(data, LeafSample::kVoxels, background_);
    for (std::size_t v = 0; v < count; ++v) {
      if (!finite && !isFinite(values[v])) {
        ++leftOut_;
        continue;
      }
      data[offsets[v]] = values[v];
      made->getValueMask().setOn(offsets[v]);
    }
    if (made->getValueMask().isOff())
      return;
    if (packer_)
      made = packer_->pack(*made);
    lower.addLeaf(made.release());
  }

  LeafValues<Value> values_;
  Value background_;
  bool half_;
  PackedGrid* packed_;
  std::optional<LeafPacker<TreeType>> packer_;
  TreeAssembly<TreeType> assembly_;
};

struct FieldGrids::Scratch {
  LeafSample sample;
  LeafShapes shapes;
  Reading reading;
};

struct FieldGrids::State {
  State(const TetMesh& mesh, const SnappedMesh& snapped, const GridTransform& transform,
        bool weights)
      : curved(weights && !mesh.curved.empty()), scratches([&mesh, &snapped, transform, weights] {
          return Scratch{LeafSample(snapped, weights), LeafShapes(mesh, transform), {}};
        }) {}

  bool curved; ///< shapes are needed
  std::vector<std::unique_ptr<GridBuilder>> builders;
  tbb::enumerable_thread_specific<Scratch> scratches;
  std::atomic<bool> any{false};
};

// One lower node per grid; null if the grid has a tile instead.
struct FieldGrids::FieldNode : NodeSink::Node {
  FieldNode(State& owner, const NodeIndex& where, bool withCells) : state(owner), index(where) {
    nodes.reserve(owner.builders.size());
    for (const auto& builder : owner.builders)
      nodes.push_back(builder->ofCells() && !withCells ? nullptr : builder->begin(index));
  }
  ~FieldNode() override {
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i] != nullptr)
        state.builders[i]->drop(nodes[i]);
  }
  FieldNode(const FieldNode&) = delete;
  FieldNode& operator=(const FieldNode&) = delete;

  void leaf(openvdb::Index offset, Scratch& scratch) const {
    if (state.curved)
      scratch.shapes.find(scratch.sample);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      if (nodes[i] != nullptr)
        state.builders[i]->leaf(nodes[i], offset, scratch.sample, scratch.shapes, scratch.reading);
  }

  // Whether the leaf has any voxels.
  bool leafOf(const nano::LeafBatch& batch, std::uint64_t leaf) const {
    const std::uint64_t* mask = batch.masks + 8 * leaf;
    if (std::all_of(mask, mask + 8, [](std::uint64_t word) { return word == 0; }))
      return false;
    const std::int32_t* o = batch.origins + 3 * leaf;
    const auto along = [&](int k) { return static_cast<openvdb::Index>(o[k] >> 3 & 15); };
    const openvdb::Index offset = along(0) << 8 | along(1) << 4 | along(2);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      state.builders[i]->leafOf(nodes[i], offset, {o[0], o[1], o[2]}, mask,
                                batch.values[i] + leaf * state.builders[i]->valueBytes());
    return true;
  }

  State& state;
  NodeIndex index;
  std::vector<void*> nodes;
};

FieldGrids::FieldGrids(const TetMesh& mesh, const SnappedMesh& snapped,
                       const GridTransform& transform, const std::vector<Field>& fields)
    : FieldGrids(mesh, snapped, transform, fields, false, {}) {}

FieldGrids::FieldGrids(const TetMesh& mesh, const SnappedMesh& snapped,
                       const GridTransform& transform, const std::vector<Field>& fields,
                       bool asHalf, const std::vector<std::unique_ptr<PackedGrid>>& packed) {
  const bool weights = std::any_of(fields.begin(), fields.end(), [](const Field& field) {
    return field.on == Attribute::On::Points;
  });
  state_ = std::make_unique<State>(mesh, snapped, transform, weights);
  for (std::size_t i = 0; i < fields.size(); ++i)
    addBuilder(fields[i], mesh, asHalf, packed.empty() ? nullptr : packed[i].get());
}

void FieldGrids::addBuilder(const Field& field, const TetMesh& mesh, bool asHalf,
                            PackedGrid* packed) {
  auto& builders = state_->builders;
  switch (field.kind) {
  case FieldKind::Float:
    builders.push_back(
        std::make_unique<TypedBuilder<openvdb::FloatTree>>(field, mesh, asHalf, packed));
    break;
  case FieldKind::Vector:
    builders.push_back(
        std::make_unique<TypedBuilder<openvdb::Vec3STree>>(field, mesh, asHalf, packed));
    break;
  case FieldKind::Integer:
    builders.push_back(
        std::make_unique<TypedBuilder<openvdb::Int32Tree>>(field, mesh, asHalf, packed));
    break;
  }
}

FieldGrids::~FieldGrids() = default;

std::unique_ptr<NodeSink::Node> FieldGrids::begin(const NodeIndex& node) {
  return std::make_unique<FieldNode>(*state_, node, true);
}

void FieldGrids::slab(Node& node, int index, const SlabBits& bits, const std::uint32_t* owners) {
  const auto& target = static_cast<FieldNode&>(node);
  Scratch& scratch = state_->scratches.local();
  const std::int32_t first[3] = {target.index[0] * kNodeSize + index * kLeafSize,
                                 target.index[1] * kNodeSize, target.index[2] * kNodeSize};
  eachLeaf(bits, index, [&](const LeafRows& rows, int leafY, int leafZ, int entry) {
    scratch.sample.begin(first[0], first[1] + leafY * kLeafSize, first[2] + leafZ * kLeafSize);
    const std::uint32_t* corner = owners + (leafY * kLeafSize * kNodeSize + leafZ * kLeafSize);
    for (int x = 0; x < kLeafSize; ++x)
      for (std::uint64_t word = rows.word(leafZ, x); word != 0; word &= word - 1) {
        const int bit = __builtin_ctzll(word);
        scratch.sample.add(static_cast<std::uint32_t>(64 * x + bit),
                           corner[(x * kNodeSize + bit / kLeafSize) * kNodeSize + bit % kLeafSize]);
      }
    target.leaf(static_cast<openvdb::Index>(entry), scratch);
  });
  state_->any = true;
}

void FieldGrids::take(const nano::LeafBatch& batch) {
  // Leaves of a node are consecutive, and within it those of a slab; slabs share no word of the
  // node's masks.
  struct Slab {
    FieldNode* node;
    std::uint64_t begin, end;
  };
  std::vector<std::unique_ptr<FieldNode>> nodes;
  std::vector<Slab> slabs;
  for (std::uint64_t leaf = 0; leaf < batch.count; ++leaf) {
    const std::int32_t* o = batch.origins + 3 * leaf;
    const NodeIndex index{nodeOf(o[0]), nodeOf(o[1]), nodeOf(o[2])};
    const bool fresh = nodes.empty() || nodes.back()->index != index;
    if (fresh)
      nodes.push_back(std::make_unique<FieldNode>(*state_, index, true));
    if (fresh || o[0] != batch.origins[3 * (leaf - 1)])
      slabs.push_back({nodes.back().get(), leaf, leaf});
    slabs.back().end = leaf + 1;
  }
  tbb::parallel_for(std::size_t(0), slabs.size(), [&](std::size_t i) {
    for (std::uint64_t leaf = slabs[i].begin; leaf < slabs[i].end; ++leaf)
      if (slabs[i].node->leafOf(batch, leaf))
        state_->any = true;
  });
  for (std::unique_ptr<FieldNode>& node : nodes)
    end(std::move(node));
}

void FieldGrids::end(std::unique_ptr<Node> node) {
  auto& done = static_cast<FieldNode&>(*node);
  for (std::size_t i = 0; i < state_->builders.size(); ++i)
    if (done.nodes[i] != nullptr)
      state_->builders[i]->end(std::exchange(done.nodes[i], nullptr), done.index);
}

// Nodes without owners; rasterizeNodes() has none if owners are requested.
void FieldGrids::fullRun(std::int32_t, std::int32_t, std::int32_t, std::int32_t) {}

void FieldGrids::fullNode(const NodeIndex& index, std::uint32_t owner) {
  state_->any = true;
  bool varying = false;
  for (const auto& builder : state_->builders) {
    if (builder->ofCells())
      builder->tile(index, owner);
    else
      varying = true;
  }
  if (!varying)
    return;
  auto node = std::make_unique<FieldNode>(*state_, index, false);
  Scratch& scratch = state_->scratches.local();
  for (std::int32_t leaf = 0; leaf < kSlabsPerNode * kSlabsPerNode * kSlabsPerNode; ++leaf) {
    scratch.sample.begin(index[0] * kNodeSize + (leaf >> 8) * kLeafSize,
                         index[1] * kNodeSize + (leaf >> 4 & 15) * kLeafSize,
                         index[2] * kNodeSize + (leaf & 15) * kLeafSize);
    for (std::uint32_t offset = 0; offset < LeafSample::kVoxels; ++offset)
      scratch.sample.add(offset, owner);
    node->leaf(static_cast<openvdb::Index>(leaf), scratch);
  }
  end(std::move(node));
}

openvdb::GridPtrVec FieldGrids::finish(const GridTransform& transform) {
  openvdb::GridPtrVec grids;
  for (const auto& builder : state_->builders)
    grids.push_back(builder->finish(transform));
  return grids;
}

std::size_t FieldGrids::leftOut(std::size_t i) const {
  return state_->builders[i]->leftOut();
}

std::size_t FieldGrids::byTets() const {
  std::size_t count = 0;
  for (const Scratch& scratch : state_->scratches)
    count += scratch.shapes.missed();
  return count;
}

bool FieldGrids::any() const {
  return state_->any;
}

} // namespace tetvdb
