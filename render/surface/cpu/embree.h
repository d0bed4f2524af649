/**
 * @file
 * Embree, version 3 or 4: the same calls for both. How many rays a packet has, and whether it is
 * followed together, changes the time and no result.
 */
#ifndef GZ_RENDER_SURFACE_CPU_EMBREE_H
#define GZ_RENDER_SURFACE_CPU_EMBREE_H

#include <stdbool.h>

#ifdef GZ_EMBREE_4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/** How the rays of a packet lie. */
struct gz_embree_query {
#ifdef GZ_EMBREE_4
	struct RTCIntersectArguments intersect;
	struct RTCOccludedArguments occluded;
#else
	struct RTCIntersectContext context;
#endif
};

/** Make a query. @param coherent  the rays lie close together: follow them together */
static inline void gz_embree_query_make(bool coherent, struct gz_embree_query *query)
{
#ifdef GZ_EMBREE_4
	const enum RTCRayQueryFlags flags =
		coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
	rtcInitIntersectArguments(&query->intersect);
	rtcInitOccludedArguments(&query->occluded);
	query->intersect.flags = query->occluded.flags = flags;
#else
	rtcInitIntersectContext(&query->context);
	query->context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
					: RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
}

#ifdef GZ_EMBREE_4
#define GZ_EMBREE_CALL(call, query, arguments, valid, tree, rays) \
	call(valid, tree, rays, &(query)->arguments)
#else
#define GZ_EMBREE_CALL(call, query, arguments, valid, tree, rays) \
	call(valid, tree, &(query)->context, rays)
#endif

/** Find the first triangle of each of 16 rays. */
static inline void gz_embree_intersect16(const int *valid, RTCScene tree,
					 struct gz_embree_query *query, struct RTCRayHit16 *rays)
{
	GZ_EMBREE_CALL(rtcIntersect16, query, intersect, valid, tree, rays);
}

/** Find the first triangle of each of 8 rays. */
static inline void gz_embree_intersect8(const int *valid, RTCScene tree,
					struct gz_embree_query *query, struct RTCRayHit8 *rays)
{
	GZ_EMBREE_CALL(rtcIntersect8, query, intersect, valid, tree, rays);
}

/** Find which of 16 rays meet any triangle: their tfar becomes -INFINITY. */
static inline void gz_embree_occluded16(const int *valid, RTCScene tree,
					struct gz_embree_query *query, struct RTCRay16 *rays)
{
	GZ_EMBREE_CALL(rtcOccluded16, query, occluded, valid, tree, rays);
}

/** The same of 8 rays. */
static inline void gz_embree_occluded8(const int *valid, RTCScene tree,
				       struct gz_embree_query *query, struct RTCRay8 *rays)
{
	GZ_EMBREE_CALL(rtcOccluded8, query, occluded, valid, tree, rays);
}

#undef GZ_EMBREE_CALL

#endif
