// SPDX-License-Identifier: Apache-2.0
//
// Replaces the device code in a build without nvcc.
#include "DeviceVoxelizer.h"
#include "tetvdb/core/Error.h"

namespace tetvdb::nano {

struct DeviceVoxelizer::State {};
struct SharedVoxelizer::State {};

namespace {
[[noreturn]] void refuse() {
  throw Error(Status::Device, "`device=cuda`", "this build has no GPU support",
              "use `device` auto or cpu");
}
} // namespace

bool deviceSupport() {
  return false;
}

std::vector<std::string> listDevices(std::string& why) {
  why = "this build has no GPU support";
  return {};
}

void* allocatePinned(std::size_t) {
  refuse();
}
void freePinned(void*) noexcept {}

DeviceVoxelizer::DeviceVoxelizer(int) {
  refuse();
}
DeviceVoxelizer::~DeviceVoxelizer() = default;
MeshView DeviceVoxelizer::keep(const MeshView&) {
  refuse();
}
Result DeviceVoxelizer::run(const MeshView&, const Job&, const Progress*) {
  refuse();
}
void DeviceVoxelizer::expand(const Result&, GridType, const VoxelRange&, DeviceArray&,
                             std::uint64_t) {
  refuse();
}
void DeviceVoxelizer::expandValues(const Result&, const VoxelRange&, DeviceArray&, std::uint64_t) {
  refuse();
}
Counts DeviceVoxelizer::sample(const MeshView&, const FieldJob&, LeafReceiver&, const Progress*) {
  refuse();
}
Counts DeviceVoxelizer::sampleGrids(const MeshView&, const FieldJob&, GridReceiver&,
                                    const Progress*) {
  refuse();
}
std::uint64_t DeviceVoxelizer::distances(const DistanceJob&, DistanceReceiver&, const Progress*) {
  refuse();
}
Result DeviceVoxelizer::coverage(const CoverageJob&, const Progress*) {
  refuse();
}
Result DeviceVoxelizer::levelSet(const MeshView&, const LevelSetJob&, const Progress*) {
  refuse();
}
Speeds DeviceVoxelizer::measureSpeeds() {
  refuse();
}
Times DeviceVoxelizer::times() const {
  return {};
}
std::uint64_t DeviceVoxelizer::allocations() const {
  return 0;
}
std::uint64_t DeviceVoxelizer::deviceBytes() const {
  return 0;
}

DeviceArray::DeviceArray(int device, std::uint64_t bytes) : device_(device), bytes_(bytes) {
  refuse();
}
DeviceArray::~DeviceArray() = default;
void DeviceArray::readBy(std::uint64_t) {}
void DeviceArray::setBits(std::uint64_t, const char*, std::uint64_t) {
  refuse();
}
void DeviceArray::set(std::uint64_t, const void*, std::uint64_t) {
  refuse();
}
void DeviceArray::set(std::uint64_t, const DeviceArray&) {
  refuse();
}
void DeviceArray::download(void*) const {
  refuse();
}

SharedVoxelizer::SharedVoxelizer(const std::vector<int>&) {
  refuse();
}
SharedVoxelizer::~SharedVoxelizer() = default;
void SharedVoxelizer::keep(const MeshView&) {
  refuse();
}
Result SharedVoxelizer::run(const MeshView&, const Job&, const Progress*) {
  refuse();
}
Counts SharedVoxelizer::sample(const MeshView&, const FieldJob&, LeafReceiver&, const Progress*) {
  refuse();
}
Counts SharedVoxelizer::sampleGrids(const MeshView&, const FieldJob&, GridReceiver&,
                                    const Progress*) {
  refuse();
}
std::uint64_t SharedVoxelizer::distances(const DistanceJob&, DistanceReceiver&, const Progress*) {
  refuse();
}
Result SharedVoxelizer::coverage(const CoverageJob&, const Progress*) {
  refuse();
}
Result SharedVoxelizer::levelSet(const MeshView&, const LevelSetJob&, const Progress*) {
  refuse();
}
std::vector<Times> SharedVoxelizer::times() const {
  return {};
}
std::vector<std::uint64_t> SharedVoxelizer::leaves() const {
  return {};
}

} // namespace tetvdb::nano
