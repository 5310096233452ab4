// SPDX-License-Identifier: Apache-2.0
#pragma once

// Embree 3 (Debian 12) and Embree 4 (Debian 13) differ in how a query is asked; this header is the
// one place that knows.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace airtruth::shade {

#if RTC_VERSION_MAJOR >= 4

// The nearest hit of a ray; query.hit.geomID is RTC_INVALID_GEOMETRY_ID before, and after a miss.
inline void intersect(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query); }

// Whether anything lies on a ray: ray.tfar is negative infinity afterwards.
inline void occlude(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray); }

// The same for eight rays of one bundle, of which `valid` (-1 or 0 each) says which are asked.
inline void occlude(const int* valid, RTCScene scene, RTCRay8& rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded8(valid, scene, &rays, &arguments);
}

#else

inline RTCIntersectContext query_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

inline void intersect(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context = query_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect1(scene, &context, &query);
}

inline void occlude(RTCScene scene, RTCRay& ray) {
  RTCIntersectContext context = query_context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded1(scene, &context, &ray);
}

inline void occlude(const int* valid, RTCScene scene, RTCRay8& rays) {
  RTCIntersectContext context = query_context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcOccluded8(valid, scene, &context, &rays);
}

#endif

}  // namespace airtruth::shade
