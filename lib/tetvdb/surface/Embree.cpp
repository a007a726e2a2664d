// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/surface/Embree.h"

#include "tetvdb/core/Error.h"

#include <string>

namespace tetvdb {
namespace {

void throwUnlessNone(RTCError error) {
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(Status::Limit, "", "out of memory for the search structure of the triangles");
  if (error != RTC_ERROR_NONE)
    throw Error(Status::Invalid, "",
                "Embree failed with error " + std::to_string(static_cast<int>(error)));
}

RTCDevice newDevice() {
  // No subdivision surfaces: their cache is 128 MB of addresses, which count towards RLIMIT_DATA.
  const RTCDevice device = rtcNewDevice("tessellation_cache_size=0");
  if (device == nullptr)
    throwUnlessNone(rtcGetDeviceError(nullptr));
  return device;
}

} // namespace

RTCDevice embreeDevice() {
  static RTCDevice const device = newDevice();
  return device;
}

void commit(RTCScene scene) {
  rtcJoinCommitScene(scene); // in the caller's arena
  throwUnlessNone(rtcGetDeviceError(embreeDevice()));
}

} // namespace tetvdb
