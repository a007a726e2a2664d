// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/mesh/SpooledMesh.h"

#include "tetvdb/core/ResidentBytes.h"

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

void SpooledMesh::finish() {
  points.finish();
  tets.finish();
  regions.finish();
  for (SpooledArray& array : arrays)
    array.values->finish();
}

void SpooledMesh::releaseAbove(std::size_t maxResident) const noexcept {
  if (residentBytes() <= maxResident)
    return;
  points.release();
  tets.release();
  regions.release();
  for (const SpooledArray& array : arrays)
    array.values->release();
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
