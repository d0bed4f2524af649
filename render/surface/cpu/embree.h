/**
 * @file
 * Embree, version 3 or 4: the same calls for both.
 */
#ifndef GZ_RENDER_SURFACE_CPU_EMBREE_H
#define GZ_RENDER_SURFACE_CPU_EMBREE_H

#include <stdbool.h>

#ifdef GZ_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/** Find the first triangle of each of 16 rays, which lie close together: primary rays are faster so
 *  at any spacing. */
static inline void gz_embree_intersect(const int *valid, RTCScene tree, struct RTCRayHit16 *rays)
{
#ifdef GZ_EMBREE_4
	struct RTCIntersectArguments arguments;
	rtcInitIntersectArguments(&arguments);
	arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
	rtcIntersect16(valid, tree, rays, &arguments);
#else
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
	rtcIntersect16(valid, tree, &context, rays);
#endif
}

/** Find which of 16 rays meet any triangle: their tfar becomes -INFINITY. */
static inline void gz_embree_occluded(const int *valid, RTCScene tree, bool coherent,
				      struct RTCRay16 *rays)
{
#ifdef GZ_EMBREE_4
	struct RTCOccludedArguments arguments;
	rtcInitOccludedArguments(&arguments);
	arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
	rtcOccluded16(valid, tree, rays, &arguments);
#else
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
				 : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
	rtcOccluded16(valid, tree, &context, rays);
#endif
}

#endif
