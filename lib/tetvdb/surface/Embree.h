// SPDX-License-Identifier: Apache-2.0
//
// Embree's header, the device of all scenes, and the one place that knows how versions 3 and 4
// differ: in version 4 a query needs no context, and the filter is an argument of the query instead
// of its context's.
#pragma once

#ifdef TETVDB_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace tetvdb {

#ifdef TETVDB_EMBREE4
using RayContext = RTCRayQueryContext;
/// Of a scene whose rays are filtered.
constexpr RTCSceneFlags kFilteredRays = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
#else
using RayContext = RTCIntersectContext;
constexpr RTCSceneFlags kFilteredRays = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
#endif

/// Of all scenes, and never released: making it takes longer than a scene of some hundred
/// triangles. Throws Error as commit() does. Thread-safe.
RTCDevice embreeDevice();

/// Builds a scene of embreeDevice() in the caller's task arena. Throws Error where this or anything
/// before it failed in this thread: Limit where memory did not suffice, otherwise Invalid.
void commit(RTCScene scene);

/// The nearest hit.
inline void intersect(RTCScene scene, RTCRayHit& ray) {
#ifdef TETVDB_EMBREE4
  rtcIntersect1(scene, &ray, nullptr);
#else
  RayContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

/// The same with a filter, which gets a pointer to `context`. The scene has kFilteredRays.
inline void intersect(RTCScene scene, RTCRayHit& ray, RayContext& context,
                      RTCFilterFunctionN filter) {
#ifdef TETVDB_EMBREE4
  rtcInitRayQueryContext(&context);
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
  arguments.context = &context;
  arguments.filter = filter;
  rtcIntersect1(scene, &ray, &arguments);
#else
  rtcInitIntersectContext(&context);
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
#endif
}

/// Whether anything is hit.
inline bool isOccluded(RTCScene scene, RTCRay& ray) {
#ifdef TETVDB_EMBREE4
  rtcOccluded1(scene, &ray, nullptr);
#else
  RayContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
  return ray.tfar < 0;
}

} // namespace tetvdb
