/*
 * The rays of a tile through the tree of triangles, in packets that suit the instruction set. A
 * part of the kernel: see surface_kernel.h.
 *
 * Embree cuts packets of 16 rays into ones of 8 itself where registers have 8 lanes, which costs up
 * to a tenth of the time; cutting here does not.
 */
#ifndef GZ_RENDER_SURFACE_CPU_SURFACE_TRACE_H
#define GZ_RENDER_SURFACE_CPU_SURFACE_TRACE_H

#include "render/raycast/cpu/simd_light.h"
#include "render/surface/cpu/surface_cast.h"
#include "render/surface/cpu/surface_packet.h"

#if SIMD_LANES == 8

/* Set up 8 of 16 rays, from number `first` on. */
SIMD void take_rays(const struct RTCRay16 *from, int first, struct RTCRay8 *to)
{
	vf_store(to->org_x, vf_load(from->org_x + first));
	vf_store(to->org_y, vf_load(from->org_y + first));
	vf_store(to->org_z, vf_load(from->org_z + first));
	vf_store(to->dir_x, vf_load(from->dir_x + first));
	vf_store(to->dir_y, vf_load(from->dir_y + first));
	vf_store(to->dir_z, vf_load(from->dir_z + first));
	vf_store(to->tnear, vf_load(from->tnear + first));
	vf_store(to->tfar, vf_load(from->tfar + first));
	vf_store(to->time, vf_load(from->time + first));
	vi_store(to->mask, vi_load(from->mask + first));
	vi_store(to->flags, vi_load(from->flags + first));
}

SIMD void give_hits(const struct RTCHit8 *from, int first, struct RTCHit16 *to)
{
	vf_store(to->u + first, vf_load(from->u));
	vf_store(to->v + first, vf_load(from->v));
	vi_store(to->primID + first, vi_load(from->primID));
	vi_store(to->geomID + first, vi_load(from->geomID));
}

SIMD void trace_first(const struct gz_surface_cast *cast, bool coherent, struct packet *packet)
{
	struct gz_embree_query query;
	gz_embree_query_make(coherent, &query);
	for (int first = 0; first < GZ_SURFACE_RAYS; first += 8) {
		struct RTCRayHit8 rays;
		if (!vm_any(load_mask(packet->valid + first)))
			continue;
		take_rays(&packet->hit.ray, first, &rays.ray);
		vi_store(rays.hit.geomID, vi_load(packet->hit.hit.geomID + first));
		vi_store(rays.hit.instID[0], vi_load(packet->hit.hit.instID[0] + first));
		gz_embree_intersect8(packet->valid + first, cast->tree, &query, &rays);
		vf_store(packet->hit.ray.tfar + first, vf_load(rays.ray.tfar));
		give_hits(&rays.hit, first, &packet->hit.hit);
	}
}

SIMD void trace_shadows(const struct gz_surface_cast *cast, bool coherent, struct packet *packet)
{
	struct gz_embree_query query;
	gz_embree_query_make(coherent, &query);
	for (int first = 0; first < GZ_SURFACE_RAYS; first += 8) {
		struct RTCRay8 rays;
		if (!vm_any(load_mask(packet->valid + first)))
			continue;
		take_rays(&packet->shadow, first, &rays);
		gz_embree_occluded8(packet->valid + first, cast->tree, &query, &rays);
		vf_store(packet->shadow.tfar + first, vf_load(rays.tfar));
	}
}

#else

/* Find the first triangle of each valid ray. */
SIMD void trace_first(const struct gz_surface_cast *cast, bool coherent, struct packet *packet)
{
	struct gz_embree_query query;
	/* With 16 lanes it is faster to follow even rays together that lie far apart. */
	gz_embree_query_make(coherent || SIMD_LANES == 16, &query);
	gz_embree_intersect16(packet->valid, cast->tree, &query, &packet->hit);
}

/* Find which valid shadow rays meet any triangle: they end at -INFINITY. */
SIMD void trace_shadows(const struct gz_surface_cast *cast, bool coherent, struct packet *packet)
{
	struct gz_embree_query query;
	gz_embree_query_make(coherent, &query);
	gz_embree_occluded16(packet->valid, cast->tree, &query, &packet->shadow);
}

#endif

#endif
