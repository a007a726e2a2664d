// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SpooledMesh.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/ResidentBytes.h"
#include "tetvdb/mesh/SplitByShape.h"

#include <numeric>
#include <variant>

namespace tetvdb {
namespace {

template <std::size_t I = 0>
Attribute::Values valuesOfType(std::size_t type) {
  if constexpr (I + 1 < std::variant_size_v<Attribute::Values>)
    if (type != I)
      return valuesOfType<I + 1>(type);
  return Attribute::Values(std::in_place_index<I>);
}

constexpr std::uint64_t kMostCells = 0xfffffffeu;
// Cells at a time: those of a mesh whose numbers are in no order touch as many pages of points.
constexpr std::size_t kSplitAtOnce = std::size_t(1) << 12;

[[noreturn]] void refuseAbove(const char* what) {
  throw Error(Status::Limit, "mesh", std::string("more than 4294967294 ") + what,
              "split it into several files");
}

class SpoolSplitter {
public:
  SpoolSplitter(SpooledMesh& mesh, bool shaped)
      : mesh_(mesh), shaped_(shaped), points_(mesh.points.as<Vec3d>()),
        corners_(mesh.corners.as<std::uint32_t>()), types_(mesh.types.as<CellType>()) {}

  /// Returns how many cells are not convex.
  std::size_t run(Progress& progress) {
    const std::size_t cells = mesh_.cellCount();
    for (std::size_t done = 0; done < cells; done += kSplitAtOnce) {
      progress.update(static_cast<double>(done) / static_cast<double>(cells));
      split(done, std::min(done + kSplitAtOnce, cells));
      if (mesh_.tetCount() > kMostCells)
        refuseAbove("tetrahedra");
      mesh_.points.release();
      mesh_.corners.release();
      mesh_.types.release();
    }
    return concave_;
  }

private:
  void split(std::size_t begin, std::size_t end) {
    tets_.clear();
    cellOfTet_.clear();
    firsts_.clear();
    for (std::size_t cell = begin; cell < end; ++cell) {
      const CellType type = types_[cell];
      const std::uint32_t* corners = corners_ + first_;
      firsts_.push_back(first_);
      first_ += SpooledMesh::cornersOf(type);
      if (const CellShape* shape = shapeOf(type))
        concave_ += splitByShape(*shape, corners, points_, tets_) ? 1 : 0;
      else
        tets_.insert(tets_.end(), corners, corners + 4);
      cellOfTet_.resize(tets_.size() / 4, static_cast<std::uint32_t>(cell));
    }
    mesh_.tets.append(tets_);
    mesh_.cellOfTet.append(cellOfTet_);
    if (shaped_)
      mesh_.firstCorners.append(firsts_);
  }

  SpooledMesh& mesh_;
  bool shaped_;
  const Vec3d* points_;
  const std::uint32_t* corners_;
  const CellType* types_;
  std::uint64_t first_ = 0;
  std::size_t concave_ = 0;
  std::vector<std::uint32_t> tets_, cellOfTet_;
  std::vector<std::uint64_t> firsts_;
};

} // namespace

Attribute emptyAttribute(const SpooledArray& array) {
  return {array.name, array.on, array.components, valuesOfType(array.type)};
}

std::pair<const void*, std::size_t> bytesOf(const Attribute::Values& values) {
  return std::visit(
      [](const auto& v) {
        return std::pair<const void*, std::size_t>(v.data(), v.size() * sizeof(v[0]));
      },
      values);
}

std::size_t SpooledArray::bytesEach() const {
  return components * std::visit([](const auto& v) { return sizeof(v[0]); }, valuesOfType(type));
}

SpooledArray* SpooledMesh::find(const std::string& name, Attribute::On on) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const SpooledArray& array) {
    return array.name == name && array.on == on;
  });
  return found == arrays.end() ? nullptr : &*found;
}

SpooledArray* SpooledMesh::add(const std::string& name, Attribute::On on, std::uint32_t components,
                               std::size_t type) {
  if (find(name, on) != nullptr)
    return nullptr;
  arrays.push_back({name, on, components, type, std::make_unique<FileSpool>(folder_)});
  return &arrays.back();
}

std::size_t SpooledMesh::cornersOf(CellType type) {
  const CellShape* shape = shapeOf(type);
  return shape != nullptr ? static_cast<std::size_t>(shape->corners)
                          : (type == CellType::Tetra ? 4 : 0);
}

void SpooledMesh::addCells(CellType type, const std::uint32_t* nodes, std::size_t count) {
  constexpr std::size_t kTypes = std::size_t(1) << 16;
  if (count == 0)
    return;
  const auto addTypes = [&](CellType one, std::size_t left) {
    const std::vector<CellType> some(std::min(left, kTypes), one);
    for (; left > 0; left -= std::min(left, kTypes))
      types.append(some.data(), std::min(left, kTypes) * sizeof(CellType));
  };
  if (types.size() == 0 && type != CellType::Tetra)
    addTypes(CellType::Tetra, cellCount());
  if (types.size() > 0 || type != CellType::Tetra)
    addTypes(type, count);
  corners.append(nodes, count * cornersOf(type) * sizeof(std::uint32_t));
  if (cellCount() > kMostCells)
    refuseAbove("cells");
}

void SpooledMesh::finish() {
  points.finish();
  tets.finish();
  cellOfTet.finish();
  corners.finish();
  types.finish();
  firstCorners.finish();
  regions.finish();
  for (SpooledArray& array : arrays)
    array.values->finish();
}

void SpooledMesh::releaseAbove(std::size_t maxResident) const noexcept {
  if (residentBytes() <= maxResident)
    return;
  points.release();
  tets.release();
  cellOfTet.release();
  corners.release();
  types.release();
  firstCorners.release();
  regions.release();
  for (const SpooledArray& array : arrays)
    array.values->release();
}

void splitSpooled(SpooledMesh& mesh, Report& report, Progress& progress) {
  if (mesh.types.size() == 0) {
    mesh.tets.swap(mesh.corners);
    return;
  }
  const bool shaped =
      std::any_of(mesh.arrays.begin(), mesh.arrays.end(),
                  [](const SpooledArray& array) { return array.on == Attribute::On::Points; });
  mesh.points.finish();
  mesh.corners.finish();
  mesh.types.finish();
  warnConcave(SpoolSplitter(mesh, shaped).run(progress), report);
  if (!shaped)
    FileSpool(mesh.folder()).swap(mesh.corners); // its file goes
}

TetMesh cornersOf(const SpooledMesh& mesh, std::size_t begin, std::size_t end) {
  TetMesh corners;
  const std::size_t count = 4 * (end - begin);
  const Vec3d* points = mesh.points.as<Vec3d>();
  const std::uint32_t* tets = mesh.tets.as<std::uint32_t>() + 4 * begin;
  corners.points.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    corners.points[i] = points[tets[i]];
  corners.tets.resize(count);
  std::iota(corners.tets.begin(), corners.tets.end(), 0u);
  corners.cellCount = end - begin;
  return corners;
}

} // namespace tetvdb
